#include "libstudy/analysis/ptpe/heat_map.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/ptpe/contour_lines.hpp"
#include "libstudy/analysis/ptpe/pilot_fit.hpp"

namespace study {

namespace {

using stats::ScoreGrid;

using svg::circle;
using svg::line;
using svg::number;
using svg::path;
using svg::Point;
using svg::rectangle;
using svg::text;

/// Borders of the cells around ascending axis values. An inner border is half way between two values.
std::vector<double> borders(const std::vector<double>& axis) {
  const std::size_t n = axis.size();
  if (n == 1) return {axis[0] - 1, axis[0] + 1};
  std::vector<double> edges{axis[0] - (axis[1] - axis[0]) / 2};
  for (std::size_t i = 0; i + 1 < n; ++i) edges.push_back((axis[i] + axis[i + 1]) / 2);
  edges.push_back(axis[n - 1] + (axis[n - 1] - axis[n - 2]) / 2);
  return edges;
}

/// Converts coordinates in frames/s to positions in the drawing, in pixels.
struct Frame {
  std::vector<double> x_edges, y_edges;
  double left = 78, top = 58, width = 500, height = 420;

  Point at(double delta, double mu) const {
    return {left + width * (delta - x_edges.front()) / (x_edges.back() - x_edges.front()),
            top + height * (y_edges.back() - mu) / (y_edges.back() - y_edges.front())};
  }
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct Colour {
  double r, g, b;
};

/// Colour of a share between 0 and 1: purple - white - green (PRGn of Brewer 2003), distinguishable with all
/// common types of colour vision.
Colour colour_of(double share) {
  constexpr std::array<Colour, 9> anchors{{{118, 42, 131},
                                           {153, 112, 171},
                                           {194, 165, 207},
                                           {231, 212, 232},
                                           {247, 247, 247},
                                           {217, 240, 211},
                                           {166, 219, 160},
                                           {90, 174, 97},
                                           {27, 120, 55}}};
  const double at = std::clamp(share, 0.0, 1.0) * (anchors.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), anchors.size() - 2);
  const double t = at - static_cast<double>(low);
  const auto &p = anchors[low], &q = anchors[low + 1];
  return {std::lerp(p.r, q.r, t), std::lerp(p.g, q.g, t), std::lerp(p.b, q.b, t)};
}

std::string hex(const Colour& c) {
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(c.r), std::lround(c.g), std::lround(c.b));
}

bool is_dark(const Colour& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b < 128; }

std::string contour_path(const ScoreGrid& grid, const Frame& frame, double level) {
  std::string moves;
  for (const auto& polyline : contour_polylines(grid, level)) {
    for (std::size_t i = 0; i < polyline.size(); ++i) {
      moves += svg::move(i ? 'L' : 'M', frame.at(polyline[i].delta, polyline[i].mu));
    }
  }
  return moves;
}

std::string curve_path(const HeatMap& map, const Frame& frame) {
  constexpr int steps = 200;
  std::string moves;
  for (int i = 0; i <= steps; ++i) {
    const double delta = std::lerp(frame.x_edges.front(), frame.x_edges.back(), i / double{steps});
    moves += svg::move(i ? 'L' : 'M', frame.at(delta, map.a * std::exp(map.b * delta)));
  }
  return moves;
}

std::string free_path(const HeatMap& map, const Frame& frame) {
  std::string moves;
  for (const auto& point : map.free_curve)
    moves += svg::move(moves.empty() ? 'M' : 'L', frame.at(point.delta, point.mu));
  return moves;
}

constexpr const char* free_style =
    "fill=\"none\" stroke=\"#0072b2\" stroke-width=\"3\" stroke-dasharray=\"10 5\"";
constexpr const char* fit_style = "fill=\"none\" stroke=\"#c04000\" stroke-width=\"3\"";

std::string contour_style(double level) {
  const std::string dash = level == 4   ? ""
                           : level == 5 ? " stroke-dasharray=\"7 4\""
                                        : " stroke-dasharray=\"2 3\"";
  return "fill=\"none\" stroke=\"#000000\" stroke-width=\"1.8\"" + dash;
}

/// The SVG attribute data-field: a JSON pointer to a number of the results. Empty if `pointer` is empty.
std::string field_attribute(const std::string& pointer, const std::string& member) {
  return pointer.empty() ? "" : svg::attribute("data-field", pointer + member);
}

/// Position of a score on the rating scale, 0 to 1.
double share_of(const HeatMap& map, double score) {
  return (score - map.scale_min) / (map.scale_max - map.scale_min);
}

std::string cells(const HeatMap& map, const Frame& frame) {
  std::string out;
  for (std::size_t row = 0; row < map.grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < map.grid.delta.size(); ++column) {
      const auto& node = map.grid.at(row, column);
      out += rectangle(frame.at(frame.x_edges[column], frame.y_edges[row + 1]),
                       frame.at(frame.x_edges[column + 1], frame.y_edges[row]),
                       "fill=\"" + (node ? hex(colour_of(share_of(map, node->score))) : "url(#no-score)") +
                           "\" stroke=\"#ffffff\" stroke-width=\"1\"");
    }
  }
  return out;
}

