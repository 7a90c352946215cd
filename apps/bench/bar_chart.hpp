#pragma once
/// A chart of horizontal bars in groups, as SVG.

#include <string>
#include <vector>

namespace apps {

struct BarChart {
  struct Bar {
    std::string group, label;
    double value = 0;  ///< at least 0; others are drawn as 0 and labelled as they are
  };
  std::string title, unit;
  std::vector<Bar> bars;  ///< bars of a group stand together, in this order
};
std::string to_svg(const BarChart& chart);

}  // namespace apps
