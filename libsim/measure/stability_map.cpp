#include "libsim/measure/stability_map.hpp"

#include <algorithm>

namespace measure {

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

/// "0.0167 to 0.0334 (x 2.0)"
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

/// Circumstances and effects.
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
        // A failure at the usual numbers is listed once.
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

}  // namespace measure
