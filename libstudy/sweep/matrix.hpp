#pragma once
/// Lists the cells of a sweep. A cell is one run: a solver setting from one start.

#include <string>
#include <vector>

#include "libsim/setting/solver_setting.hpp"

namespace study {

struct SweepCell {
  sim::SolverSetting setting;
  /// Start of the run. 1: the settled state of the water. 2, 3, ...: the settled state with each coordinate
  /// of each particle moved by one unit in the last place; the directions depend on the seed.
  int seed = 1;
  double seconds = 2;  ///< simulated time from frame 0
  /// Size of the pictures whose drawing is timed, such as "1280x720"; a method that depends on the picture
  /// receives them. Empty: none.
  std::string size = {};
  /// Size of the pictures that are stored for comparison, such as "240x135"; they are drawn outside the
  /// timing. Empty: none.
  std::string kept = {};
  bool operator==(const SweepCell&) const = default;
};

/// The cell as text. With scene file, program and machine it determines the run.
std::string to_text(const SweepCell& cell);
/// 16 hexadecimal digits: a hash of cell, scene file and program. It does not depend on the machine.
std::string key_of(const SweepCell& cell, const std::string& scene_sha256, const std::string& program);

/// The user's request for a sweep.
struct SweepPlan {
  std::string scene = "SingleDam";
  std::int64_t n_star = 4096;
  double seconds = 2;
  int seeds = 2;  ///< number of starts of each setting except the references: SweepCell::seed 1, 2, ...
  std::string size = {};  ///< SweepCell::size of all cells
  std::string kept = {};  ///< SweepCell::kept of all cells
  /// True: the sweep varies only the method and the number of projections. It has no other size than n_star,
  /// no finer references (the reference with one of its numbers doubled) and no factorial of knobs.
  bool quick = false;
};

/// The setting with which all others are compared: HiRes with 32 projections and four substeps.
sim::SolverSetting reference_setting(const std::string& scene, std::int64_t n_star);
/// Three settings: the reference with twice the projections, with twice the substeps, and with twice the
/// particles.
std::vector<sim::SolverSetting> finer_references(const sim::SolverSetting& reference);

/// The cells in this order. First the reference with two seeds and the finer references. Then each method at
/// each n_*. Then HiRes and Ours with one knob changed. Last a quarter of the factorial of n_*, projections,
/// substeps and levels under Ours: each combination of n_*, projections and substeps once, each number of
/// levels equally often. No cell occurs twice.
std::vector<SweepCell> cells_of(const SweepPlan& plan);

}  // namespace study
