#pragma once
/// Which cells a sweep holds.

#include <string>
#include <vector>

#include "apps/common/solver_setting.hpp"

namespace apps {

struct SweepCell {
  SolverSetting setting;
  int seed = 1;           ///< 1 = the settled state itself; others move it by an ulp
  double seconds = 2;     ///< of content, from the opening of the gate
  std::string size = {};  ///< picture in which water is drawn and looked at; empty = none
  std::string kept = {};  ///< pictures that are kept, drawn apart; empty = none
  bool operator==(const SweepCell&) const = default;
};

/// Everything that the cell runs but for scene file, program and machine.
std::string to_text(const SweepCell& cell);
/// 16 hexadecimal digits that name the cell of this program and scene file, on any machine.
std::string key_of(const SweepCell& cell, const std::string& scene_sha256, const std::string& program);

/// What a sweep is asked for.
struct SweepPlan {
  std::string scene = "SingleDam";
  std::int64_t n_star = 4096;
  double seconds = 2;
  int seeds = 2;
  std::string size = {};  ///< of the timed pictures; empty = none
  std::string kept = {};  ///< of the pictures that are kept to be compared; empty = none
  bool quick = false;     ///< few cells
};

/// HiRes with 32 projections and four substeps: what the others are held against.
SolverSetting reference_setting(const std::string& scene, std::int64_t n_star);
/// The reference with twice the projections, substeps or particles.
std::vector<SolverSetting> finer_references(const SolverSetting& reference);

/// References first, with two seeds of the first; then each method at each size; then each knob alone around
/// HiRes and Ours; then a quarter of the factorial of size, projections, substeps and levels under Ours, in
/// which each combination of the first three stands once and each number of levels as often as another. No
/// setting stands twice.
std::vector<SweepCell> cells_of(const SweepPlan& plan);

}  // namespace apps
