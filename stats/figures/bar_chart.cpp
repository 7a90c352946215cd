#include "stats/figures/bar_chart.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "stats/figures/svg.hpp"

namespace figures {

namespace {

constexpr double label_px = 110;
constexpr double plot_px = 420;
constexpr double bar_px = 16;
constexpr double group_px = 26;
constexpr double value_px = 80;
constexpr const char* colours[] = {svg::colour::sky,    svg::colour::grey, svg::colour::green,
                                   svg::colour::orange, svg::colour::blue, svg::colour::purple};

/// An interval across the bar whose top is at y: a line with a stroke at each end.
std::string whisker(double low, double high, double y) {
  const double top = y + 3, bottom = y + bar_px - 6, middle = (top + bottom) / 2;
  return svg::path(svg::move('M', {low, middle}) + svg::move('L', {high, middle}) +
                       svg::move('M', {low, top}) + svg::move('L', {low, bottom}) +
                       svg::move('M', {high, top}) + svg::move('L', {high, bottom}),
                   "stroke=\"black\" fill=\"none\"");
}

double largest(const BarChart& chart) {
  double most = 0;
  for (const auto& bar : chart.bars) {
    if (std::isfinite(bar.value)) most = std::max(most, bar.value);
    if (std::isfinite(bar.high)) most = std::max(most, bar.high);
  }
  return most > 0 ? most : 1;
}

/// One bar, whose top is at y, with its label, interval and value.
std::string drawn(const BarChart& chart, const BarChart::Bar& bar, const char* colour, double most,
                  double y) {
  const auto length = [&](double value) {
    return std::isfinite(value) ? std::clamp(value / most, 0.0, 1.0) * plot_px : 0.0;
  };
  const double base = y + bar_px - 4, end = length(bar.value);
  const bool interval = std::isfinite(bar.low) && std::isfinite(bar.high);
  std::string out =
      svg::text({label_px - 6, base}, bar.label, "text-anchor=\"end\"") +
      svg::rectangle({label_px, y}, {label_px + end, y + bar_px - 3}, svg::attribute("fill", colour));
  if (interval) out += whisker(label_px + length(bar.low), label_px + length(bar.high), y);
  const double right = std::max(end, interval ? length(bar.high) : 0.0);
  return out +
         svg::text({label_px + right + 5, base}, svg::number(bar.value, chart.digits) + " " + chart.unit);
}

}  // namespace

std::string to_svg(const BarChart& chart) {
  const double most = largest(chart);
  svg::Picture picture{.width = label_px + plot_px + value_px, .id = "bars", .title = chart.title};
  picture.description = "Horizontal bars in groups, each with its value.";
  picture.body = svg::text({8, 20}, chart.title, "font-size=\"14\"") + "<g font-size=\"12\">\n";
  double y = 34;
  std::size_t within = 0;
  for (std::size_t i = 0; i < chart.bars.size(); ++i) {
    const auto& bar = chart.bars[i];
    if (i == 0 || bar.group != chart.bars[i - 1].group) {
      y += group_px;
      within = 0;
      picture.body += svg::text({8, y - 6}, bar.group, "font-weight=\"bold\"");
    }
    picture.body += drawn(chart, bar, colours[within++ % std::size(colours)], most, y);
    y += bar_px;
  }
  picture.body += "</g>\n";
  picture.height = y + 12;
  return svg::document(picture);
}

}  // namespace figures
