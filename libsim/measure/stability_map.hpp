#pragma once
/// The stability map: the safety margin of each hard case, by method and changed number.

#include <functional>
#include <string>
#include <vector>

#include "libsim/measure/cells.hpp"

namespace measure {

// Search by bisection: how far can a number change before something fails?

/// Runs with the changed number; returns what failed, empty if nothing did.
template <class T>
using Trial = std::function<std::string(T)>;

enum class Reach {
  Found,      ///< the limit is between a value that passed and one that failed
  AllPass,    ///< even the farthest value tried passes
  UsualFails  ///< the usual value itself fails
};

template <class T>
struct Limit {
  Reach reach = Reach::Found;
  T passed{};          ///< the farthest value that passed; the usual value if none did
  std::string failed;  ///< what failed at the nearest failing value; empty if all pass
  int runs = 0;
};

/// The largest factor from 1 to `most` that passes: a factor at most `resolution` times as large fails, or
/// the factor is `most` itself. Tries `most` and the bisection's points only. Assumes, without trying, that
/// the factor 1 passes, and all factors below a passing one. most > 1, resolution > 1.
Limit<double> largest_factor(const Trial<double>& trial, double most, double resolution);

/// The smallest whole number from 1 to `usual` that passes, by bisection. Assumes, without trying, that
/// `usual` passes, and all numbers between a passing one and `usual`.
Limit<int> fewest(const Trial<int>& trial, int usual);

// The map.

enum class Knob { FrameStep, Iterations, Scale };
inline constexpr Knob all_knobs[] = {Knob::FrameStep, Knob::Iterations, Knob::Scale};
const char* knob_name(Knob knob);  ///< as in the CSV: "frame_step", "iterations", "scale"

/// One case under one method with one number changed.
struct MapCell {
  std::string case_id, title, method;
  Knob knob{};
  std::string of;    ///< unit of the number: "s", "projections a substep", "times 30 m/s of the jet"
  double usual = 0;  ///< the case's own number
  double limit = 0;  ///< the farthest value that passed; the usual one if none did
  Reach reach = Reach::Found;
  std::string failed;  ///< what failed beyond the limit, or at the usual number
};

/// limit / usual, or usual / limit if the limit is a minimum; 0 if the usual number fails.
double margin_of(const MapCell& cell);

struct StabilityMap {
  std::vector<std::string> cases;    ///< ids, in the order of the rows
  std::vector<std::string> methods;  ///< names, in the order of the columns
  /// No cells for a case that does not apply to a method; no scale for a case that scales no quantity.
  std::vector<MapCell> cells;
  double most = 0;            ///< largest factor tried
  double resolution = 0;      ///< largest factor between what passed and what failed
  std::string circumstances;  ///< machine, back end, size, seed
  /// Effects of the water, each as text; with effects, a case fails only by its stability criteria.
  std::vector<std::string> effects = {};
};

/// One row per cell.
figures::TextTable to_table(const StabilityMap& map);
/// A paragraph on the measurement, and one row per case and method.
std::string to_markdown(const StabilityMap& map);
/// Cases by methods, one panel per knob, each cell with its value.
std::string to_svg(const StabilityMap& map);

}  // namespace measure
