#include "libstudy/power/task_power.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "libstudy/base/random.hpp"
#include "libstudy/power/answers.hpp"
#include "libstudy/power/effect_levels.hpp"
#include "libstudy/power/request.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/inference/power.hpp"

namespace study {

namespace {

using stats::Alternative;
using stats::HypothesisKind;

/// Tolerance when a truth is compared with a margin: truths are sums of decimal fractions and have rounding
/// errors.
constexpr double rounding = 1e-9;

std::optional<double> value_of(const stats::Result<double>& result) {
  return result ? std::optional(*result) : std::nullopt;
}

bool higher_is_better(const stats::HypothesisTest& test) { return test.score == "realism"; }

/// True if the test's claim is true in the simulated world, whose difference or preference is `truth`.
bool claim_is_true(HypothesisKind kind, const stats::HypothesisTest& test, double truth) {
  const double better = higher_is_better(test) ? truth : -truth;
  switch (kind) {
    case HypothesisKind::Superiority:
      return better > rounding;
    case HypothesisKind::Equivalence:
      return std::abs(truth) < test.margin.value_or(0) - rounding;
    case HypothesisKind::NonInferiority:
      return better > -test.margin.value_or(0) + rounding;
    case HypothesisKind::Preference:
      break;
  }
  return truth > 0.5 + rounding;
}

/// Power of a test at n participants by a formula: the probability of p < alpha in the direction claimed.
/// `truth`: true difference, or true preference for a. For Task 1 the formula assumes continuous answers.
/// Empty without a formula: mixed model, levels of effects, interval bias.
std::optional<double> closed_form_power(const PowerRequest& request, const stats::Hypothesis& hypothesis,
                                        const stats::HypothesisTest& test, double truth, int n) {
  const bool by_model = request.plan.plan.tests == stats::ScoreTests::Mixed;
  if (by_model && hypothesis.kind != HypothesisKind::Preference) return {};
  // A symmetric two-sided test rejects in the claimed direction exactly if the one-sided test at half its
  // level does.
  const double level = (hypothesis.one_sided ? 1 : 0.5) * hypothesis.alpha, margin = test.margin.value_or(0);
  const double sd = higher_is_better(test) ? request.sd_realism : request.sd_sickness;
  const double better = higher_is_better(test) ? truth : -truth;
  switch (hypothesis.kind) {
    case HypothesisKind::Superiority:
      return value_of(stats::t_power(n, better / sd, level, stats::Design::Paired, Alternative::Greater));
    case HypothesisKind::Equivalence:
      return value_of(stats::tost_power(n, {-margin, margin, sd, truth, level}));
    case HypothesisKind::NonInferiority:
      return value_of(
          stats::t_power(n, (better + margin) / sd, level, stats::Design::Paired, Alternative::Greater));
    case HypothesisKind::Preference:
      break;
  }
  // Preferences for levels of effects are tested by a t test of shares, for which no formula is computed.
  const bool of_shares = !request.protocol.design.effects.empty();
  if (request.interval_bias != 0 || of_shares) return {};
  const auto power = stats::binomial_power(n, truth, 0.5, level, Alternative::Greater);
  return power ? std::optional(power->power) : std::nullopt;
}

/// One hypothesis of one scenario, with the truth of each of its tests and if each test's claim is true.
struct Judged {
  const Scenario* scenario = nullptr;
  stats::Hypothesis hypothesis;
  std::vector<double> truths;
  std::vector<bool> claims;
};

/// Truth of a test in the scenario: the true difference a - b, or the true preference for a.
double truth_of(const Scenario& scenario, const ShownFactors& factors, const stats::HypothesisTest& test) {
  if (!factors.effects.empty()) return effect_truth(scenario, factors, test);
  const auto index = [](const std::vector<std::string>& list, const std::string& item) {
    return static_cast<std::size_t>(std::find(list.begin(), list.end(), item) - list.begin());
  };
  const std::size_t count = factors.methods.size();
  const std::size_t a = index(factors.methods, test.a), b = index(factors.methods, test.b);
  if (a == count || b == count) return scenario.preferred.empty() ? 0 : 0.5;
  if (!scenario.preferred.empty()) return scenario.preferred[a * count + b];
  const auto& means = test.score == "realism" ? scenario.realism : scenario.sickness;
  const std::size_t row = index(factors.n_stars, test.n_star) * count;
  return means[row + a] - means[row + b];
}

/// The answers of participants 0 to n - 1. `answers` must be ordered by participant.
template <class Answer>
std::span<const Answer> of_first(const std::vector<Answer>& answers, int n) {
  const auto end = std::partition_point(answers.begin(), answers.end(),
                                        [n](const Answer& one) { return one.participant < n; });
  return {answers.begin(), end};
}

class Simulation {
 public:
  explicit Simulation(const PowerRequest& request)
      : request_(request),
        factors_(request.protocol.design),
        worlds_(make_worlds(request, factors_)),
        key_(random_key(request.protocol.sha256 + "\npower " + std::to_string(request.seed))) {
    if (!request.protocol.design.pairs) scatter_ = task1_scatter(request);
    prepare();
  }

