#include "libstudy/power/power_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "stats/figures/svg.hpp"

namespace study {

namespace {

using svg::number;
using svg::Point;

constexpr double panel_width = 250, panel_height = 190, left = 60, top = 64, gap = 60;

struct Style {
  const char *colour, *dash;
};
constexpr std::array<Style, 4> styles{{{svg::colour::blue, ""},
                                       {svg::colour::vermilion, "6 4"},
                                       {svg::colour::green, "2 3"},
                                       {svg::colour::purple, "9 3 2 3"}}};

struct Curve {
  std::string name;
  std::vector<double> values, errors;
};

struct Panel {
  std::string title;
  std::vector<Curve> curves;
  std::vector<double> marks;  ///< values at which horizontal lines are drawn
  double most = 1;
  int decimals = 1;
};

std::string stroke(std::size_t index, double width) {
  const auto& style = styles[index % styles.size()];
  return svg::attribute("stroke", style.colour) + svg::attribute("stroke-width", number(width, 1)) +
         svg::attribute("stroke-dasharray", style.dash) + svg::attribute("fill", "none");
}

const char* const axis = R"( stroke="#333" stroke-width="1")";
const char* const grid = R"( stroke="#bbb" stroke-width="0.8" stroke-dasharray="3 3")";
const char* const small = R"( font-size="11" fill="#333")";

class Drawing {
 public:
  Drawing(const std::vector<double>& n, std::size_t panels) : n_(n), panels_(panels) {}

  std::string draw(const Panel& panel, std::size_t index) const {
    const double x0 = left + static_cast<double>(index) * (panel_width + gap), bottom = top + panel_height;
    const double span = std::max(n_.back() - n_.front(), 1.0);
    const auto at = [&](double n, double value) {
      const double share = n_.size() == 1 ? 0.5 : (n - n_.front()) / span;
      return Point{x0 + share * panel_width, bottom - std::min(value / panel.most, 1.0) * panel_height};
    };
    std::string out = svg::text({x0, top - 10}, panel.title, R"( font-size="13" font-weight="bold")");
    for (const double mark : panel.marks)
      out += svg::line({x0, at(n_[0], mark).y}, {x0 + panel_width, at(n_[0], mark).y}, grid);
    out +=
        svg::line({x0, bottom}, {x0 + panel_width, bottom}, axis) + svg::line({x0, top}, {x0, bottom}, axis);
    for (int tick = 0; tick <= 4; ++tick) {
      const double value = panel.most * tick / 4;
      out += svg::text({x0 - 6, at(n_[0], value).y + 4}, number(value, panel.decimals),
                       std::string(small) + R"( text-anchor="end")");
    }
    for (const double n :
         n_.size() == 1 ? n_ : std::vector{n_.front(), (n_.front() + n_.back()) / 2, n_.back()})
      out += svg::text({at(n, 0).x, bottom + 16}, number(n, n == std::floor(n) ? 0 : 1),
                       std::string(small) + R"( text-anchor="middle")");
    for (std::size_t i = 0; i < panel.curves.size(); ++i) out += curve(panel.curves[i], i, at);
    return out;
  }

  std::string legend(const std::vector<std::string>& names) const {
    std::string out;
    double x = left;
    const double y = top + panel_height + 48;
    for (std::size_t i = 0; i < names.size(); ++i) {
      out += svg::line({x, y - 4}, {x + 34, y - 4}, stroke(i, 2.5));
      out += svg::text({x + 40, y}, names[i], small);
      x += 62 + 6.5 * static_cast<double>(names[i].size());
    }
    return out;
  }

  double width() const { return left + static_cast<double>(panels_) * (panel_width + gap); }
  double height() const { return top + panel_height + 64; }

