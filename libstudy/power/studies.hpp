#pragma once
/// Runs simulated studies in parallel, and summarises counts over them.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/hypotheses.hpp"

namespace study {

/// Consecutive studies, from number `first` on. The request and a study's number determine the study's random
/// numbers.
struct StudyRange {
  int first = 0, count = 0;
};

/// Calls `simulate` with each study's number, on all threads and in any order, and shows a progress bar.
/// After an exception no further study begins, and the exception is rethrown.
void for_each_study(StudyRange studies, const std::string& label, const std::function<void(int)>& simulate);

/// A value estimated by simulation and its Monte-Carlo standard error.
struct Estimated {
  double value = 0, se = 0;
};

/// The share k / n. Its standard error is computed for the share (k + 1) / (n + 2) and so is never 0.
Estimated share_of(std::int64_t k, int n);
/// Mean of at least two values.
Estimated mean_of(std::span<const double> values);
/// Sample quantile of at least two values. Its standard error is half the distance between two order
/// statistics, whose ranks are one binomial standard deviation below and above the quantile's rank.
Estimated quantile_of(std::span<const double> values, double share);

/// Counts of one test over simulated studies of Task 1 or 2. All are whole numbers, so a sum depends neither
/// on its order nor on the processes that counted.
struct TestCount {
  /// Numbers of studies in which the test holds after Holm's correction, has p < alpha in the direction
  /// claimed without correction, is significant in the other direction after Holm's correction, has no p.
  std::int64_t holds = 0, uncorrected = 0, against = 0, refused = 0;
  std::int64_t estimates = 0;       ///< number of studies with an estimate
  std::int64_t estimate_units = 0;  ///< sum of the estimates in units of 1e-9
  /// Smallest and largest number in a study of participants whose answers the test uses; in tests of a
  /// preference between two methods, of answers to the pair.
  int participants_least = 1 << 30, participants_most = 0;

  void add(const TestCount& other);
  double mean_estimate() const;  ///< mean of the estimates; 0 without an estimate
};

struct HypothesisCount {
  /// Numbers of studies in which every test holds under the plan's rule, any test holds after Holm's
  /// correction, any test with a false claim does, the paper's uncorrected rule supports the hypothesis.
  std::int64_t supported = 0, any = 0, any_false = 0, paper = 0;
  std::vector<TestCount> tests;

  /// Adds counts of the same hypothesis over other studies.
  void add(const HypothesisCount& other);
};

/// First index: number of participants, as in PowerRequest::n. Second index: hypothesis, in the order of
/// worlds and their scenarios.
using TaskCounts = std::vector<std::vector<HypothesisCount>>;

/// Counts of one study. `claims`: for each test, true if the test's claim is true in the simulated world.
HypothesisCount count_hypothesis(const stats::Hypothesis& hypothesis, const std::vector<bool>& claims);

/// Adds to `sum` the counts of the same request over other studies.
void add(TaskCounts& sum, const TaskCounts& other);

}  // namespace study
