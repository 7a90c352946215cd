#include "libsim/measure/stability_map.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "stats/figures/svg.hpp"

namespace measure {

Limit<double> largest_factor(const Trial<double>& trial, double most, double resolution) {
  Limit<double> out{.reach = Reach::AllPass, .passed = most, .failed = trial(most), .runs = 1};
  if (out.failed.empty()) return out;
  out.reach = Reach::Found;
  out.passed = 1;
  // The tolerance keeps rounding from adding a bisection if the resolution divides the range exactly.
  for (double fails = most; fails / out.passed > resolution * (1 + 1e-9);) {
    const double middle = std::sqrt(fails * out.passed);
    ++out.runs;
    if (const std::string what = trial(middle); what.empty()) {
      out.passed = middle;
    } else {
      fails = middle;
      out.failed = what;
    }
  }
  return out;
}

Limit<int> fewest(const Trial<int>& trial, int usual) {
  Limit<int> out{.passed = usual, .failed = {}};
  for (int fails = 0; out.passed - fails > 1;) {
    const int middle = (fails + out.passed) / 2;
    ++out.runs;
    if (const std::string what = trial(middle); what.empty()) {
      out.passed = middle;
    } else {
      fails = middle;
      out.failed = what;
    }
  }
  if (out.passed == 1) out.reach = Reach::AllPass;
  return out;
}

namespace {

const char* reach_name(Reach reach) {
  switch (reach) {
    case Reach::Found:
      return "found";
    case Reach::AllPass:
      return "all_pass";
    case Reach::UsualFails:
      return "default_fails";
  }
  return "";
}

/// A cell's usual number, limit and margin, such as "0.0167 to 0.0334 (x 2.0)".
std::string in_markdown(const MapCell& cell) {
  if (cell.reach == Reach::UsualFails) return "**fails at " + figures::shortest(cell.usual) + "**";
  return figures::shortest(cell.usual) + " to " + figures::shortest(cell.limit) +
         (cell.reach == Reach::AllPass ? "+" : "") + " (x " + figures::number(margin_of(cell), 2) + ")";
}

const MapCell* find(const StabilityMap& map, const std::string& id, const std::string& method, Knob knob) {
  const auto found = std::find_if(map.cells.begin(), map.cells.end(), [&](const MapCell& cell) {
    return cell.case_id == id && cell.method == method && cell.knob == knob;
  });
  return found == map.cells.end() ? nullptr : &*found;
}

std::string measured_on(const StabilityMap& map) {
  std::string out = map.circumstances;
  for (const std::string& effect : map.effects) out += "; effect " + effect;
  return out;
}

}  // namespace

const char* knob_name(Knob knob) {
  switch (knob) {
    case Knob::FrameStep:
      return "frame_step";
    case Knob::Iterations:
      return "iterations";
    case Knob::Scale:
      return "scale";
  }
  return "";
}

double margin_of(const MapCell& cell) {
  if (cell.reach == Reach::UsualFails) return 0;
  return cell.knob == Knob::Iterations ? cell.usual / cell.limit : cell.limit / cell.usual;
}

figures::TextTable to_table(const StabilityMap& map) {
  figures::TextTable out{{"case", "title", "method", "knob", "of", "default", "limit", "margin", "status",
                          "failed_beyond", "most_factor", "resolution", "circumstances"},
                         {}};
  for (const MapCell& cell : map.cells) {
    out.rows.push_back({cell.case_id, figures::in_a_cell(cell.title), cell.method, knob_name(cell.knob),
                        figures::in_a_cell(cell.of), figures::shortest(cell.usual),
                        figures::shortest(cell.limit), figures::number(margin_of(cell), 3),
                        reach_name(cell.reach), figures::in_a_cell(cell.failed), figures::shortest(map.most),
                        figures::shortest(map.resolution), figures::in_a_cell(measured_on(map))});
  }
  return out;
}

std::string to_markdown(const StabilityMap& map) {
  figures::TextTable table{{"case", "method", "largest frame step, s", "fewest iterations", "largest scale",
                            "what fails beyond: step; iterations; scale"},
                           {}};
  for (const std::string& id : map.cases) {
    for (const std::string& method : map.methods) {
      if (!find(map, id, method, Knob::FrameStep)) continue;
      std::vector<std::string> row{id, method};
      std::string failed;
      for (const Knob knob : all_knobs) {
        const MapCell* cell = find(map, id, method, knob);
        row.push_back(cell ? in_markdown(*cell) : "");
        // A failure at the case's usual numbers concerns all three knobs but is listed once.
        if (!cell || (cell->reach == Reach::UsualFails && !failed.empty())) continue;
        failed += (failed.empty() ? "" : "; ") + (cell->failed.empty() ? "nothing" : cell->failed);
      }
      row.push_back(figures::in_a_cell(failed));
      table.rows.push_back(row);
    }
  }
  return "Measured on " + measured_on(map) + ". Factors up to " + figures::shortest(map.most) +
         " were tried. Between what passed and what failed lies a factor of " +
         figures::shortest(map.resolution) +
         " at most, or one iteration. + says that all that was tried passed.\n\n" + to_markdown(table);
}

namespace {

using svg::Point;

constexpr double left_px = 52, top_px = 88, cell_px = 66, row_px = 24, gap_px = 22, line_px = 14;

/// Shades of one blue, darker with a larger margin; their lightness differs enough for any colour vision.
struct Shade {
  double from;  ///< smallest margin of this shade
  const char* fill;
  const char* ink;
  const char* words;
};
constexpr Shade shades[] = {{1, "#eff3ff", "black", "under 1.25"},
                            {1.25, "#bdd7e7", "black", "1.25 to 1.5"},
                            {1.5, "#6baed6", "black", "1.5 to 2"},
                            {2, "#2171b5", "white", "2 to 3"},
                            {3, "#08306b", "white", "3 and more"}};
constexpr Shade fails{0, svg::colour::vermilion, "white", "fails at its own numbers"};
constexpr Shade absent{0, "#bbbbbb", "black", "does not apply"};

const Shade& shade_of(double margin) {
  const Shade* out = &shades[0];
  for (const Shade& one : shades) {
    if (margin >= one.from - 1e-9) out = &one;
  }
  return *out;
}

const char* heading(Knob knob) {
  switch (knob) {
    case Knob::FrameStep:
      return "Largest frame step";
    case Knob::Iterations:
      return "Fewest iterations";
    case Knob::Scale:
      return "Largest speed or size";
  }
  return "";
}
const char* heading_unit(Knob knob) {
  return knob == Knob::Iterations ? "number, of the case's own" : "times the case's own";
}

std::string value_of(const MapCell& cell) {
  if (cell.reach == Reach::UsualFails) return "fails";
  if (cell.knob == Knob::Iterations)
    return figures::number(cell.limit, 0) + " of " + figures::number(cell.usual, 0);
  return figures::number(margin_of(cell), 2) + (cell.reach == Reach::AllPass ? "+" : "");
}

std::string box(Point at, double width, const Shade& shade, const std::string& words) {
  return svg::rectangle(at, {at.x + width, at.y + row_px},
                        svg::attribute("fill", shade.fill) + " stroke=\"white\" stroke-width=\"1\"") +
         svg::text({at.x + width / 2, at.y + row_px - 8}, words,
                   svg::attribute("fill", shade.ink) + " text-anchor=\"middle\"");
}

std::string panel(const StabilityMap& map, Knob knob, double left) {
  std::string out = svg::text({left, top_px - 44}, heading(knob), "font-size=\"13\" font-weight=\"bold\"") +
                    svg::text({left, top_px - 29}, heading_unit(knob));
  for (std::size_t m = 0; m < map.methods.size(); ++m) {
    const double x = left + cell_px * static_cast<double>(m);
    out += svg::text({x + cell_px / 2, top_px - 8}, map.methods[m], "text-anchor=\"middle\"");
    for (std::size_t c = 0; c < map.cases.size(); ++c) {
      const Point at{x, top_px + row_px * static_cast<double>(c)};
      const MapCell* cell = find(map, map.cases[c], map.methods[m], knob);
      const bool broken = cell && cell->reach == Reach::UsualFails;
      const Shade& shade = !cell ? absent : broken ? fails : shade_of(margin_of(*cell));
      out += box(at, cell_px, shade, cell ? value_of(*cell) : "-");
    }
  }
  return out;
}

std::string legend(double top) {
  constexpr double width = 92;
  std::string out = svg::text({8, top - 6}, "margin to the default, as a factor");
  double x = 8;
  for (const Shade& shade : shades) {
    out += box({x, top}, width, shade, shade.words);
    x += width + 4;
  }
  out += box({x, top}, 1.8 * width, fails, fails.words);
  return out + box({x + 1.8 * width + 4, top}, 1.2 * width, absent, absent.words);
}

}  // namespace

std::string to_svg(const StabilityMap& map) {
  const double panel_px = cell_px * static_cast<double>(map.methods.size());
  const double rows_end = top_px + row_px * static_cast<double>(map.cases.size());
  svg::Picture picture{.id = "stability", .title = "Stability map"};
  picture.width = std::max(left_px + 3 * panel_px + 2 * gap_px + 8, 820.0);
  picture.height = rows_end + 88 + line_px * static_cast<double>(map.effects.size());
  picture.description =
      "Hard cases by methods in three panels: how far the frame step, the iterations and the speed or size "
      "may be turned before the case fails.";
  picture.body = svg::text({8, 22}, "How far each hard case is from failing", "font-size=\"15\"") +
                 "<g font-size=\"11\">\n";
  for (std::size_t c = 0; c < map.cases.size(); ++c) {
    const double y = top_px + row_px * static_cast<double>(c) + row_px - 8;
    picture.body += svg::text({left_px - 8, y}, map.cases[c], "text-anchor=\"end\" font-weight=\"bold\"");
  }
  double left = left_px;
  for (const Knob knob : all_knobs) {
    picture.body += panel(map, knob, left);
    left += panel_px + gap_px;
  }
  picture.body += legend(rows_end + 30);
  picture.body +=
      svg::text({8, rows_end + 76}, map.circumstances + "; factors up to " + figures::shortest(map.most) +
                                        ", resolution " + figures::shortest(map.resolution) +
                                        "; + : all that was tried passed");
  double line = rows_end + 76;
  for (const std::string& effect : map.effects)
    picture.body += svg::text({8, line += line_px}, "water with the effect " + effect);
  picture.body += "</g>\n";
  return svg::document(picture);
}

}  // namespace measure
