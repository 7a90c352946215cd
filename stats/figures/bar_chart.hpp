#pragma once
/// A chart of horizontal bars in groups, as SVG.

#include <limits>
#include <string>
#include <vector>

namespace figures {

struct BarChart {
  struct Bar {
    std::string group, label;
    double value = 0;  ///< a negative or non-finite value has no bar; its label shows the value
    /// Ends of an interval, drawn over the bar if both are finite.
    double low = std::numeric_limits<double>::quiet_NaN();
    double high = std::numeric_limits<double>::quiet_NaN();
  };
  std::string title, unit;
  int digits = 2;         ///< decimals of the values
  std::vector<Bar> bars;  ///< bars of a group are consecutive
};
std::string to_svg(const BarChart& chart);

}  // namespace figures
