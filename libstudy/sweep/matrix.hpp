#pragma once
/// The cells of a sweep.

#include <string>
#include <vector>

#include "libsim/setting/solver_setting.hpp"

namespace study {

struct SweepCell {
  sim::SolverSetting setting;
  int seed = 1;           ///< 1 = the settled state itself; others perturb it by an ulp
  double seconds = 2;     ///< of content, from the opening of the gate
  std::string size = {};  ///< size of the timed pictures, which the method sees; empty = none
  std::string kept = {};  ///< size of the pictures for comparison, not timed; empty = none
  bool operator==(const SweepCell&) const = default;
};

/// All that determines a run, except scene file, program and machine.
std::string to_text(const SweepCell& cell);
/// 16 hexadecimal digits that identify the cell of this program and scene file, on any machine.
std::string key_of(const SweepCell& cell, const std::string& scene_sha256, const std::string& program);

/// The request for a sweep.
struct SweepPlan {
  std::string scene = "SingleDam";
  std::int64_t n_star = 4096;
  double seconds = 2;
  int seeds = 2;
  std::string size = {};  ///< size of the timed pictures; empty = none
  std::string kept = {};  ///< size of the pictures stored for comparison; empty = none
  bool quick = false;     ///< few cells
};

/// HiRes with 32 projections and four substeps: the reference of all comparisons.
sim::SolverSetting reference_setting(const std::string& scene, std::int64_t n_star);
/// The reference with twice the projections, substeps or particles.
std::vector<sim::SolverSetting> finer_references(const sim::SolverSetting& reference);

/// References first, with two seeds of the first; then each method at each size; then each knob alone around
/// HiRes and Ours; then a quarter of the factorial of size, projections, substeps and levels under Ours,
/// which has each combination of the first three once and each number of levels equally often. No cell occurs
/// twice.
std::vector<SweepCell> cells_of(const SweepPlan& plan);

}  // namespace study
