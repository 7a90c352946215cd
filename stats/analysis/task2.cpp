#include "stats/analysis/task2.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stats/inference/adjust.hpp"
#include "stats/inference/binomial.hpp"
#include "stats/inference/t_test.hpp"

namespace stats {

namespace {

constexpr std::int64_t largest_sum = 1'000'000;

/// Probabilities of the sums -total, -total + 1, ..., total of +-values, where each sign has probability one
/// half.
std::vector<double> distribution_of(const std::vector<std::int64_t>& values, std::int64_t total) {
  std::vector<double> mass(static_cast<std::size_t>(2 * total + 1), 0.0);
  const auto at = [&](std::int64_t sum) { return static_cast<std::size_t>(sum + total); };
  mass[at(0)] = 1;
  std::int64_t reach = 0;
  for (const std::int64_t value : values) {
    std::vector<double> next(mass.size(), 0.0);
    for (std::int64_t sum = -reach; sum <= reach; ++sum) {
      if (mass[at(sum)] == 0) continue;
      next[at(sum + value)] += mass[at(sum)] / 2;
      next[at(sum - value)] += mass[at(sum)] / 2;
    }
    mass = std::move(next);
    reach += value;
  }
  return mass;
}

void add_interval(ShareTest& out, const std::vector<double>& shares, Alternative alternative,
                  double confidence) {
  out.ci = {0, 1};
  out.ci_name = "0 to 1, as all shares are equal";
  const auto test = t_test_one(shares, {alternative, confidence, 0.5, false});
  if (test) {
    out.ci = {std::max(0.0, test->ci[0]), std::min(1.0, test->ci[1])};
    out.ci_name = "Student's t of people's shares, within 0 to 1";
    return;
  }
  const auto n = static_cast<int>(shares.size());
  const bool always_alike = shares[0] == 0 || shares[0] == 1;
  if (!always_alike) return;
  const auto counted = binomial_test(shares[0] == 1 ? n : 0, n, 0.5, alternative, confidence);
  if (!counted) return;
  out.ci = counted->clopper_pearson;
  out.ci_name = "Clopper-Pearson over people, as all always chose alike";
}

}  // namespace

Result<ShareTest> share_test(std::span<const PersonChoices> people, Alternative alternative,
                             double confidence) {
  if (people.empty()) return Refusal{"no answers"};
  std::int64_t common = 1;
  for (const auto& one : people) {
    common = std::lcm(common, std::int64_t{one.n});
    if (common > largest_sum) return Refusal{"the numbers of answers have no small common denominator"};
  }
  std::vector<std::int64_t> values;
  std::vector<double> shares;
  std::int64_t sum = 0, total = 0;
  for (const auto& one : people) {
    const std::int64_t value = (2 * one.k - one.n) * (common / one.n);
    sum += value;
    total += std::abs(value);
    values.push_back(std::abs(value));
    shares.push_back(static_cast<double>(one.k) / one.n);
    if (total > largest_sum) return Refusal{"the numbers of answers have no small common denominator"};
  }
  const auto mass = distribution_of(values, total);
  double p = 0;
  for (std::int64_t at = -total; at <= total; ++at) {
    const bool counts = alternative == Alternative::Greater ? at >= sum
                        : alternative == Alternative::Less  ? at <= sum
                                                            : std::abs(at) >= std::abs(sum);
    if (counts) p += mass[static_cast<std::size_t>(at + total)];
  }
  ShareTest out;
  out.participants = static_cast<int>(people.size());
  out.share = std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
  add_interval(out, shares, alternative, confidence);
  out.p = std::min(1.0, p);
  return out;
}

namespace {

PairPreference count_pair(std::span<const PairChoice> choices, int a, int b, const AnalysisPlan& plan) {
  PairPreference out;
  out.a = a;
  out.b = b;
  std::map<int, PersonChoices> people;
  for (const PairChoice& choice : choices) {
    const bool forwards = choice.first == a && choice.second == b;
    if (!forwards && !(choice.first == b && choice.second == a)) continue;
    auto& person = people[choice.participant];
    if (plan.repeated_pairs == RepeatedPairs::First && person.n > 0) continue;
    ++person.n;
    person.k += choice.first_chosen == forwards ? 1 : 0;
    ++out.n;
    out.a_first += forwards ? 1 : 0;
    out.first_chosen += choice.first_chosen ? 1 : 0;
    out.k += choice.first_chosen == forwards ? 1 : 0;
    out.max_per_participant = std::max(out.max_per_participant, person.n);
  }
  for (const auto& [participant, person] : people) {
    out.people.push_back(person);
    out.several += person.n > 1 ? 1 : 0;
  }
  out.participants = static_cast<int>(people.size());
  return out;
}

void test_pair(PairPreference& pair, const AnalysisPlan& plan) {
  pair.test = binomial_test(pair.k, pair.n, 0.5, Alternative::TwoSided, plan.confidence);
  if (pair.max_per_participant <= 1) return;
  if (plan.repeated_pairs == RepeatedPairs::Share) {
    const auto shares = share_test(pair.people, Alternative::TwoSided, plan.confidence);
    pair.test =
        Refusal{shares ? "each person's share is tested in place of single answers" : shares.reason()};
    if (shares) pair.shares = *shares;
    return;
  }
  pair.warning = std::to_string(pair.several) + " of " + std::to_string(pair.participants) +
                 " participants answered this pair more than once, at most " +
                 std::to_string(pair.max_per_participant) +
                 " times, as in several scenes: answers of one person are not independent, and the binomial "
                 "test then rejects too often";
  if (plan.repeated_pairs == RepeatedPairs::Refuse) pair.test = Refusal{pair.warning};
}

void correct(std::vector<PairPreference>& pairs) {
  std::vector<double> p;
  for (const auto& pair : pairs) p.push_back(pair.p().value_or(std::numeric_limits<double>::quiet_NaN()));
  const auto holm = adjust(p, Adjustment::Holm, p.size());
  const auto bh = adjust(p, Adjustment::BenjaminiHochberg, p.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (holm && pairs[i].p()) pairs[i].p_holm = holm->p[i];
    if (bh && pairs[i].p()) pairs[i].p_bh = bh->p[i];
  }
}

std::vector<Comparison> comparisons(std::span<const PairChoice> choices) {
  std::vector<Comparison> out;
  for (const PairChoice& choice : choices)
    out.push_back(
        {choice.first, choice.second, choice.first_chosen, choice.position + 1.0, choice.participant});
  return out;
}

IntervalBias test_intervals(std::span<const PairChoice> choices, int methods, const AnalysisPlan& plan) {
  IntervalBias out;
  std::map<int, std::pair<int, int>> people;  // key: participant; value: choices of the first interval,
                                              // answers
  for (const PairChoice& choice : choices) {
    auto& [first, answers] = people[choice.participant];
    first += choice.first_chosen ? 1 : 0;
    ++answers;
    out.first_chosen += choice.first_chosen ? 1 : 0;
  }
  out.n = static_cast<int>(choices.size());
  out.test = binomial_test(out.first_chosen, out.n, 0.5, Alternative::TwoSided, plan.confidence);
  std::vector<double> shares;
  for (const auto& [person, counts] : people) shares.push_back(1.0 * counts.first / counts.second);
  out.by_participant = t_test_one(shares, {Alternative::TwoSided, plan.confidence, 0.5});
  if (!out.by_participant) out.all_alike = unanimous(shares);
  out.model = order_bias(comparisons(choices), methods, plan.confidence);
  return out;
}

using ChoicesByPerson = std::map<int, std::vector<PairChoice>>;

bool answered_twice(const std::vector<PairChoice>& own) {
  std::set<std::pair<int, int>> pairs;
  return std::any_of(own.begin(), own.end(), [&](const PairChoice& one) {
    return !pairs.emplace(std::min(one.first, one.second), std::max(one.first, one.second)).second;
  });
}

/// The reason why there are no triads, if no participant answered every pair exactly once.
std::string why_no_triads(const ChoicesByPerson& people, int methods) {
  if (people.empty()) return "no answers";
  if (methods < 3) return "fewer than three methods have no triad";
  const auto several = std::count_if(people.begin(), people.end(),
                                     [](const auto& person) { return answered_twice(person.second); });
  const std::string all = std::to_string(people.size());
  if (several == 0) return "none of " + all + " participants answered every pair";
  return std::to_string(several) + " of " + all +
         " participants answered a pair more than once, and triads are counted where each pair was answered "
         "once";
}

void count_triads(PreferenceAnalysis& out, std::span<const PairChoice> choices, int methods) {
  ChoicesByPerson people;
  for (const PairChoice& choice : choices) people[choice.participant].push_back(choice);
  std::vector<CircularTriads> complete;
  for (const auto& [participant, own] : people) {
    out.triads.push_back({participant, circular_triads(win_table(comparisons(own), methods), methods)});
    if (out.triads.back().triads) complete.push_back(*out.triads.back().triads);
  }
  out.group_triads = complete.empty() ? Refusal{why_no_triads(people, methods)} : group_triads(complete);
}

}  // namespace

std::optional<double> PairPreference::p() const {
  if (shares) return shares->p;
  return test ? std::optional(test->p) : std::nullopt;
}

std::vector<PairPreference> count_preferences(std::span<const PairChoice> choices, int methods,
                                              const AnalysisPlan& plan) {
  std::vector<PairPreference> pairs;
  for (int a = 0; a < methods; ++a) {
    for (int b = a + 1; b < methods; ++b) {
      pairs.push_back(count_pair(choices, a, b, plan));
      test_pair(pairs.back(), plan);
    }
  }
  correct(pairs);
  return pairs;
}

PreferenceAnalysis analyse_preferences(std::span<const PairChoice> choices, int methods,
                                       const AnalysisPlan& plan) {
  PreferenceAnalysis out;
  const auto trials = comparisons(choices);
  check_trials(trials, methods);
  out.pairs = count_preferences(choices, methods, plan);
  out.interval = test_intervals(choices, methods, plan);
  out.bradley_terry = bradley_terry(trials, methods, BradleyTerryMethod::Automatic, plan.confidence);
  count_triads(out, choices, methods);
  return out;
}

}  // namespace stats