  TaskCounts count(StudyRange studies) const {
    TaskCounts out(request_.n.size(), none());
    std::mutex guard;
    for_each_study(studies, "studies", [&](int study) {
      const auto counts = simulate(study);
      const std::lock_guard lock(guard);
      add(out, counts);
    });
    return out;
  }

  std::vector<WorldPower> describe(const TaskCounts& counts) const {
    std::vector<WorldPower> out;
    std::size_t next = 0;
    for (const auto& world : worlds_) {
      out.push_back({world.id, world.words, {}});
      for (const auto& scenario : world.scenarios) {
        for (std::size_t i = 0; i < scenario.hypotheses.size(); ++i)
          out.back().hypotheses.push_back(describe(counts, next++));
      }
    }
    return out;
  }

 private:
  /// Fills judged_. The hypotheses and their tests come from the analysis of a study without answers.
  void prepare() {
    for (const auto& world : worlds_) {
      for (const auto& scenario : world.scenarios) {
        for (auto& hypothesis : analyse(scenario, {}, 0)) {
          Judged one{&scenario, std::move(hypothesis), {}, {}};
          for (const auto& test : one.hypothesis.tests) {
            one.truths.push_back(truth_of(scenario, factors_, test));
            one.claims.push_back(claim_is_true(one.hypothesis.kind, test, one.truths.back()));
          }
          judged_.push_back(std::move(one));
        }
      }
    }
  }

  /// All answers of one study in one scenario, ordered by participant.
  struct Answers {
    Task1Answers task1;
    std::vector<stats::PairChoice> task2;
  };

  Answers answer(const Scenario& scenario, std::span<const ShownTrial> trials, std::uint64_t key) const {
    if (request_.protocol.design.pairs)
      return {{}, answer_task2(trials, factors_, scenario, request_.interval_bias, key)};
    return {answer_task1(trials, factors_, scenario, scatter_, key), {}};
  }

  /// Tests the scenario's hypotheses on the answers of the first n participants.
  std::vector<stats::Hypothesis> analyse(const Scenario& scenario, const Answers& answers, int n) const {
    auto all = request_.protocol.design.pairs ? analyse_task2(answers, n) : analyse_task1(answers, n);
    std::erase_if(all, [&](const stats::Hypothesis& one) {
      return std::find(scenario.hypotheses.begin(), scenario.hypotheses.end(), one.id) ==
             scenario.hypotheses.end();
    });
    return all;
  }

  std::vector<stats::Hypothesis> analyse_task1(const Answers& answers, int n) const {
    const auto& plan = request_.plan.plan;
    const stats::ScoreTable realism(
        {"realism", "", true, scatter_.realism_min, scatter_.realism_max, true, {}, plan.margin_realism},
        of_first(answers.task1.realism, n), n, factors_.n_stars, factors_.methods);
    const stats::ScoreTable sickness(
        {"sickness", "", true, scatter_.item_min, scatter_.item_max, false, {}, plan.margin_sickness},
        of_first(answers.task1.sickness, n), n, factors_.n_stars, factors_.methods);
    return stats::task1_hypotheses(claims_in_force(plan), realism, sickness, plan, "");
  }

  std::vector<stats::Hypothesis> analyse_task2(const Answers& answers, int n) const {
    const auto& plan = request_.plan.plan;
    if (!factors_.effects.empty()) return {effect_hypothesis(of_first(answers.task2, n), factors_, plan)};
    const auto pairs =
        stats::count_preferences(of_first(answers.task2, n), static_cast<int>(factors_.methods.size()), plan);
    return stats::task2_hypotheses(claims_in_force(plan), pairs, factors_.methods, plan, "");
  }