std::string cell_values(const HeatMap& map, const Frame& frame) {
  std::string out;
  std::size_t index = 0;
  for (std::size_t row = 0; row < map.grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < map.grid.delta.size(); ++column) {
      const auto& node = map.grid.at(row, column);
      if (!node) continue;
      const auto colour = colour_of(share_of(map, node->score));
      // The number is in the cell's lower right corner, since the curves pass near the cell's centre.
      auto at = frame.at(frame.x_edges[column + 1], frame.y_edges[row]);
      at.x -= 8;
      at.y -= 9;
      out += text(at, number(node->score, 2),
                  "text-anchor=\"end\" font-size=\"15\" stroke-width=\"4\" stroke-linejoin=\"round\" "
                  "paint-order=\"stroke\" stroke=\"" +
                      hex(colour) + "\" fill=\"" + (is_dark(colour) ? "#ffffff" : "#000000") + "\"" +
                      field_attribute(map.cells_field, "/" + std::to_string(index++) + "/score"));
    }
  }
  return out;
}

std::string axes(const HeatMap& map, const Frame& frame) {
  std::string out = rectangle({frame.left, frame.top}, {frame.right(), frame.bottom()},
                              "fill=\"none\" stroke=\"#000000\" stroke-width=\"1\"");
  for (const double delta : map.grid.delta) {
    const Point at{frame.at(delta, 0).x, frame.bottom()};
    out += line(at, {at.x, at.y + 6}, "stroke=\"#000000\"");
    out +=
        text({at.x, at.y + 22}, number(delta, 0), "class=\"axis\" text-anchor=\"middle\" font-size=\"14\"");
  }
  for (const double mu : map.grid.mu) {
    const Point at{frame.left, frame.at(0, mu).y};
    out += line(at, {at.x - 6, at.y}, "stroke=\"#000000\"");
    out += text({at.x - 10, at.y + 5}, number(mu, 0), "class=\"axis\" text-anchor=\"end\" font-size=\"14\"");
  }
  out += text({frame.left + frame.width / 2, frame.bottom() + 46},
              "standard deviation of the frame rate \xCE\xB4 (frames/s)",
              "text-anchor=\"middle\" font-size=\"15\"");
  const double middle = frame.top + frame.height / 2;
  out +=
      text({24, middle}, "mean frame rate \xCE\xBC (frames/s)",
           "text-anchor=\"middle\" font-size=\"15\" transform=\"rotate(-90 24 " + number(middle, 2) + ")\"");
  return out;
}

std::string colour_bar(const HeatMap& map, const Frame& frame) {
  const double x = frame.right() + 34, height = 210;
  const int scores = static_cast<int>(map.scale_max - map.scale_min);
  const int bands = 12 * scores;
  std::string out = text({x, frame.top - 10}, "mean score", "font-size=\"14\"");
  for (int i = 0; i < bands; ++i) {
    const double top = frame.top + height * (bands - 1 - i) / bands;
    out += rectangle({x, top}, {x + 22, top + height / bands + 0.5},
                     "fill=\"" + hex(colour_of((i + 0.5) / bands)) + "\"");
  }
  for (int i = 0; i <= scores; ++i) {
    const double y = frame.top + height * (scores - i) / scores;
    out += line({x + 22, y}, {x + 27, y}, "stroke=\"#000000\"");
    out += text({x + 32, y + 5}, number(map.scale_min + i, 0), "class=\"axis\" font-size=\"14\"");
  }
  return out;
}

/// A number of the estimate as SVG text, with its JSON pointer as attribute.
std::string number_of(const HeatMap& map, double value, int decimals, const std::string& member) {
  const std::string text =
      std::isinf(value) ? value > 0 ? "\xE2\x88\x9E" : "\xE2\x88\x92\xE2\x88\x9E" : number(value, decimals);
  return "<tspan" + field_attribute(map.estimate_field, member) + ">" + text + "</tspan>";
}

/// A coefficient with its interval: "a = 23.4 [22.1, 24.6]".
std::string interval(const HeatMap& map, const std::string& name, double value,
                     const std::array<double, 2>& ci, int decimals) {
  const std::string member = "/" + name;
  const int digits = interval_decimals(ci, decimals);
  return name + " = " + number_of(map, value, decimals, member) + " [" +
         number_of(map, ci[0], digits, member + "_ci/0") + ", " +
         (name == "a" && ci[1] > highest_rate ? "no upper bound"
                                              : number_of(map, ci[1], digits, member + "_ci/1")) +
         "]";
}

