#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::attribute;
using svg::line;
using svg::Point;
using svg::text;

constexpr double left = 62, right_margin = 14, group_gap = 46, least_step = 74, box_half = 21;
constexpr double plot_height = 270, bracket_step = 24, below = 78;
constexpr const char* ink = "stroke=\"#000000\" stroke-width=\"1.4\" fill=\"none\"";

/// A bracket with stars over the boxes of two methods whose scores differ significantly without correction.
struct Bracket {
  std::size_t first = 0, last = 0;  ///< indices of the boxes within the group
  Field stars;
  bool survives = false;  ///< true if significant after Holm's correction
  std::size_t layer = 0;  ///< height of the bracket; 0 is the lowest
};

struct Group {
  Field n_star;
  std::vector<Field> cells;  ///< results of each method, in the order of the methods
  std::vector<Bracket> brackets;
};

/// Distance from one box to the next in pixels, wide enough for the longest name of a method.
double step_of(const std::vector<Group>& groups) {
  std::vector<std::string> names;
  for (const Group& group : groups)
    for (const Field& cell : group.cells) names.push_back(cell["method"].words());
  return std::max(least_step, room_for(names) + 10);
}

/// Sets the layers of the brackets such that overlapping brackets have different layers and short ones are
/// lowest.
void stack(std::vector<Bracket>& brackets) {
  std::stable_sort(brackets.begin(), brackets.end(),
                   [](const Bracket& p, const Bracket& q) { return p.last - p.first < q.last - q.first; });
  for (std::size_t i = 0; i < brackets.size(); ++i) {
    std::set<std::size_t> taken;
    for (std::size_t j = 0; j < i; ++j) {
      if (brackets[j].first <= brackets[i].last && brackets[i].first <= brackets[j].last)
        taken.insert(brackets[j].layer);
    }
    while (taken.contains(brackets[i].layer)) ++brackets[i].layer;
  }
}

