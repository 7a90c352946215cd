#include "stats/analysis/factor_levels.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

#include "stats/inference/adjust.hpp"

namespace stats {

namespace {

constexpr std::int64_t most_count = std::numeric_limits<int>::max();

/// p of the t test; if that is refused, of the exact sign test for equal values; empty without either.
std::optional<double> p_of(const Result<OneSampleTTest>& test, const std::optional<Unanimous>& all_alike,
                           double null) {
  if (test) return test->p;
  if (all_alike) return all_alike->p(Alternative::TwoSided, null);
  return {};
}

/// Sets p after Holm over a family of tests; a refused test counts as not significant.
template <class Test>
void correct(std::span<Test> family) {
  std::vector<double> p;
  for (const Test& one : family) p.push_back(one.p().value_or(std::numeric_limits<double>::quiet_NaN()));
  const auto holm = adjust(p, Adjustment::Holm, p.size());
  for (std::size_t i = 0; holm && i < family.size(); ++i)
    if (family[i].p()) family[i].p_holm = holm->p[i];
}

LevelPreference prefer(std::span<const PairChoice> choices, std::span<const FactorPlace> places, int a, int b,
                       const AnalysisPlan& plan) {
  LevelPreference out;
  out.a = a;
  out.b = b;
  std::map<int, std::pair<int, int>> people;  // key: participant; value: choices of a, answers
  for (const PairChoice& choice : choices) {
    const FactorPlace& first = places[static_cast<std::size_t>(choice.first)];
    const FactorPlace& second = places[static_cast<std::size_t>(choice.second)];
    const bool forwards = first.level == a && second.level == b;
    if (first.rest != second.rest || (!forwards && !(first.level == b && second.level == a))) continue;
    const int chosen = choice.first_chosen == forwards ? 1 : 0;
    auto& [mine, answers] = people[choice.participant];
    mine += chosen;
    ++answers;
    out.k += chosen;
    ++out.n;
  }
  out.participants = static_cast<int>(people.size());
  std::vector<double> shares;
  for (const auto& [person, counts] : people) shares.push_back(1.0 * counts.first / counts.second);
  out.shares = t_test_one(shares, {Alternative::TwoSided, plan.confidence, 0.5});
  if (!out.shares) out.all_alike = unanimous(shares);
  return out;
}

/// The sum x + y over a common denominator if an int can hold the denominator, else as a double.
ExactMean sum_of(const ExactMean& x, const ExactMean& y) {
  const auto common = std::lcm(std::int64_t{x.count}, std::int64_t{y.count});
  if (common > most_count) return {x.value() + y.value(), 1};
  const auto count = static_cast<int>(common);
  return {x.sum * (count / x.count) + y.sum * (count / y.count), count};
}

/// Each participant's sum of mean scores over the treatments of one level of the factor; NaN if one of them
/// was not judged.
std::vector<ExactMean> sums_of(const ScoreTable& table, std::span<const FactorPlace> places, int n_star,
                               int level) {
  std::vector<ExactMean> out(static_cast<std::size_t>(table.participants()), ExactMean{0, 1});
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].level != level) continue;
    const auto means = table.means(n_star, static_cast<int>(i));
    for (std::size_t person = 0; person < out.size(); ++person)
      out[person] = sum_of(out[person], means[person]);
  }
  return out;
}

/// The difference level a - level b of each participant who judged all treatments of both levels, averaged
/// over the other factors.
Result<ExactDifferences> differences_of(const ScoreTable& table, std::span<const FactorPlace> places,
                                        int n_star, int a, int b) {
  const auto sums = exact_differences(sums_of(table, places, n_star, a), sums_of(table, places, n_star, b));
  if (!sums) return sums;
  ExactDifferences out = *sums;
  out.denominator *= static_cast<double>(std::count_if(
      places.begin(), places.end(), [&](const FactorPlace& place) { return place.level == a; }));
  return out;
}

LevelDifference differ(const ScoreTable& table, std::span<const FactorPlace> places, int n_star, int a, int b,
                       const AnalysisPlan& plan) {
  LevelDifference out;
  out.n_star = n_star;
  out.a = a;
  out.b = b;
  const auto differences = differences_of(table, places, n_star, a, b);
  if (!differences) {
    out.difference = Refusal{differences.reason()};
    return out;
  }
  out.participants = differences->numerators.size();
  out.difference = t_test_one(differences->values(), {Alternative::TwoSided, plan.confidence, 0});
  if (!out.difference) out.all_alike = unanimous(*differences);
  return out;
}

}  // namespace

std::optional<double> LevelPreference::p() const { return p_of(shares, all_alike, 0.5); }
std::optional<double> LevelDifference::p() const { return p_of(difference, all_alike, 0); }

std::vector<LevelPreference> level_preferences(std::span<const PairChoice> choices,
                                               std::span<const FactorPlace> places, int levels,
                                               const AnalysisPlan& plan) {
  std::vector<LevelPreference> out;
  for (int a = 0; a < levels; ++a)
    for (int b = a + 1; b < levels; ++b) out.push_back(prefer(choices, places, a, b, plan));
  correct(std::span(out));
  return out;
}

std::vector<LevelDifference> level_differences(const ScoreTable& table, std::span<const FactorPlace> places,
                                               int levels, const AnalysisPlan& plan) {
  std::vector<LevelDifference> out;
  for (int n_star = 0; n_star < static_cast<int>(table.n_stars().size()); ++n_star) {
    const auto begin = out.size();
    for (int a = 0; a < levels; ++a)
      for (int b = a + 1; b < levels; ++b) out.push_back(differ(table, places, n_star, a, b, plan));
    correct(std::span(out).subspan(begin));
  }
  return out;
}

}  // namespace stats
