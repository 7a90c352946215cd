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

/// Consecutive studies. A study is identified by its number, whichever process simulates it and with which
/// others.
struct StudyRange {
  int first = 0, count = 0;
};

/// Runs `simulate` for each study, on all threads, in any order, with a progress bar. The first exception
/// stops it and is rethrown.
void for_each_study(StudyRange studies, const std::string& label, const std::function<void(int)>& simulate);

/// A figure and its Monte-Carlo standard error.
struct Estimated {
  double value = 0, se = 0;
};

/// The share k of n. The error is that of (k + 1) of (n + 2), so that it is never 0.
Estimated share_of(std::int64_t k, int n);
/// Mean of the values, summed in the order given; at least two.
Estimated mean_of(std::span<const double> values);
/// Sample quantile; its error is half the distance between the order statistics one binomial standard
/// deviation to either side. At least two values.
Estimated quantile_of(std::span<const double> values, double share);

/// Counts over simulated studies of Task 1 or 2. Counts are whole numbers, so sums depend neither on their
/// order nor on which process counted them.
struct TestCount {
  std::int64_t holds = 0, uncorrected = 0, against = 0, refused = 0;  ///< studies
  std::int64_t estimates = 0;                                         ///< studies with an estimate
  std::int64_t estimate_units = 0;                                    ///< their sum, in 1e-9
  int participants_least = 1 << 30, participants_most = 0;            ///< participants who gave both answers

  void add(const TestCount& other);
  double mean_estimate() const;  ///< 0 without an estimate
};

struct HypothesisCount {
  std::int64_t supported = 0, any = 0, any_false = 0, paper = 0;  ///< studies, as HypothesisPoint
  std::vector<TestCount> tests;

  /// Adds counts of the same hypothesis.
  void add(const HypothesisCount& other);
};

/// Indexed by number of participants as PowerRequest::n, then by hypothesis in the order of the worlds.
using TaskCounts = std::vector<std::vector<HypothesisCount>>;

/// Counts of one study. claims: for each test, true if its claim is true.
HypothesisCount count_hypothesis(const stats::Hypothesis& hypothesis, const std::vector<bool>& claims);

/// Adds counts of the same request.
void add(TaskCounts& sum, const TaskCounts& other);

}  // namespace study