  /// Counts of 0 for every hypothesis.
  std::vector<HypothesisCount> none() const {
    std::vector<HypothesisCount> out;
    for (const auto& one : judged_) out.push_back({.tests = std::vector<TestCount>(one.claims.size())});
    return out;
  }

  TaskCounts simulate(int study) const {
    const std::uint64_t key = counter_random(key_, static_cast<std::uint64_t>(study));
    const auto trials = planned_trials(request_.protocol, key, request_.n.back());
    TaskCounts out(request_.n.size());
    std::size_t first = 0;
    for (const auto& world : worlds_) {
      for (const auto& scenario : world.scenarios) {
        const Answers answers = answer(scenario, trials, key);
        for (std::size_t n = 0; n < request_.n.size(); ++n) {
          std::size_t judged = first;
          for (const auto& hypothesis : analyse(scenario, answers, request_.n[n]))
            out[n].push_back(count_hypothesis(hypothesis, judged_[judged++].claims));
        }
        first += scenario.hypotheses.size();
      }
    }
    return out;
  }

  TestPower describe_test(const TaskCounts& counts, std::size_t of, std::size_t index) const {
    const Judged& judged = judged_[of];
    const auto& test = judged.hypothesis.tests[index];
    TestPower out{test.label,           test.score,           test.n_star, test.a, test.b,
                  judged.truths[index], judged.claims[index], test.margin, {},     {}};
    const int studies = request_.studies;
    for (std::size_t n = 0; n < request_.n.size(); ++n) {
      const auto& count = counts[n][of].tests[index];
      TestPoint point;
      point.holds = share_of(count.holds, studies);
      point.uncorrected = share_of(count.uncorrected, studies);
      point.against = share_of(count.against, studies);
      point.refused = share_of(count.refused, studies);
      point.mean_estimate = count.mean_estimate();
      point.participants_least = count.participants_least;
      point.participants_most = count.participants_most;
      if (count.participants_least == count.participants_most)
        point.closed_form =
            closed_form_power(request_, judged.hypothesis, test, out.truth, count.participants_most);
      out.curve.push_back(point);
    }
    if (out.claim_true) out.n_for_power = lasting([&](std::size_t n) { return out.curve[n].holds.value; });
    return out;
  }

  HypothesisPower describe(const TaskCounts& counts, std::size_t of) const {
    const Judged& judged = judged_[of];
    const auto& hypothesis = judged.hypothesis;
    HypothesisPower out;
    out.id = hypothesis.id;
    out.title = hypothesis.title;
    out.rule = hypothesis.rule;
    out.paper_rule = hypothesis.paper_rule;
    out.kind = hypothesis.kind;
    for (std::size_t i = 0; i < hypothesis.tests.size(); ++i) {
      out.tests.push_back(describe_test(counts, of, i));
      out.claims_true += judged.claims[i] ? 1 : 0;
    }
    for (const auto& at : counts) {
      const auto& count = at[of];
      out.curve.push_back({share_of(count.supported, request_.studies), share_of(count.any, request_.studies),
                           share_of(count.any_false, request_.studies),
                           share_of(count.paper, request_.studies)});
    }
    if (out.claims_true == static_cast<int>(out.tests.size()))
      out.n_for_power = lasting([&](std::size_t n) { return out.curve[n].supported.value; });
    return out;
  }

  /// The smallest n such that the requested power is reached at this n and at every larger requested n.
  template <class Power>
  std::optional<int> lasting(Power power) const {
    std::optional<int> out;
    for (std::size_t n = request_.n.size(); n-- > 0 && power(n) >= request_.power;) out = request_.n[n];
    return out;
  }

  const PowerRequest& request_;
  ShownFactors factors_;
  std::vector<World> worlds_;
  std::uint64_t key_;
  Task1Scatter scatter_;
  std::vector<Judged> judged_;
};

}  // namespace

TaskCounts count_task_studies(const PowerRequest& request, StudyRange studies) {
  return Simulation(request).count(studies);
}

std::vector<WorldPower> task_power(const PowerRequest& request, const TaskCounts& counts) {
  return Simulation(request).describe(counts);
}

std::vector<WorldPower> simulate_task_power(const PowerRequest& request) {
  return task_power(request, count_task_studies(request, {0, request.studies}));
}

}  // namespace study
