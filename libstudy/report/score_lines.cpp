#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "libstudy/report/figures.hpp"

namespace study::report {

namespace {

using svg::attribute;
using svg::line;
using svg::Point;
using svg::text;

constexpr double left = 52, least_step = 84, gap = 34, plot_height = 240, top = 34, below = 64;
constexpr const char* ink = "stroke=\"#000000\" stroke-width=\"1.2\" fill=\"none\"";

/// Layout of the panels side by side: one for each n_*, with methods along x and scores along y.
struct Panels {
  std::vector<Field> n_stars, methods;
  double min = 1, max = 7;
  double step = least_step;  ///< distance from one method to the next, in pixels

  double width() const { return step * static_cast<double>(methods.size()); }
  double origin(std::size_t panel) const { return left + static_cast<double>(panel) * (width() + gap); }
  double right() const { return origin(n_stars.size()) - gap; }
  double bottom() const { return top + plot_height; }
  double y(double score) const { return top + plot_height * (max - score) / (max - min); }
  double x(std::size_t panel, std::size_t method, double aside = 0) const {
    return origin(panel) + step * (static_cast<double>(method) + 0.5) + aside;
  }
};

std::vector<std::string> words_of(const std::vector<Field>& list) {
  std::vector<std::string> out;
  for (const Field& one : list) out.push_back(one.words());
  return out;
}

Panels panels_of(const Field& task1, const Field& score) {
  const std::vector<Field> methods = task1["methods"].entries();
  return {task1["n_stars"].entries(), methods, score["min"].number(), score["max"].number(),
          std::max(least_step, room_for(words_of(methods)) + 10)};
}

std::string frame(const Panels& panels) {
  std::string out;
  for (std::size_t p = 0; p < panels.n_stars.size(); ++p) {
    const double from = panels.origin(p), to = from + panels.width();
    for (double value = std::ceil(panels.min); value <= panels.max + 1e-9; value += 1) {
      out += line({from, panels.y(value)}, {to, panels.y(value)}, "stroke=\"#dddddd\"");
      if (p == 0)
        out += text({left - 8, panels.y(value) + 5}, svg::number(value, 0),
                    "class=\"axis\" text-anchor=\"end\" font-size=\"13\"");
    }
    out += line({from, top}, {from, panels.bottom()}, ink) +
           line({from, panels.bottom()}, {to, panels.bottom()}, ink);
    for (std::size_t m = 0; m < panels.methods.size(); ++m)
      out += text({panels.x(p, m), panels.bottom() + 19}, panels.methods[m].words(),
                  "text-anchor=\"middle\" font-size=\"13\"" + data_field(panels.methods[m]));
    out +=
        svg::marked_text({(from + to) / 2, panels.bottom() + 42},
                         "<tspan font-style=\"italic\">n</tspan>* = <tspan" + data_field(panels.n_stars[p]) +
                             ">" + svg::escaped(panels.n_stars[p].words()) + "</tspan>",
                         "text-anchor=\"middle\" font-size=\"14\"");
  }
  return out;
}

/// A polyline through the points, interrupted at each missing point.
std::string polyline(const std::vector<std::optional<Point>>& points, const std::string& attributes) {
  std::string moves;
  bool drawing = false;
  for (const auto& point : points) {
    if (point) moves += svg::move(drawing ? 'L' : 'M', *point);
    drawing = point.has_value();
  }
  return moves.empty() ? "" : svg::path(moves, "fill=\"none\" " + attributes);
}

std::size_t place(const std::vector<Field>& list, const std::string& word) {
  return static_cast<std::size_t>(
      std::find_if(list.begin(), list.end(), [&](const Field& one) { return one.words() == word; }) -
      list.begin());
}

/// Scores of one participant: first index panel, second index method.
using Line = std::vector<std::vector<std::optional<double>>>;

Line empty_line(const Panels& panels) {
  return Line(panels.n_stars.size(), std::vector<std::optional<double>>(panels.methods.size()));
}

/// An empty picture with the score's name and the axes of the panels.
svg::Picture picture_of(const Panels& panels, const Field& score, const std::string& id) {
  svg::Picture picture{.width = std::max(panels.right() + 12, 420.0), .height = panels.bottom() + below};
  picture.id = id + "-" + score["code"].words();
  picture.body = text({8, 18}, score["label"].words(),
                      "font-size=\"15\" font-weight=\"bold\"" + data_field(score["label"])) +
                 frame(panels);
  return picture;
}

/// Calls `take` for each cell of the score in a panel, with the cell and the index of its method.
template <class Take>
void each_cell(const Panels& panels, const Field& cells, const Field& score, std::size_t panel, Take take) {
  for (const Field& cell : cells.entries()) {
    const std::size_t method = place(panels.methods, cell["method"].words());
    if (cell["score"].words() == score["code"].words() && method < panels.methods.size() &&
        cell["n_star"].words() == panels.n_stars[panel].words() && cell["mean"].is_number())
      take(cell, method);
  }
}

struct Style {
  const char* colour;
  const char* dashes;
};
constexpr std::array<Style, 6> styles{{{"#0072b2", "none"},
                                       {"#b34700", "7 4"},
                                       {"#00694f", "2 3"},
                                       {"#7a3b64", "9 3 2 3"},
                                       {"#000000", "4 2"},
                                       {"#666666", "1 2"}}};

std::string stroke(const Style& style, const char* width) {
  return attribute("stroke", style.colour) + attribute("stroke-dasharray", style.dashes) +
         attribute("stroke-width", width);
}

}  // namespace

svg::Picture person_lines(const Field& task1, const Field& score) {
  const Panels panels = panels_of(task1, score);
  const std::string code = score["code"].words();
  std::map<std::string, Line> people;
  for (const Field& mean : task1["participant_means"].entries()) {
    const std::size_t p = place(panels.n_stars, mean["n_star"].words()),
                      m = place(panels.methods, mean["method"].words());
    if (p == panels.n_stars.size() || m == panels.methods.size() || !mean[code].is_number()) continue;
    people.try_emplace(mean["participant"].words(), empty_line(panels)).first->second[p][m] =
        mean[code].number();
  }
  svg::Picture picture = picture_of(panels, score, "person-lines");
  picture.title = score["label"].words() + " of each participant";
  picture.description =
      "A thin line for each participant over the methods within each n*, so that it is seen who differs how; "
      "the "
      "thick line with an X joins the means.";
  for (std::size_t p = 0; p < panels.n_stars.size(); ++p) {
    std::size_t person = 0;
    for (const auto& [participant, means] : people) {
      // Points are shifted sideways by participant, so that equal scores do not overlap.
      const double aside = 0.30 * panels.step *
                           ((static_cast<double>(person++) + 0.5) / static_cast<double>(people.size()) - 0.5);
      std::vector<std::optional<Point>> points(panels.methods.size());
      for (std::size_t m = 0; m < points.size(); ++m) {
        if (!means[p][m]) continue;
        points[m] = Point{panels.x(p, m, aside), panels.y(*means[p][m])};
        picture.body += svg::circle(*points[m], 1.9, "fill=\"#5b87a6\"");
      }
      picture.body += polyline(points, "stroke=\"#5b87a6\" stroke-width=\"0.9\" stroke-opacity=\"0.6\"");
    }
    std::vector<std::optional<Point>> means(panels.methods.size());
    each_cell(panels, task1["cells"], score, p, [&](const Field& cell, std::size_t m) {
      means[m] = Point{panels.x(p, m), panels.y(cell["mean"].number())};
    });
    picture.body += polyline(means, "stroke=\"#b34700\" stroke-width=\"2.6\"");
    for (const auto& mean : means)
      if (mean) picture.body += svg::cross(*mean, 5, "stroke=\"#b34700\" stroke-width=\"2.6\" fill=\"none\"");
  }
  return picture;
}

svg::Picture scene_lines(const Field& task1, const Field& score) {
  const Panels panels = panels_of(task1, score);
  const std::vector<Field> scenes = task1["scenes"].entries();
  // Width of a column of the legend, in pixels.
  const double column = std::max(190.0, 50 + room_for(words_of(scenes)));
  svg::Picture picture = picture_of(panels, score, "scene-lines");
  picture.title = score["label"].words() + " by scene";
  picture.description =
      "A line for each scene over the methods within each n*: means of the participants who judged it there, "
      "with "
      "their intervals. The table of scores by scene holds the numbers.";
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const Style& style = styles[s % styles.size()];
    const double aside =
        0.4 * panels.step * ((static_cast<double>(s) + 0.5) / static_cast<double>(scenes.size()) - 0.5);
    for (std::size_t p = 0; p < panels.n_stars.size(); ++p) {
      std::vector<std::optional<Point>> points(panels.methods.size());
      each_cell(panels, task1["by_scene"], score, p, [&](const Field& cell, std::size_t m) {
        if (cell["scene"].words() != scenes[s].words()) return;
        points[m] = Point{panels.x(p, m, aside), panels.y(cell["mean"].number())};
        if (cell["ci"].entries().size() == 2) {
          const auto end = [&](std::size_t i) {
            return panels.y(std::clamp(cell["ci"][i].number(), panels.min, panels.max));
          };
          picture.body += line({points[m]->x, end(0)}, {points[m]->x, end(1)},
                               attribute("stroke", style.colour) + " stroke-width=\"1.1\"");
        }
        picture.body += svg::circle(*points[m], 3, attribute("fill", style.colour));
      });
      picture.body += polyline(points, stroke(style, "2"));
    }
    const double x = left + column * static_cast<double>(s % 3),
                 y = panels.bottom() + 64 + 20 * static_cast<double>(s / 3);
    picture.body += line({x, y - 5}, {x + 34, y - 5}, stroke(style, "2")) +
                    text({x + 40, y}, scenes[s].words(), "font-size=\"13\"" + data_field(scenes[s]));
  }
  picture.width =
      std::max(picture.width, left + column * static_cast<double>(std::min<std::size_t>(scenes.size(), 3)));
  picture.height += 14 + 20 * static_cast<double>(scenes.empty() ? 0 : (scenes.size() - 1) / 3);
  return picture;
}

}  // namespace study::report
