#include "stats/analysis/factor_levels.hpp"

#include <cmath>
#include <limits>
#include <map>

#include "stats/inference/adjust.hpp"

namespace stats {

namespace {

/// Of the t test, or of the exact sign test in its place.
std::optional<double> p_of(const Result<OneSampleTTest>& test, const std::optional<Unanimous>& all_alike,
                           double null) {
  if (test) return test->p;
  if (all_alike) return all_alike->p(Alternative::TwoSided, null);
  return {};
}

/// Holm over a family; a refused test counts as not significant.
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
  std::map<int, std::pair<int, int>> people;  // a chosen, answers
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

/// Mean over the rest of a - b of one participant; NaN where a treatment of either level was not judged.
double difference_of(const ScoreTable& table, std::span<const FactorPlace> places, int n_star, int a, int b,
                     std::size_t participant) {
  std::map<int, std::pair<double, double>> rests;  // by the other factors
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double value = table.column(n_star, static_cast<int>(i))[participant];
    if (places[i].level == a) rests[places[i].rest].first = value;
    if (places[i].level == b) rests[places[i].rest].second = value;
  }
  double sum = 0;
  for (const auto& [rest, values] : rests) sum += values.first - values.second;
  return sum / static_cast<double>(rests.size());
}

LevelDifference differ(const ScoreTable& table, std::span<const FactorPlace> places, int n_star, int a, int b,
                       const AnalysisPlan& plan) {
  LevelDifference out;
  out.n_star = n_star;
  out.a = a;
  out.b = b;
  std::vector<double> differences;
  for (int person = 0; person < table.participants(); ++person) {
    const double value = difference_of(table, places, n_star, a, b, static_cast<std::size_t>(person));
    if (!std::isnan(value)) differences.push_back(value);
  }
  out.participants = differences.size();
  out.difference = t_test_one(differences, {Alternative::TwoSided, plan.confidence, 0});
  if (!out.difference) out.all_alike = unanimous(differences);
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
