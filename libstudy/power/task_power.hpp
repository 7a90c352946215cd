#pragma once
/// Computes the power of hypotheses about methods (or of levels of effects). Studies with the protocol's plan
/// are answered by simulated people and analysed like real data.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/power/studies.hpp"
#include "libstudy/power/worlds.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// One test at one number of participants.
struct TestPoint {
  Estimated holds;        ///< share of studies in which the test holds after Holm's correction
  Estimated uncorrected;  ///< share with p < alpha in the direction claimed, without correction
  Estimated against;      ///< share with significance in the other direction after Holm's correction
  Estimated refused;      ///< share of studies in which the test has no p
  /// Power of the uncorrected test by a formula, for normal differences (Task 1) or exactly (Task 2). Empty
  /// if participants_least differs from participants_most, for the mixed model, for levels of effects and
  /// with interval bias.
  std::optional<double> closed_form;
  /// Mean over studies of the estimated difference a - b, or of the share of answers that chose a.
  double mean_estimate = 0;
  /// Smallest and largest number in a study of participants whose answers the test uses; in tests of a
  /// preference between two methods, of answers to the pair.
  int participants_least = 0, participants_most = 0;
};

struct TestPower {
  std::string label, score, n_star, a, b;
  double truth = 0;         ///< true difference a - b, or true preference for a
  bool claim_true = false;  ///< true if the test's claim is true in the world
  std::optional<double> margin;
  std::vector<TestPoint> curve;  ///< one point for each of PowerRequest::n
  /// The smallest requested n such that TestPoint::holds reaches the requested power at this n and every
  /// larger one. Empty if no such n exists or if the claim is false.
  std::optional<int> n_for_power;
};

struct HypothesisPoint {
  Estimated supported;  ///< share of studies in which every test holds under the plan's rule
  Estimated any;        ///< share in which at least one test holds after Holm's correction
  Estimated any_false;  ///< share in which a test with a false claim holds after Holm's correction:
                        ///< familywise error rate
  Estimated paper;      ///< share in which the paper's uncorrected rule supports the hypothesis
};

struct HypothesisPower {
  std::string id, title, rule, paper_rule;
  stats::HypothesisKind kind = stats::HypothesisKind::Superiority;
  int claims_true = 0;  ///< number of tests whose claim is true in the world
  std::vector<HypothesisPoint> curve;
  /// The smallest requested n such that `supported` reaches the requested power at this n and every larger
  /// one. Empty if no such n exists or if a test's claim is false.
  std::optional<int> n_for_power;
  std::vector<TestPower> tests;
};

struct WorldPower {
  std::string id, words;
  std::vector<HypothesisPower> hypotheses;
};

/// Task 1 or 2: simulates `studies` with each number of participants. The result does not depend on the
/// number of threads. A study with 10 participants has the first 10 participants of the study with 20 that
/// has the same number, which makes curves over n smooth. All worlds use the same random numbers, which makes
/// differences between worlds precise.
TaskCounts count_task_studies(const PowerRequest& request, StudyRange studies);

/// Summarises the counts over all studies of the request.
std::vector<WorldPower> task_power(const PowerRequest& request, const TaskCounts& counts);

/// Simulates all studies of the request and summarises the counts.
std::vector<WorldPower> simulate_task_power(const PowerRequest& request);

}  // namespace study
