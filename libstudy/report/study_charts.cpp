#include <algorithm>
#include <cmath>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

constexpr double left = 60, top = 40, width = 540, plot_height = 240, right = 20;
constexpr double largest_radius = 9, smallest_radius = 2.5;

struct Scale {
  double low = 0, high = 1;
  double x(double value) const { return left + width * (value - low) / (high > low ? high - low : 1); }
};

double y_of(double share) { return top + plot_height * (1 - share); }

/// Distance between the marks of an axis of this range: 1, 2 or 5 times a power of ten, for about six marks.
double step_of(double range) {
  if (!(range > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(range / 6)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / (factor * power) <= 7) return factor * power;
  return 10 * power;
}

std::string axes(const Scale& scale, const std::string& unit) {
  std::string out;
  for (int tenth = 0; tenth <= 10; tenth += 2) {
    const double y = y_of(tenth / 10.0);
    out += svg::line({left, y}, {left + width, y}, "stroke=\"#000000\" stroke-opacity=\"0.25\"") +
           svg::text({left - 8, y + 5}, svg::number(tenth / 10.0, 1),
                     "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
  }
  const double step = step_of(scale.high - scale.low);
  for (double value = std::ceil(scale.low / step) * step; value <= scale.high + 1e-9; value += step)
    out += svg::line({scale.x(value), y_of(0)}, {scale.x(value), y_of(0) + 5}, "stroke=\"#000000\"") +
           svg::text({scale.x(value), y_of(0) + 20}, svg::number(value, step < 1 ? 2 : 0),
                     "class=\"axis\" text-anchor=\"middle\" font-size=\"13\"");
  return out + svg::text({left + width / 2, y_of(0) + 42}, unit, "text-anchor=\"middle\" font-size=\"13\"");
}

std::string curve_line(const Field& track, const Scale& scale) {
  std::string moves;
  for (const Field& point : track["curve"].entries())
    moves += svg::move(moves.empty() ? 'M' : 'L',
                       {scale.x(point["value"].number()), y_of(point["share"].number())}) +
             " ";
  return svg::path(moves, svg::attribute("stroke", svg::colour::blue) + " stroke-width=\"2\" fill=\"none\"");
}

/// A circle at the share of positive answers of each level. Its area is proportional to the number of trials,
/// but its radius is at least smallest_radius.
std::string points(const Field& track, const Scale& scale) {
  double most = 1;
  for (const Field& point : track["points"].entries()) most = std::max(most, point["trials"].number());
  std::string out;
  for (const Field& point : track["points"].entries()) {
    if (!point["share"].is_number()) continue;
    const double radius =
        std::max(smallest_radius, largest_radius * std::sqrt(point["trials"].number() / most));
    out +=
        svg::circle({scale.x(point["value"].number()), y_of(point["share"].number())}, radius,
                    "stroke=\"#000000\" fill=\"#000000\" fill-opacity=\"0.15\"" + data_field(point["share"]));
  }
  return out;
}

/// A vertical line at the mean threshold, with its interval.
std::string threshold_line(const Field& track, const Scale& scale) {
  const double x = scale.x(track["mean"].number());
  const std::string style = svg::attribute("stroke", svg::colour::vermilion) + " stroke-width=\"1.6\"";
  std::string out = svg::line({x, y_of(0)}, {x, y_of(1)}, style + " stroke-dasharray=\"5 4\"");
  const auto ends = track["ci"].entries();
  if (ends.size() == 2)
    out += svg::line({std::max(left, scale.x(ends[0].number())), y_of(0.02)},
                     {std::min(left + width, scale.x(ends[1].number())), y_of(0.02)},
                     svg::attribute("stroke", svg::colour::vermilion) + " stroke-width=\"4\"");
  return out;
}

}  // namespace

svg::Picture psychometric_chart(const Field& thresholds, const Field& track, const std::string& id) {
  const auto levels = track["points"].entries();
  Scale scale;
  if (!levels.empty()) scale = {levels.front()["value"].number(), levels.back()["value"].number()};
  svg::Picture picture{.width = left + width + right, .height = y_of(0) + 54, .id = id};
  picture.title = "Share of positive answers by " + thresholds["axis"].words();
  if (!track["track"].words().empty()) picture.title += ", " + track["track"].words();
  picture.description =
      "Share of positive answers of all participants at each level, the mean of their psychometric "
      "functions, "
      "and the mean threshold with its interval. The tables below hold the numbers.";
  picture.body = svg::text({8, 20}, picture.title, "font-size=\"15\" font-weight=\"bold\"") +
                 axes(scale, thresholds["axis"].words()) + threshold_line(track, scale) +
                 curve_line(track, scale) + points(track, scale);
  return picture;
}

namespace {

constexpr double row_height = 22;

/// The name, shortened to 44 bytes to make room for the points. The table below the figure has the whole
/// name.
std::string shortened(const std::string& name) {
  constexpr std::size_t most = 44;
  return name.size() <= most ? name : name.substr(0, most - 3) + "...";
}

/// The axis of the cells' values: from 0 to 1 for shares, otherwise wide enough for all means and intervals.
Scale scale_of_cells(const std::vector<Field>& cells, bool shares) {
  if (shares) return {0, 1};
  Scale out{INFINITY, -INFINITY};
  const auto widen = [&](const Field& field) {
    if (!field.is_number()) return;
    out.low = std::min(out.low, field.number());
    out.high = std::max(out.high, field.number());
  };
  for (const Field& cell : cells) {
    widen(cell["mean"]);
    for (const Field& end : cell["ci"].entries()) widen(end);
  }
  if (out.high > out.low) return out;
  return out.low == out.high ? Scale{out.low - 0.5, out.high + 0.5} : Scale{};
}

}  // namespace

svg::Picture cell_means_chart(const Field& question, const std::string& id) {
  const auto cells = question["cells"].entries();
  std::vector<std::string> names;
  for (const Field& cell : cells)
    names.push_back(shortened(cell["cell"].words() +
                              (cell["other"].words().empty() ? "" : " and " + cell["other"].words())));
  const Scale scale = scale_of_cells(cells, question["value"].words() != "mean");
  const double from = room_for(names) + 20, bottom = top + row_height * static_cast<double>(cells.size());
  const auto x = [&](double value) { return from - left + scale.x(value); };
  svg::Picture picture{.width = from + width + right, .height = bottom + 54, .id = id};
  picture.title = "Means by cell: " + question["question"].words();
  picture.description =
      "The mean over participants in each cell, with its interval. The table below holds the numbers.";
  std::string body = svg::text({8, 20}, picture.title, "font-size=\"15\" font-weight=\"bold\"");
  const double step = step_of(scale.high - scale.low);
  for (double value = std::ceil(scale.low / step) * step; value <= scale.high + 1e-9; value += step)
    body += svg::line({x(value), top}, {x(value), bottom}, "stroke=\"#000000\" stroke-opacity=\"0.25\"") +
            svg::text({x(value), bottom + 20},
                      svg::number(value, step < 0.1 ? 3
                                         : step < 1 ? 1
                                                    : 0),
                      "class=\"axis\" text-anchor=\"middle\" font-size=\"13\"");
  body += svg::text({from + width / 2, bottom + 42}, question["value_text"].words(),
                    "text-anchor=\"middle\" font-size=\"13\"");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double y = top + row_height * (static_cast<double>(i) + 0.5);
    body += svg::text({from - 10, y + 5}, names[i],
                      "text-anchor=\"end\" font-size=\"13\"" + data_field(cells[i]["cell"]));
    const auto ends = cells[i]["ci"].entries();
    if (ends.size() == 2)
      body += svg::line({x(ends[0].number()), y}, {x(ends[1].number()), y},
                        svg::attribute("stroke", svg::colour::blue) + " stroke-width=\"2\"");
    if (cells[i]["mean"].is_number())
      body += svg::circle({x(cells[i]["mean"].number()), y}, 4.5,
                          svg::attribute("fill", svg::colour::blue) + data_field(cells[i]["mean"]));
  }
  picture.body = body;
  return picture;
}

}  // namespace study::report