std::string legend(const HeatMap& map, const Frame& frame) {
  const double x = frame.right() + 34;
  double y = frame.top + 252;
  std::string out;
  for (const double level : map.levels) {
    out += line({x, y}, {x + 34, y}, contour_style(level));
    out += text({x + 42, y + 5}, "contour at " + number(level, level == std::round(10 * level) / 10 ? 1 : 2),
                "class=\"axis\" font-size=\"14\"");
    y += 26;
  }
  if (!map.points.empty()) {
    out += circle({x + 17, y}, 3, "fill=\"#000000\"");
    out += text({x + 42, y + 5}, "points fitted", "font-size=\"14\"");
    y += 26;
  }
  if (!map.free_curve.empty()) {
    out += line({x, y}, {x + 34, y}, free_style);
    out += text({x + 42, y + 5}, "free curve", "font-size=\"14\"");
    y += 26;
  }
  out += line({x, y}, {x + 34, y}, fit_style);
  out += svg::marked_text({x + 42, y + 5},
                          "<tspan font-style=\"italic\">\xCE\xBC</tspan>(<tspan "
                          "font-style=\"italic\">\xCE\xB4</tspan>) = <tspan "
                          "font-style=\"italic\">a</tspan> e<tspan dy=\"-5\" font-size=\"11\" "
                          "font-style=\"italic\">b \xCE\xB4</tspan>",
                          "font-size=\"14\"");
  out += svg::marked_text({x, y + 30}, interval(map, "a", map.a, map.a_ci, 2), "font-size=\"14\"");
  out += svg::marked_text({x, y + 50}, interval(map, "b", map.b, map.b_ci, 4), "font-size=\"14\"");
  out +=
      text({x, y + 70}, number(100 * map.confidence, 0) + " % intervals", "class=\"axis\" font-size=\"12\"");
  return out;
}

std::string outlined(const std::string& moves, const char* style) {
  return path(moves, "fill=\"none\" stroke=\"#ffffff\" stroke-width=\"6\"") + path(moves, style);
}

std::string curves(const HeatMap& map, const Frame& frame) {
  std::string out = "<g clip-path=\"url(#heat-map-plot)\">\n";
  for (const double level : map.levels) {
    const auto moves = contour_path(map.grid, frame, level);
    if (!moves.empty()) out += path(moves, contour_style(level));
  }
  out += outlined(curve_path(map, frame), fit_style);
  if (!map.free_curve.empty()) out += outlined(free_path(map, frame), free_style);
  for (const auto& point : map.points) out += circle(frame.at(point.delta, point.mu), 3, "fill=\"#000000\"");
  return out + "</g>\n";
}

constexpr const char* no_score_pattern =
    "<pattern id=\"no-score\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\"><rect width=\"8\" "
    "height=\"8\" fill=\"#ffffff\"/><path d=\"M0,8 L8,0\" stroke=\"#c8c8c8\"/></pattern>\n";

}  // namespace

HeatMap heat_map_of(const PilotFit& fit) {
  const std::string data = fit.data.test_data            ? " (test data)"
                           : !fit.data.simulated.empty() ? " (simulated)"
                                                         : "";
  HeatMap map;
  map.title = "PTPE pilot: mean scores of " + std::to_string(fit.participants) + " participants" + data;
  map.grid = fit.grid;
  map.scale_min = fit.data.question.scale_min;
  map.scale_max = fit.data.question.scale_max;
  for (const auto& [level, estimate] : fit.harmonic) map.levels.push_back(level);
  const auto main = fit.main();
  map.a = main.fit->a;
  map.b = main.fit->b;
  map.a_ci = main.spread->a_ci;
  map.b_ci = main.spread->b_ci;
  map.confidence = fit.bootstrap.confidence;
  const auto& form = fit.chosen().direct.form;
  if (!form || !form->rejected()) return map;
  for (double delta = fit.deltas.front(); delta <= fit.deltas.back(); delta += 1)
    map.free_curve.push_back({delta, form->curve.mu(delta)});
  return map;
}

svg::Picture heat_map(const HeatMap& map) {
  const Frame frame{borders(map.grid.delta), borders(map.grid.mu)};
  svg::Picture picture{.width = 850, .height = 545, .id = "heat-map", .title = map.title};
  picture.description =
      "Heat map of mean scores over the standard deviation and the mean of the frame rate, with contours of "
      "the scores and the fitted curve.";
  picture.definitions = no_score_pattern + std::string("<clipPath id=\"heat-map-plot\">") +
                        rectangle({frame.left, frame.top}, {frame.right(), frame.bottom()}, "") +
                        "</clipPath>\n";
  picture.body = text({frame.left, 30}, map.title, "font-size=\"17\" font-weight=\"bold\"") +
                 cells(map, frame) + curves(map, frame) + cell_values(map, frame) + axes(map, frame) +
                 colour_bar(map, frame) + legend(map, frame);
  return picture;
}

std::string heat_map_svg(const PilotFit& fit) { return svg::document(heat_map(heat_map_of(fit))); }

}  // namespace study
