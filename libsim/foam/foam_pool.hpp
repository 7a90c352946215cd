#pragma once
/// Diffuse particles - spray, foam and bubbles - in a separate pool (Ihmsen et al. 2012). Water moves them;
/// they do not move the water.

#include <cstdint>

#include "libsim/activation/velocity_grid.hpp"
#include "libsim/exec/space.hpp"
#include "libsim/exec/vec.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// The fate of all emitted particles since the run began: emitted = alive + dissolved + dropped + left.
struct FoamLedger {
  std::uint64_t emitted;    ///< requested by the potentials
  std::uint64_t dissolved;  ///< reached the end of their lifetime on the water
  std::uint64_t dropped;    ///< found no room in the pool
  std::uint64_t left;       ///< left through an outlet, or became non-finite
};

/// Kinds of diffuse particles. The kind follows from the surrounding water: its density divided by rho_0, as
/// if water continued behind the walls. A count of neighbours would depend on the levels.
struct FoamKinds {
  static constexpr float spray = 0.2f;    ///< below this: spray
  static constexpr float bubble = 0.75f;  ///< above this: bubble
};

/// Closing speed of water, over a length given by the scene and not by the particles: the cells, and this
/// frame's results on them. The relative motion of neighbours depends on their sizes and time steps, and on
/// resting particles; cell means do not.
struct MeetingCells {
  static constexpr int most_cells = 1 << 20;

  GridFrame grid{};
  Vec3 last{1, 1, 1};  ///< side lengths of the cells that the high walls cut, as shares of the grid's edge
  float full = 1;      ///< mass of water that fills a cell, m_*
  CellMomentum sums;
  /// x: closing speed of water divided by its distance, 1/s; w: value_measured, or value_unknown without
  /// water.
  Array<Vec4> meeting;

  /// `wish`, or a wider edge that needs at most most_cells, m.
  static float edge_of(const Domain& domain, float wish);
  /// Places cells of `edge` over the domain; finest_support in m. The edge must come from edge_of().
  void lay(const Domain& domain, float edge, float finest_support);
  std::size_t bytes() const { return sums.bytes() + meeting.bytes(); }
};

struct FoamPool {
  /// x, y, z in m; w: remaining lifetime on the water in s, 0 or less if the slot is free.
  Array<Vec4> place;
  Array<Vec4> velocity;  ///< m/s; w: surrounding water, as in FoamKinds
  Array<FoamLedger> ledger;
  std::uint32_t frame = 0;  ///< counter for the random numbers

  // Scratch of one frame; kept to reuse its memory.
  MeetingCells cells;
  Array<float> approach;     ///< per water particle, 1/s
  Array<int> births, sums;   ///< per water particle, and inclusive sums
  Array<int> free, free_of;  ///< 1 = the slot is free, and inclusive sums
  Scanner scanner;

  /// Allocates `most` empty slots for diffuse particles, and buffers for `water` particles of water.
  void begin(int most, int water);
  /// 0 without foam.
  int capacity() const { return static_cast<int>(place.size()); }
  std::size_t bytes() const {
    return place.bytes() + velocity.bytes() + ledger.bytes() + approach.bytes() + births.bytes() +
           sums.bytes() + free.bytes() + free_of.bytes() + cells.bytes();
  }
  /// State that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    const std::size_t most = place.size();
    archive(place, velocity, ledger, frame);
    if constexpr (Archive::reads) {
      if (place.size() != most || velocity.size() != most || ledger.size() != 1)
        Archive::fail("holds a pool of foam of another size");
    }
  }
};

/// Fills `meeting`. The gradient G of the cells' mean velocities is a least-squares fit over a cell and the
/// 26 around it. Two points along e approach at |G e| - e G e over their distance (Ihmsen et al. 2012, Eq.
/// 2); the result is the mean over all e, times the share of the surrounding cells that is water, because air
/// is trapped between water. Space behind walls or in obstacles is not counted as missing. Bounds: Walls, or
/// Solids in scenes with obstacles.
template <class Bounds>
void find_meeting(MeetingCells& cells, MovingView water, const Bounds& bounds);

}  // namespace sim::SIM_BACKEND
