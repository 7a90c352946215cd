#pragma once
/// Power of H1 to H6: studies on the protocol's own plan, answered by simulated people and analysed as real
/// data are.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/power/studies.hpp"
#include "libstudy/power/worlds.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// A test at one number of participants.
struct TestPoint {
  Estimated holds;        ///< share of studies in which it holds after Holm
  Estimated uncorrected;  ///< p < alpha in the direction claimed, without Holm
  Estimated against;      ///< significant after Holm in the other direction
  Estimated refused;      ///< share of studies in which the test has no p
  /// Power of the uncorrected test for normal differences (Task 1) or exactly (Task 2). Empty if the plan
  /// gives different studies different numbers of pairs, or with interval bias.
  std::optional<double> closed_form;
  double mean_estimate = 0;  ///< mean difference of answers, or mean share chosen, over studies with an
                             ///< estimate
  int participants_least = 0, participants_most = 0;  ///< participants who gave both answers
};

struct TestPower {
  std::string label, score, n_star, a, b;
  double truth = 0;         ///< true difference a - b, or true preference for a
  bool claim_true = false;  ///< true if the test's claim is true
  std::optional<double> margin;
  std::vector<TestPoint> curve;    ///< indexed as PowerRequest::n
  std::optional<int> n_for_power;  ///< see HypothesisPower
};

struct HypothesisPoint {
  Estimated supported;  ///< every test holds under the plan's rule
  Estimated any;        ///< at least one test holds after Holm
  Estimated any_false;  ///< at least one test with a false claim holds after Holm: the family's error rate
  Estimated paper;      ///< the paper's own, uncorrected rule would have confirmed it
};

struct HypothesisPower {
  std::string id, title, rule, paper_rule;
  stats::HypothesisKind kind = stats::HypothesisKind::Superiority;
  int claims_true = 0;  ///< number of its tests whose claim is true
  std::vector<HypothesisPoint> curve;
  /// The smallest n from which on `supported` reaches the requested power at every requested n; empty if the
  /// claim is not wholly true or the power is not reached.
  std::optional<int> n_for_power;
  std::vector<TestPower> tests;
};

struct WorldPower {
  std::string id, words;
  std::vector<HypothesisPower> hypotheses;
};

/// Task 1 or 2: simulates these studies with each number of participants. The result does not depend on the
/// number of threads. Studies of different size share their first participants, and worlds share their random
/// numbers, so that curves are smooth and differences between worlds precise.
TaskCounts count_task_studies(const PowerRequest& request, StudyRange studies);

/// Summarises the counts over all studies of the request.
std::vector<WorldPower> task_power(const PowerRequest& request, const TaskCounts& counts);

/// Simulates and summarises, in one process.
std::vector<WorldPower> simulate_task_power(const PowerRequest& request);

}  // namespace study
