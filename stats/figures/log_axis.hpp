#pragma once
/// A logarithmic axis of a diagram.

#include <string>
#include <vector>

namespace figures {

struct LogScale {
  double low = 1, high = 10;  ///< 0 < low < high
  /// Relative position of a value: 0 at low, 1 at high.
  double share(double value) const;
};

/// 1, 2 and 5 times each power of ten, from the last one not above `least` to the first one not below `most`,
/// at least two. Over more than three decades only the powers. 0 < least <= most.
std::vector<double> log_ticks(double least, double most);
std::string tick_label(double tick);

}  // namespace figures
