#include "apps/stats/heat_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "apps/stats/contour_lines.hpp"

namespace apps {

namespace {

using stats::ScoreGrid;

std::string number(double value, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

struct Point {
  double x = 0, y = 0;
};

std::string pair(Point p) { return number(p.x, 2) + "," + number(p.y, 2); }

/// Borders of the cells around ascending axis values: half way to the neighbour.
std::vector<double> borders(const std::vector<double>& axis) {
  const std::size_t n = axis.size();
  if (n == 1) return {axis[0] - 1, axis[0] + 1};
  std::vector<double> edges{axis[0] - (axis[1] - axis[0]) / 2};
  for (std::size_t i = 0; i + 1 < n; ++i) edges.push_back((axis[i] + axis[i + 1]) / 2);
  edges.push_back(axis[n - 1] + (axis[n - 1] - axis[n - 2]) / 2);
  return edges;
}

/// Places of the drawing, in pixels, for coordinates in frames/s.
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

/// Purple - white - green (PRGn of Brewer 2003), told apart with every common colour vision.
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
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(std::lround(c.r)),
                static_cast<unsigned>(std::lround(c.g)), static_cast<unsigned>(std::lround(c.b)));
  return text;
}

bool is_dark(const Colour& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b < 128; }

std::string text(Point at, const std::string& words, const std::string& attributes) {
  return "<text x=\"" + number(at.x, 2) + "\" y=\"" + number(at.y, 2) + "\" " + attributes + ">" + words +
         "</text>\n";
}

std::string line(Point p, Point q, const std::string& attributes) {
  return "<path d=\"M" + pair(p) + " L" + pair(q) + "\" " + attributes + "/>\n";
}

std::string rectangle(Point p, Point q, const std::string& attributes) {
  return "<rect x=\"" + number(p.x, 2) + "\" y=\"" + number(p.y, 2) + "\" width=\"" + number(q.x - p.x, 2) +
         "\" height=\"" + number(q.y - p.y, 2) + "\" " + attributes + "/>\n";
}

std::string contour_path(const ScoreGrid& grid, const Frame& frame, double level) {
  std::string path;
  for (const auto& polyline : contour_polylines(grid, level)) {
    for (std::size_t i = 0; i < polyline.size(); ++i) {
      path += (i ? "L" : "M") + pair(frame.at(polyline[i].delta, polyline[i].mu));
    }
  }
  return path;
}

std::string curve_path(const stats::ExponentialFit& fit, const Frame& frame) {
  constexpr int steps = 200;
  std::string path;
  for (int i = 0; i <= steps; ++i) {
    const double delta = std::lerp(frame.x_edges.front(), frame.x_edges.back(), i / double{steps});
    path += (i ? "L" : "M") + pair(frame.at(delta, fit.value(delta)));
  }
  return path;
}

constexpr const char* fit_style = "fill=\"none\" stroke=\"#c04000\" stroke-width=\"3\"";

std::string contour_style(double level) {
  const std::string dash = level == 4   ? ""
                           : level == 5 ? " stroke-dasharray=\"7 4\""
                                        : " stroke-dasharray=\"2 3\"";
  return "fill=\"none\" stroke=\"#000000\" stroke-width=\"1.8\"" + dash;
}

/// Share of the rating scale that a score takes.
double share_of(const PilotFit& fit, double score) {
  return (score - fit.data.scale_min) / (fit.data.scale_max - fit.data.scale_min);
}

std::string cells(const PilotFit& fit, const Frame& frame) {
  std::string out;
  for (std::size_t row = 0; row < fit.grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < fit.grid.delta.size(); ++column) {
      const auto& node = fit.grid.at(row, column);
      out += rectangle(frame.at(frame.x_edges[column], frame.y_edges[row + 1]),
                       frame.at(frame.x_edges[column + 1], frame.y_edges[row]),
                       "fill=\"" + (node ? hex(colour_of(share_of(fit, node->score))) : "url(#none)") +
                           "\" stroke=\"#ffffff\" stroke-width=\"1\"");
    }
  }
  return out;
}

std::string cell_values(const PilotFit& fit, const Frame& frame) {
  std::string out;
  for (std::size_t row = 0; row < fit.grid.mu.size(); ++row) {
    for (std::size_t column = 0; column < fit.grid.delta.size(); ++column) {
      const auto& node = fit.grid.at(row, column);
      if (!node) continue;
      const auto colour = colour_of(share_of(fit, node->score));
      // In the corner, clear of the curves, which pass near the middles.
      auto at = frame.at(frame.x_edges[column + 1], frame.y_edges[row]);
      at.x -= 8;
      at.y -= 9;
      out += text(at, number(node->score, 2),
                  "text-anchor=\"end\" font-size=\"15\" stroke-width=\"4\" stroke-linejoin=\"round\" "
                  "paint-order=\"stroke\" stroke=\"" +
                      hex(colour) + "\" fill=\"" + (is_dark(colour) ? "#ffffff" : "#000000") + "\"");
    }
  }
  return out;
}

