#pragma once
/// State of splits and merges that lasts between frames, and the rules of splits and merges as kernels use
/// them (ViP-Fluid 3.3).

#include <cstdint>

#include "libsim/exec/vec.hpp"
#include "libsim/methods/level_turns.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

/// Rules of ViP-Fluid's Algorithms 1 and 2 in the form that kernels use. sim::Readings explains the members
/// that are copied from it.
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
        calm_dead_band(static_cast<float>(readings.calm_dead_band)),
        kick_filter(static_cast<float>(readings.kick_filter)),
        calm_viscosity(static_cast<float>(readings.calm_viscosity)) {}

  int coarsest;  ///< N - 1, with N the number of levels
  bool graded;
  float split_offset[3];
  float split_share;
  bool merge_same_target;
  float merge_reach;
  float merge_overlap;
  bool merge_keeps_steps;
  /// A particle of level l may become coarser only if N (1 - s) of ViP-Fluid Eq. 9 is at least l + 1 plus
  /// this number; s is the particle's saliency.
  float dead_band;
  float calm_dead_band;
  float kick_filter;
  float calm_viscosity;

  // Rules that the paper leaves open.
  /// looks_farther: frames without a merge partner after which a particle searches beyond merge_reach. lags:
  /// frames without a partner after which the level of a finer particle no longer prevents merges of its
  /// neighbours. When most particles of a level have merged, the last few have no partner within merge_reach.
  int looks_farther = 6, lags = 32;
  /// Minimum number of listed neighbours of a particle that counts as inside the fluid; beside a wall the
  /// minimum is reduced. A particle has 40 in deep water, 29 at the surface and 26 in a sheet of two layers.
  /// So particles of sheets and drops never merge beyond merge_reach.
  float inside_count = 30;
  bool relays = true;  ///< particles without a merge partner may merge through a coarser particle
  /// Minimum distance between coarser particles and the result of a merge through a relay of more than twice
  /// the mass of each merging particle (relay.cpp), as a share of the sum of their radii. It is smaller than
  /// merge_overlap: some overlap is accepted in order to remove the last particles of a level among coarser
  /// water.
  float stranded_overlap = 0.5f;
  /// Smallest share of its density constraint that a particle enforces (Easing::share), while the youngest
  /// particle within its support is 0, 1, ... frames old. So overlaps after a split or a merge separate
  /// gradually.
  static constexpr int ease_frames = 5;
  float ease[ease_frames] = {0.1f, 0.2f, 0.3f, 0.5f, 0.7f};
  /// Number of projections, at the beginning of a frame's first substep, of the particles that just split or
  /// merged and of the particles near them (parting.cpp). These projections change positions, not velocities.
  int partings = 3;
  /// Replaces `partings` in short substeps: if g dt^2, the distance by which gravity moves a particle in a
  /// substep, is less than the share `parts_widely` of the finest support. The neighbours of the moved
  /// particles then move too.
  int wide_partings = 8;
  float parts_widely = 1.0f / 1600;
  /// Replaces `partings` in weightless water, where all particles move: no force would bring back water that
  /// overlaps push away.
  int weightless_partings = 10;
};

/// Event counts on the device since the simulation was made. A particle-turn is one particle in one update of
/// the levels.
struct LevelCounts {
  std::uint64_t splits;          ///< particles that split
  std::uint64_t born;            ///< particles added by splits: 2^k - 1 per split
  std::uint64_t merges;          ///< merges; each removes one particle
  std::uint64_t split_deferred;  ///< particle-turns in which LevelRules::split_share delayed a split
  /// particle-turns in which no children fitted between the walls and obstacles
  std::uint64_t split_at_wall;
  /// particle-turns (particles times updates of the levels) in which a split exceeded the capacity
  std::uint64_t split_no_room;
  /// particle-turns in which a particle found no partner, and at least one candidate was refused because the
  /// merged particle would overlap a coarser particle or an obstacle
  std::uint64_t merge_overlap;
  /// particle-turns in which a neighbour of a finer level or target prevented a merge
  std::uint64_t merge_step;
  std::uint64_t energy_lost_uj;  ///< kinetic energy lost in merges, 1e-6 J
};

/// A sphere with one target level inside and another outside: targets for tests.
struct TargetSphere {
  Vec3 centre{};
  float radius = 0;
  int inside = 0, outside = 0;
};

using NewLevelsView = ColumnView<columns(Column::Level, Column::Velocity),
                                 columns(Column::Target, Column::History, Column::Age, Column::Waiting),
                                 ColumnSet{}, columns(Column::Drift)>;

struct LevelState {
  LevelRules rules;
  TargetSphere forced;
  std::uint32_t frame = 0;  ///< number of past updates of the levels; part of the key of the random numbers
  LevelTurns turns;         ///< the frames that update saliency, splits and merges
  /// a particle split or merged in this frame, or could have split but for the capacity
  bool changed = false;
  Array<LevelCounts> counts;
  /// Initialises Target, History, Age, Waiting and Drift; called once when a run begins.
  void begin(NewLevelsView particles);

  // Scratch arrays of one frame. They are members, so that each frame reuses their memory.
  Scanner scanner;
  Sorter sorter;
  Array<std::uint8_t> status, status_next;  ///< state of each particle while splits are chosen (split.cpp)
  Array<std::uint8_t> split_code;           ///< packed SplitCode; 0 = no split
  Array<std::uint8_t> wish;                 ///< 1 = wants to merge
  Array<std::uint8_t> gone;                 ///< 1 = merged into another particle
  Array<std::uint8_t> graded;  ///< targets written by a sweep that limits neighbours' differences
  Array<int> partner;          ///< proposed merge partner
  /// number of particles that replace each particle: 2^k if it splits, 0 if it merged into another particle,
  /// else 1
  Array<int> births;
  Array<int> places;  ///< first the mutual merge partners, later the inclusive sums of births
  /// order: first the splits by priority, later the source in the old arrays of each particle of the new
  /// arrays; child: index of this particle among the particles made from its source
  Array<int> order, child;
  /// flags or numbers, and their prefix sums: of splits, of the particles that each split adds, of free ids,
  /// of new children
  Array<int> flags, sums;
  Array<std::uint64_t> keys;  ///< keys of splits for sorting by priority
  Array<int> free_ids;        ///< ids that no particle uses, ascending
  /// slots (particles/selection.hpp) of the particles that are moved apart after splits and merges
  /// (LevelRules::partings), and their number
  Array<int> beside, beside_count;
  // Relays (relay.cpp) reuse memory. The two particles for which a relay bids are stored in `births` and
  // `places`, which compact() overwrites later in the frame. The best bids are stored in `keys`, which splits
  // no longer need.
  Array<int>& first_bid() { return births; }
  Array<int>& second_bid() { return places; }
  Array<std::uint64_t>& taken_bids() { return keys; }
};

/// History of a particle whose target was `level` in the last four frames. A history has two bits per frame;
/// the newest frame has the lowest bits.
SIM_FN std::uint8_t steady_history(int level) { return static_cast<std::uint8_t>(0x55 * level); }

/// The smallest target of the last four frames.
SIM_FN int least_of_history(std::uint8_t history) {
  int least = 3;
  for (int back = 0; back < 4; ++back) {
    const int level = history >> (2 * back) & 3;
    least = level < least ? level : least;
  }
  return least;
}

}  // namespace sim::SIM_BACKEND
