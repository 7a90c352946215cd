#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace base {

inline double milliseconds_now() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The element at index q (n - 1), rounded, of the n sorted values; n >= 1 and 0 <= q <= 1.
inline double quantile(std::vector<double> values, double q) {
  const auto rank = std::lround(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace base
