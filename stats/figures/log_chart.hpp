#pragma once
/// Logarithmic axes, and charts as SVG of points and a straight line on two such axes.

#include <string>
#include <vector>

namespace figures {

/// A logarithmic axis of a diagram.
struct LogScale {
  double low = 1, high = 10;  ///< 0 < low < high
  /// Relative position of a value: 0 at low, 1 at high.
  double share(double value) const;
};

/// Ticks of an axis from `least` to `most`, 0 < least <= most: 1, 2 and 5 times each power of ten, or the
/// powers of ten alone if most > 1000 least. They run from the last tick not above `least` to the first tick
/// not below `most`; at least two.
std::vector<double> log_ticks(double least, double most);
std::string tick_label(double tick);

struct LogChart {
  struct Point {
    double x = 0, y = 0;  ///< above 0
    double high = 0;      ///< upper end of a vertical stroke that begins at y; no stroke if high <= y
  };
  std::string title, x_title, y_title;
  std::string note;                ///< text in the upper left corner of the plot
  std::vector<Point> points = {};  ///< at least one
  double slope = 0;                ///< exponent of the line y = factor * x^slope
  double factor = 0;               ///< above 0
};
std::string to_svg(const LogChart& chart);

}  // namespace figures