 private:
  /// Draws a curve as a line. If the curve has at most 12 points, each point has a bar that extends two
  /// standard errors up and down.
  template <class At>
  std::string curve(const Curve& curve, std::size_t index, At at) const {
    std::string moves, marks;
    for (std::size_t i = 0; i < n_.size(); ++i) {
      if (std::isnan(curve.values[i])) continue;
      const Point place = at(n_[i], curve.values[i]);
      moves += svg::move(moves.empty() ? 'M' : 'L', place);
      if (n_.size() > 12) continue;
      const double error = 2 * curve.errors[i];
      marks += svg::line({place.x, at(n_[i], std::max(0.0, curve.values[i] - error)).y},
                         {place.x, at(n_[i], curve.values[i] + error).y}, stroke(index, 1));
      marks += svg::circle(place, 3, svg::attribute("fill", styles[index % styles.size()].colour));
    }
    return (moves.empty() ? "" : svg::path(moves, stroke(index, 2))) + marks;
  }

  std::vector<double> n_;
  std::size_t panels_;
};

double number_or_nan(const Json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

std::vector<Panel> hypothesis_panels(const Json& json) {
  std::vector<Panel> out;
  for (const auto& world : json.at("worlds")) {
    for (const auto& hypothesis : world.at("hypotheses")) {
      const std::string id = hypothesis.at("id").get<std::string>();
      auto panel = std::find_if(out.begin(), out.end(), [&](const Panel& one) { return one.title == id; });
      if (panel == out.end()) {
        out.push_back(
            {id,
             {},
             {json.at("plan").at("alpha").get<double>(), json.at("settings").at("power").get<double>()},
             1,
             2});
        panel = out.end() - 1;
      }
      Curve curve{world.at("id").get<std::string>(), {}, {}};
      for (const auto& point : hypothesis.at("curve")) {
        curve.values.push_back(number_or_nan(point.at("supported")));
        curve.errors.push_back(number_or_nan(point.at("supported_se")));
      }
      panel->curves.push_back(std::move(curve));
    }
  }
  return out;
}

Panel coefficient_panel(const Json& json, const std::string& name, const std::string& title, int decimals) {
  Panel out{title, {}, {}, 0, decimals};
  const Json& precision = json.at("settings").at("precision_" + name);
  if (precision.is_number()) out.marks.push_back(precision.get<double>());
  for (const char* figure : {"half_width", "half_width_wished", "sd"}) {
    Curve curve{figure, {}, {}};
    for (const auto& point : json.at("precision").at("curve")) {
      const Json& at = point.at(name);
      curve.values.push_back(at.contains(figure) ? number_or_nan(at.at(figure)) : std::nan(""));
      curve.errors.push_back(at.contains(figure) ? number_or_nan(at.at(std::string(figure) + "_se")) : 0);
      if (std::isfinite(curve.values.back())) out.most = std::max(out.most, 1.1 * curve.values.back());
    }
    out.curves.push_back(std::move(curve));
  }
  for (const double mark : out.marks) out.most = std::max(out.most, 1.1 * mark);
  if (out.most <= 0) out.most = 1;
  return out;
}

}  // namespace

std::string power_svg(const Json& json) {
  const auto n = json.at("settings").at("n").get<std::vector<double>>();
  const bool pilot = json.contains("precision");
  const std::string protocol = json.at("protocol").at("name").get<std::string>();
  std::vector<Panel> panels;
  std::vector<std::string> names;
  if (pilot) {
    panels = {coefficient_panel(json, "a", "half width of a, frames/s", 2),
              coefficient_panel(json, "b", "half width of b, s/frame", 4)};
    names = {"interval, median", "interval, quantile at the requested power", "true standard error"};
  } else {
    panels = hypothesis_panels(json);
    for (const auto& world : json.at("worlds")) names.push_back(world.at("id").get<std::string>());
  }
  const Drawing drawing(n, panels.size());
  svg::Picture picture{drawing.width(), drawing.height(), "power"};
  picture.title = (pilot ? "Precision of " : "Power of ") + protocol;
  picture.description = pilot ? "Half widths of the intervals of a and b over the number of participants."
                              : "Share of simulated studies in which every test of a hypothesis holds, over "
                                "the number of participants, by what is true.";
  picture.body = svg::text({left, 24}, picture.title + " by number of participants",
                           R"( font-size="15" font-weight="bold")");
  for (std::size_t i = 0; i < panels.size(); ++i) picture.body += drawing.draw(panels[i], i);
  picture.body += drawing.legend(names);
  return svg::document(picture);
}

}  // namespace study
