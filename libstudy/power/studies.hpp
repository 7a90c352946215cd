#pragma once
/// Runs simulated studies in parallel, and summarises counts over them.

#include <cstdint>
#include <functional>
#include <span>
#include <string>

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

}  // namespace study