std::vector<Group> groups_of(const Field& task1, const std::string& score) {
  std::vector<Group> groups;
  for (const Field& n_star : task1["n_stars"].entries()) {
    Group group{n_star, {}, {}};
    std::map<std::string, std::size_t> place;
    for (const Field& cell : task1["cells"].entries()) {
      if (cell["score"].words() != score || cell["n_star"].words() != n_star.words()) continue;
      place[cell["method"].words()] = group.cells.size();
      group.cells.push_back(cell);
    }
    for (const Field& pair : task1["comparisons"].entries()) {
      if (pair["score"].words() != score || pair["n_star"].words() != n_star.words()) continue;
      const auto a = place.find(pair["a"].words()), b = place.find(pair["b"].words());
      if (pair["stars"].words().empty() || a == place.end() || b == place.end()) continue;
      group.brackets.push_back({std::min(a->second, b->second), std::max(a->second, b->second), pair["stars"],
                                !pair["stars_holm"].words().empty()});
    }
    stack(group.brackets);
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Vertical axis: converts scores to pixels.
struct Axis {
  double min = 1, max = 7, top = 0;
  double y(double value) const { return top + plot_height * (max - value) / (max - min); }
};

std::string box(const Field& cell, double x, const Axis& axis) {
  const double q1 = axis.y(cell["q1"].number()), q3 = axis.y(cell["q3"].number());
  const double low = axis.y(cell["whisker_low"].number()), high = axis.y(cell["whisker_high"].number());
  const double median = axis.y(cell["median"].number());
  std::string out = line({x, q1}, {x, low}, ink) + line({x, q3}, {x, high}, ink) +
                    line({x - 9, low}, {x + 9, low}, ink) + line({x - 9, high}, {x + 9, high}, ink);
  out += svg::rectangle({x - box_half, q3}, {x + box_half, q1},
                        "fill=\"#cfe6f5\" stroke=\"#000000\" stroke-width=\"1.4\"");
  out += line({x - box_half, median}, {x + box_half, median}, "stroke=\"#000000\" stroke-width=\"3\"");
  for (const Field& outlier : cell["outliers"].entries())
    out += svg::circle({x, axis.y(outlier.number())}, 3.2, "stroke=\"#000000\" fill=\"#ffffff\"");
  if (cell["mean"].is_number())
    out += svg::cross({x, axis.y(cell["mean"].number())}, 6,
                      "stroke=\"#ffffff\" stroke-width=\"5.5\" fill=\"none\"") +
           svg::cross({x, axis.y(cell["mean"].number())}, 5.5,
                      "stroke=\"#b34700\" stroke-width=\"2.6\" fill=\"none\"");
  return out;
}

std::string labels(const Field& cell, double x, double bottom) {
  const std::string middle = "text-anchor=\"middle\" font-size=\"13\"";
  std::string out = text({x, bottom + 18}, cell["method"].words(), middle + data_field(cell["method"]));
  if (cell["mean"].is_number())
    out += text({x, bottom + 36}, decimal(cell["mean"].number(), 2), middle + data_field(cell["mean"]));
  return out;
}

std::string bracket(const Bracket& b, double origin, double step, double lowest) {
  const double y = lowest - bracket_step * static_cast<double>(b.layer);
  const double from = origin + step * static_cast<double>(b.first) + 4;
  const double to = origin + step * static_cast<double>(b.last) - 4;
  const std::string dash = b.survives ? "" : " stroke-dasharray=\"4 3\"";
  return svg::path(svg::move('M', {from, y + 6}) + svg::move('L', {from, y}) + svg::move('L', {to, y}) +
                       svg::move('L', {to, y + 6}),
                   "stroke=\"#000000\" stroke-width=\"1.3\" fill=\"none\"" + dash) +
         text({(from + to) / 2, y - 1}, b.stars.words(),
              "text-anchor=\"middle\" font-size=\"15\" font-weight=\"bold\"" + data_field(b.stars));
}

std::string axis_marks(const Axis& axis, double right) {
  std::string out;
  for (double value = std::ceil(axis.min); value <= axis.max + 1e-9; value += 1) {
    const double y = axis.y(value);
    out +=
        line({left, y}, {right, y}, "stroke=\"#dddddd\"") + line({left - 5, y}, {left, y}, ink) +
        text({left - 9, y + 5}, svg::number(value, 0), "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
  }
  return out;
}

}  // namespace

svg::Picture box_plot(const Field& task1, const Field& score) {
  const auto groups = groups_of(task1, score["code"].words());
  const double step = step_of(groups);
  std::size_t layers = 0;
  double right = left + 10;
  for (const auto& group : groups) {
    for (const auto& b : group.brackets) layers = std::max(layers, b.layer + 1);
    right += step * static_cast<double>(group.cells.size()) + group_gap;
  }
  right -= group_gap;
  const Axis axis{score["min"].number(), score["max"].number(),
                  24 + 20 + bracket_step * static_cast<double>(layers)};
  const double bottom = axis.top + plot_height, top_bracket = axis.top - 12;

  svg::Picture picture{.width = std::max(right + right_margin, 420.0), .height = bottom + below};
  picture.id = "box-plot-" + score["code"].words();
  picture.title = "Box plots: " + score["label"].words();
  picture.description =
      "A box for each method within each n*: median, quartiles, whiskers to the last values within one and a "
      "half times the interquartile range, circles beyond them, an X at the mean. Brackets with stars join "
      "methods that differ. The tables below hold the same numbers.";
  picture.body = text({8, 18}, score["label"].words(),
                      "font-size=\"15\" font-weight=\"bold\"" + data_field(score["label"])) +
                 axis_marks(axis, right);
  double origin = left + 10 + step / 2;
  for (const auto& group : groups) {
    double x = origin;
    for (const Field& cell : group.cells) {
      if (cell["median"].is_number()) picture.body += box(cell, x, axis);
      picture.body += labels(cell, x, bottom);
      x += step;
    }
    for (const auto& b : group.brackets) picture.body += bracket(b, origin, step, top_bracket);
    const double last = x - step;
    picture.body += line({origin - step / 2 + 6, bottom + 46}, {last + step / 2 - 6, bottom + 46}, ink);
    picture.body +=
        svg::marked_text({(origin + last) / 2, bottom + 66},
                         "<tspan font-style=\"italic\">n</tspan>* = <tspan" + data_field(group.n_star) + ">" +
                             svg::escaped(group.n_star.words()) + "</tspan>",
                         "text-anchor=\"middle\" font-size=\"14\"");
    origin = x + group_gap;
  }
  picture.body += line({left, axis.top}, {left, bottom}, ink);
  return picture;
}

}  // namespace study::report
