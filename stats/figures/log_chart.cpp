#include "stats/figures/log_chart.hpp"

#include <algorithm>
#include <cmath>

#include "stats/figures/svg.hpp"
#include "stats/figures/text_table.hpp"

namespace figures {

double LogScale::share(double value) const { return std::log(value / low) / std::log(high / low); }

std::vector<double> log_ticks(double least, double most) {
  const bool powers_alone = most > 1000 * least;
  std::vector<double> out;
  for (double power = std::pow(10, std::floor(std::log10(least)));; power *= 10) {
    for (const double tick : {power, 2 * power, 5 * power}) {
      if (powers_alone && tick > power) continue;
      if (tick <= least) out.clear();
      out.push_back(tick);
      if (tick >= most && out.size() > 1) return out;
    }
  }
}

std::string tick_label(double tick) { return tick < 1 ? shortest(tick) : number(tick, 0); }

namespace {

constexpr double left_px = 78, top_px = 44, plot_width_px = 420, plot_height_px = 300;
constexpr const char* axis = R"( stroke="#333" fill="none")";
constexpr const char* grid = R"( stroke="#ddd" fill="none")";
constexpr const char* middle = R"( text-anchor="middle")";

}  // namespace

std::string to_svg(const LogChart& chart) {
  const auto [first, last] = std::minmax_element(chart.points.begin(), chart.points.end(),
                                                 [](const auto& a, const auto& b) { return a.x < b.x; });
  double least = chart.points.front().y, most = least;
  for (const auto& point : chart.points) {
    least = std::min(least, point.y);
    most = std::max({most, point.y, point.high});
  }
  const auto x_ticks = log_ticks(first->x, last->x), y_ticks = log_ticks(least, most);
  const LogScale x_scale{x_ticks.front(), x_ticks.back()}, y_scale{y_ticks.front(), y_ticks.back()};
  const double right = left_px + plot_width_px, bottom = top_px + plot_height_px;
  const auto at = [&](double x, double y) {
    return svg::Point{left_px + x_scale.share(x) * plot_width_px, bottom - y_scale.share(y) * plot_height_px};
  };

  svg::Picture picture{.width = right + 24, .height = bottom + 56, .id = "growth", .title = chart.title};
  picture.description = chart.y_title + " over " + chart.x_title + ", both axes logarithmic. " + chart.note;
  picture.body = svg::text({8, 20}, chart.title, "font-size=\"14\"") + "<g font-size=\"12\">\n";
  for (const double tick : x_ticks) {
    const double x = at(tick, y_scale.low).x;
    picture.body +=
        svg::line({x, top_px}, {x, bottom}, grid) + svg::text({x, bottom + 17}, tick_label(tick), middle);
  }
  for (const double tick : y_ticks) {
    const double y = at(x_scale.low, tick).y;
    picture.body += svg::line({left_px, y}, {right, y}, grid) +
                    svg::text({left_px - 6, y + 4}, tick_label(tick), "text-anchor=\"end\"");
  }
  picture.body += svg::line({left_px, top_px}, {left_px, bottom}, axis) +
                  svg::line({left_px, bottom}, {right, bottom}, axis) +
                  svg::text({(left_px + right) / 2, bottom + 40}, chart.x_title, middle) +
                  svg::text({left_px, top_px - 8}, chart.y_title);
  const auto on_line = [&](double x) { return at(x, chart.factor * std::pow(x, chart.slope)); };
  picture.body += svg::line(on_line(first->x), on_line(last->x),
                            svg::attribute("stroke", svg::colour::sky) + " stroke-width=\"2\"");
  for (const auto& point : chart.points) {
    if (point.high > point.y) picture.body += svg::line(at(point.x, point.y), at(point.x, point.high), axis);
    picture.body += svg::circle(at(point.x, point.y), 4, svg::attribute("fill", svg::colour::blue));
  }
  picture.body += svg::text({left_px + 12, top_px + 20}, chart.note) + "</g>\n";
  return svg::document(picture);
}

}  // namespace figures