std::string axes(const PilotFit& fit, const Frame& frame) {
  std::string out = rectangle({frame.left, frame.top}, {frame.right(), frame.bottom()},
                              "fill=\"none\" stroke=\"#000000\" stroke-width=\"1\"");
  for (const double delta : fit.grid.delta) {
    const Point at{frame.at(delta, 0).x, frame.bottom()};
    out += line(at, {at.x, at.y + 6}, "stroke=\"#000000\"");
    out += text({at.x, at.y + 22}, number(delta, 0), "text-anchor=\"middle\" font-size=\"14\"");
  }
  for (const double mu : fit.grid.mu) {
    const Point at{frame.left, frame.at(0, mu).y};
    out += line(at, {at.x - 6, at.y}, "stroke=\"#000000\"");
    out += text({at.x - 10, at.y + 5}, number(mu, 0), "text-anchor=\"end\" font-size=\"14\"");
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

std::string colour_bar(const PilotFit& fit, const Frame& frame) {
  const double x = frame.right() + 34, height = 210;
  const int scores = static_cast<int>(fit.data.scale_max - fit.data.scale_min);
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
    out += text({x + 32, y + 5}, number(fit.data.scale_min + i, 0), "font-size=\"14\"");
  }
  return out;
}

std::string legend(const PilotFit& fit, const Frame& frame) {
  const double x = frame.right() + 34;
  double y = frame.top + 252;
  std::string out;
  for (const auto& [level, estimate] : fit.harmonic) {
    out += line({x, y}, {x + 34, y}, contour_style(level));
    out += text({x + 42, y + 5}, "contour at " + number(level, level == std::round(10 * level) / 10 ? 1 : 2),
                "font-size=\"14\"");
    y += 26;
  }
  out += "<circle cx=\"" + number(x + 17, 2) + "\" cy=\"" + number(y, 2) + "\" r=\"3\" fill=\"#000000\"/>\n";
  out += text({x + 42, y + 5}, "points fitted", "font-size=\"14\"");
  y += 26;
  const auto& fitted = *fit.main().fit;
  out += line({x, y}, {x + 34, y}, fit_style);
  out += text({x + 42, y + 5}, "\xCE\xBC = a exp(b \xCE\xB4)", "font-size=\"14\"");
  const auto& spread = *fit.main().spread;
  const auto interval = [](const char* name, double value, const std::array<double, 2>& ci, int decimals) {
    return std::string(name) + " = " + number(value, decimals) + " [" + number(ci[0], decimals) + ", " +
           number(ci[1], decimals) + "]";
  };
  out += text({x, y + 30}, interval("a", fitted.a, spread.a_ci, 2), "font-size=\"14\"");
  out += text({x, y + 50}, interval("b", fitted.b, spread.b_ci, 4), "font-size=\"14\"");
  out += text({x, y + 70}, number(100 * fit.bootstrap.confidence, 0) + " % intervals", "font-size=\"12\"");
  return out;
}

std::string curves(const PilotFit& fit, const Frame& frame) {
  std::string out = "<g clip-path=\"url(#plot)\">\n";
  for (const auto& [level, estimate] : fit.harmonic) {
    const auto path = contour_path(fit.grid, frame, level);
    if (!path.empty()) out += "<path d=\"" + path + "\" " + contour_style(level) + "/>\n";
  }
  const auto curve = curve_path(*fit.main().fit, frame);
  out += "<path d=\"" + curve + "\" fill=\"none\" stroke=\"#ffffff\" stroke-width=\"6\"/>\n";
  out += "<path d=\"" + curve + "\" " + fit_style + "/>\n";
  for (const auto& point : fit.main().contour.points) {
    const auto at = frame.at(point.delta, point.mu);
    out +=
        "<circle cx=\"" + number(at.x, 2) + "\" cy=\"" + number(at.y, 2) + "\" r=\"3\" fill=\"#000000\"/>\n";
  }
  return out + "</g>\n";
}

}  // namespace

std::string heat_map_svg(const PilotFit& fit) {
  const Frame frame{borders(fit.grid.delta), borders(fit.grid.mu)};
  const std::string data = fit.data.test_data                    ? " (test data)"
                           : fit.data.simulated_participants > 0 ? " (simulated)"
                                                                 : "";
  const std::string title =
      "PTPE pilot: mean scores of " + std::to_string(fit.participants) + " participants" + data;
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 850 545\" width=\"850\" height=\"545\" "
         "role=\"img\" "
         "font-family=\"DejaVu Sans, Arial, sans-serif\">\n<title>" +
         title +
         "</title>\n<desc>Heat map of mean scores over the standard deviation and the mean of the frame "
         "rate, with "
         "contours of the scores and the fitted curve.</desc>\n<defs>\n"
         "<pattern id=\"none\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\"><rect width=\"8\" "
         "height=\"8\" "
         "fill=\"#ffffff\"/><path d=\"M0,8 L8,0\" stroke=\"#c8c8c8\"/></pattern>\n<clipPath id=\"plot\">" +
         rectangle({frame.left, frame.top}, {frame.right(), frame.bottom()}, "") + "</clipPath>\n</defs>\n" +
         rectangle({0, 0}, {850, 545}, "fill=\"#ffffff\"") +
         text({frame.left, 30}, title, "font-size=\"17\" font-weight=\"bold\"") + cells(fit, frame) +
         curves(fit, frame) + cell_values(fit, frame) + axes(fit, frame) + colour_bar(fit, frame) +
         legend(fit, frame) + "</svg>\n";
}

}  // namespace apps
