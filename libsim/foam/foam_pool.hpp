#pragma once
/// Diffuse particles (spray, foam and bubbles) in a separate pool (Ihmsen et al. 2012). Water moves them;
/// they do not move the water.

#include <cstdint>

#include "libsim/activation/velocity_grid.hpp"
#include "libsim/exec/space.hpp"
#include "libsim/exec/vec.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Numbers of diffuse particles since the run began: emitted = alive + dissolved + dropped + left.
struct FoamLedger {
  std::uint64_t emitted;    ///< requested by the rules of emission (FoamRules)
  std::uint64_t dissolved;  ///< reached the end of their lifetime on the water
  std::uint64_t dropped;    ///< not emitted, because the pool had no free slot
  std::uint64_t left;       ///< left through an outlet, or became non-finite
};

/// Limits between the kinds of diffuse particles, as rho / rho_0 of the surrounding water, computed as if
/// water continued behind walls and in obstacles. Ihmsen et al. use the number of neighbours, which would
/// depend on the particles' levels here.
struct FoamKinds {
  static constexpr float spray = 0.2f;    ///< below this: spray
  static constexpr float bubble = 0.75f;  ///< above this: bubble
};

/// Cells on which the closing speed of the water is measured, and this frame's results. The closing speed is
/// the speed at which parts of the water approach each other. The edge of the cells is the effect's length_m,
/// or by default a sixth of the cube root of the water's volume; it is at least 1.5 spacings of the coarsest
/// particles. The speed is measured between cell means, because the difference between two neighbouring
/// particles would depend on their sizes, on the time step and on whether both were solved.
struct MeetingCells {
  static constexpr int most_cells = 1 << 20;

  GridFrame grid{};
  /// Side lengths of the last cell along x, y and z, which a wall may cut, as shares of the edge.
  Vec3 last{1, 1, 1};
  float full = 1;  ///< mass of water that fills a cell, m_*
  CellMomentum sums;
  /// Per cell, x: closing speed of two points of the water divided by their distance, 1/s; w: value_measured,
  /// or value_unknown without water.
  Array<Vec4> meeting;

  /// The edge `wish`, or a longer edge if the domain would need more than most_cells cells, m.
  static float edge_of(const Domain& domain, float wish);
  /// Covers the domain with cells of `edge`; finest_support in m. The edge must come from edge_of().
  void lay(const Domain& domain, float edge, float finest_support);
  std::size_t bytes() const { return sums.bytes() + meeting.bytes(); }
};

struct FoamPool {
  /// x, y, z in m; w: remaining lifetime on the water in s, 0 or less if the slot is free.
  Array<Vec4> place;
  Array<Vec4> velocity;  ///< m/s; w: rho / rho_0 of the surrounding water, see FoamKinds
  Array<FoamLedger> ledger;
  std::uint32_t frame = 0;  ///< counter for the random numbers

  // Scratch data of one frame, in members, so that each frame reuses their memory.
  MeetingCells cells;
  Array<float> approach;     ///< MeetingCells::meeting.x at each water particle, 1/s
  Array<int> births, sums;   ///< number that each water particle emits, and its inclusive sums
  Array<int> free, free_of;  ///< per slot: 1 if it is free, else 0, and the inclusive sums of this
  Scanner scanner;

  /// Allocates `most` empty slots for diffuse particles, and buffers for `water` particles of water.
  void begin(int most, int water);
  /// Number of slots; 0 without foam.
  int capacity() const { return static_cast<int>(place.size()); }
  std::size_t bytes() const {
    return place.bytes() + velocity.bytes() + ledger.bytes() + approach.bytes() + births.bytes() +
           sums.bytes() + free.bytes() + free_of.bytes() + cells.bytes();
  }
  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    const std::size_t most = place.size();
    archive(place, velocity, ledger, frame);
    if constexpr (Archive::reads) {
      if (place.size() != most || velocity.size() != most || ledger.size() != 1)
        Archive::fail("contains foam for another most_particles than the scene's");
    }
  }
};

/// Fills MeetingCells::meeting. A least-squares fit over a cell and the 26 around it gives the gradient G of
/// the cells' mean velocities. Ihmsen et al. (2012, Eq. 2) measure the approach of two points along the unit
/// vector e by (|G e| - e G e) times their distance. The result is the mean of |G e| - e G e over all
/// directions e, with |G e| sampled in 13 of them, times the share of the surrounding cells that water fills,
/// because air is trapped between water. Space behind walls or in obstacles is left out of the share. Bounds:
/// Walls, or Solids in scenes with obstacles.
template <class Bounds>
void find_meeting(MeetingCells& cells, MovingView water, const Bounds& bounds);

}  // namespace sim::SIM_BACKEND
