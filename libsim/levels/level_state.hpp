#pragma once
/// What splitting and merging keep between frames, and their rules as kernels see them (paper 3.3).

#include <cstdint>

#include "libsim/exec/vec.hpp"
#include "libsim/methods/level_turns.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/particles/free_ids.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Rules of Algorithms 1 and 2 as kernels take them; sim::Readings explains those that it gives.
struct LevelRules {
  explicit LevelRules(const Readings& readings = {}, int levels = most_levels)
      : coarsest(levels - 1),
        graded(readings.graded_targets),
        split_offset{static_cast<float>(readings.split_offset[0]),
                     static_cast<float>(readings.split_offset[1]),
                     static_cast<float>(readings.split_offset[2])},
        split_share(static_cast<float>(readings.split_share)),
        merge_same_target(readings.merge_same_target),
        merge_reach(static_cast<float>(readings.merge_reach)),
        merge_overlap(static_cast<float>(readings.merge_overlap)),
        merge_keeps_steps(readings.merge_keeps_steps),
        dead_band(static_cast<float>(readings.merge_dead_band)),
        kick_filter(static_cast<float>(readings.kick_filter)),
        calm_viscosity(static_cast<float>(readings.calm_viscosity)) {}

  int coarsest;  ///< N - 1
  bool graded;
  float split_offset[3];
  float split_share;
  bool merge_same_target;
  float merge_reach;
  float merge_overlap;
  bool merge_keeps_steps;
  /// A particle wants to be coarser only when Eq. 9, without its floor, lies this far beyond its level.
  float dead_band;
  float kick_filter;
  float calm_viscosity;

  // What no reading of the paper decides.
  /// Frames after which a particle without a partner looks farther, and after which finer laggards no longer
  /// hold their neighbours back: when most have merged, a few are left without a partner in reach.
  int looks_farther = 6, lags = 32;
  /// Neighbours in the list, beside a wall fewer, from which a particle counts as inside the fluid. Water has
  /// 40, its surface 29, a sheet of two layers 26: sheets and drops never merge from afar.
  float inside_count = 30;
  bool relays = true;  ///< the stranded may merge through a coarser particle between them
  /// What two stranded particles become keeps this share of the sum of radii from coarser ones: they have
  /// been refused for long, and what is left of a level among much coarser water is worth an overlap.
  float stranded_overlap = 0.5f;
  /// Share of its constraint that a particle enforces in a projection while the youngest within its support
  /// is 0, 1, ... frames old; what overlaps after a split or a merge parts slowly, not at once.
  static constexpr int ease_frames = 5;
  float ease[ease_frames] = {0.1f, 0.2f, 0.3f, 0.5f, 0.7f};
  /// Projections of positions alone round what has just split or merged.
  int partings = 3;
};

/// What happened, counted on the device since the simulation was made.
struct LevelCounts {
  std::uint64_t splits;          ///< particles that split
  std::uint64_t born;            ///< particles that this added: 2^k - 1 each
  std::uint64_t merges;          ///< pairs that became one particle: as many are gone
  std::uint64_t split_deferred;  ///< particle-turns in which the throttle made a split wait
  std::uint64_t split_at_wall;   ///< particle-turns in which no children fitted between the walls
  std::uint64_t split_no_room;   ///< particle-turns in which the capacity refused a split
  std::uint64_t merge_overlap;   ///< particle-turns whose every partner would have overlapped a larger one
  std::uint64_t merge_step;      ///< particle-turns in which a finer neighbour forbade a merge
  std::uint64_t energy_lost_uj;  ///< kinetic energy lost in merges, 1e-6 J
};

/// A sphere in which particles want one level and outside which they want another: targets for tests.
struct TargetSphere {
  Vec3 centre{};
  float radius = 0;
  int inside = 0, outside = 0;
};

using NewLevelsView = ColumnView<columns(Column::Level),
                                 columns(Column::Target, Column::History, Column::Age, Column::Waiting)>;

struct LevelState {
  LevelRules rules;
  TargetSphere forced;
  std::uint32_t frame = 0;  ///< a counter of the random numbers
  LevelTurns turns;         ///< of saliency, splits and merges
  bool changed = false;     ///< something split or merged this frame
  Array<LevelCounts> counts;
  /// Target, History, Age and Waiting of fresh particles; called once when a run begins.
  void begin(NewLevelsView particles);

  // Scratch of one frame; lives on to keep its memory.
  Scanner scanner;
  Sorter sorter;
  Array<std::uint8_t> status, status_next;  ///< of splits, while they are chosen
  Array<std::uint8_t> split_code;           ///< SplitCode, packed; 0 = stays
  Array<std::uint8_t> wish;                 ///< 1 = wants to merge
  Array<std::uint8_t> gone;                 ///< 1 = merged into another
  Array<std::uint8_t> graded;               ///< targets of the next sweep
  Array<int> partner;                       ///< of a merge, as proposed
  Array<int> births;                        ///< particles that one becomes
  Array<int> places;          ///< of these after the frame, as inclusive sums; before that partners that hold
  Array<int> order, child;    ///< a new particle's source, and which of its children it is
  Array<int> flags, sums;     ///< who splits, and how many up to there
  Array<std::uint64_t> keys;  ///< of splits by priority
  Array<int> free_ids;        ///< ascending
  Array<int> beside, beside_count;  ///< slots of those near fresh particles, and how many there are
  // The two whom a relay bids for stand where counts of births come later in the frame, and what the best bid
  // is worth where the frame's splits were.
  Array<int>& first_bid() { return births; }
  Array<int>& second_bid() { return places; }
  Array<std::uint64_t>& taken_bids() { return keys; }
};

/// Two bits a frame, the newest lowest: a particle that has wanted `level` for four frames.
SIM_FN std::uint8_t steady_history(int level) { return static_cast<std::uint8_t>(0x55 * level); }

/// The least target of the last four frames.
SIM_FN int least_of_history(std::uint8_t history) {
  int least = 3;
  for (int back = 0; back < 4; ++back) {
    const int level = history >> (2 * back) & 3;
    least = level < least ? level : least;
  }
  return least;
}

}  // namespace sim::SIM_BACKEND
