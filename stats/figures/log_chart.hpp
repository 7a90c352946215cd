#pragma once
/// Points on two logarithmic axes with a straight line through them, as SVG.

#include <string>
#include <vector>

namespace figures {

struct LogChart {
  struct Point {
    double x = 0, y = 0;  ///< above 0
    double high = 0;  ///< upper end of a stroke from y; y or less: none
  };
  std::string title, x_title, y_title;
  std::string note;           ///< beside the line
  std::vector<Point> points = {};  ///< at least one
  double slope = 0;           ///< of the line: y = factor x^slope
  double factor = 0;          ///< above 0
};
std::string to_svg(const LogChart& chart);

}  // namespace figures
