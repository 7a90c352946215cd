#pragma once
/// The stability map: how far each hard case is from failing, by method and by what is turned.

#include <string>
#include <vector>

#include "apps/bench/cells.hpp"
#include "apps/bench/limit_search.hpp"

namespace apps {

enum class Knob { FrameStep, Iterations, Scale };
inline constexpr Knob all_knobs[] = {Knob::FrameStep, Knob::Iterations, Knob::Scale};
const char* knob_name(Knob knob);  ///< as in the CSV: "frame_step", "iterations", "scale"

/// One case under one method with one number turned.
struct MapCell {
  std::string case_id, title, method;
  Knob knob{};
  std::string of;    ///< what the number is: "s", "projections a substep", "30 m/s of the jet"
  double usual = 0;  ///< the case's own number
  double limit = 0;  ///< the farthest that passed
  Reach reach = Reach::Found;
  std::string failed;  ///< beyond the limit, or at the usual number
};

/// limit / usual, or usual / limit where fewer is farther; 0 where the usual number fails.
double margin_of(const MapCell& cell);

struct StabilityMap {
  std::vector<std::string> cases;    ///< ids, from the top
  std::vector<std::string> methods;  ///< from the left
  std::vector<MapCell> cells;        ///< a case and method without cells does not apply
  double most = 0;                   ///< largest factor that was tried
  double resolution = 0;             ///< factor between what passed and what failed, at most
  std::string circumstances;         ///< machine, back end, size, seed
  /// Of the water, each in words; then a case fails by what is of stability alone.
  std::vector<std::string> effects = {};
};

/// A row for each cell.
TextTable to_table(const StabilityMap& map);
/// A paragraph on how it was measured, and a row for each case and method.
std::string to_markdown(const StabilityMap& map);
/// Cases by methods, a panel for each knob, each cell with its value.
std::string to_svg(const StabilityMap& map);

}  // namespace apps
