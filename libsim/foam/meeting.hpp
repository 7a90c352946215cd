#pragma once
/// Closing speed of water, over a length given by the scene and not by the particles. The relative motion of
/// neighbours depends on their sizes and time steps, and on resting particles; cell means do not.

#include "libsim/activation/velocity_grid.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Cells of the scene's length, and this frame's results on them.
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

/// Fills `meeting`. The gradient G of the cells' mean velocities is a least-squares fit over a cell and the
/// 26 around it. Two points along e approach at |G e| - e G e over their distance (Ihmsen et al. 2012, Eq.
/// 2); the result is the mean over all e, times the share of the surrounding cells that is water, because air
/// is trapped between water. Space behind walls or in obstacles is not counted as missing. Bounds: Walls, or
/// Solids in scenes with obstacles.
template <class Bounds>
void find_meeting(MeetingCells& cells, MovingView water, const Bounds& bounds);

}  // namespace sim::SIM_BACKEND
