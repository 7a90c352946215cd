#pragma once
/// How fast water meets water, over a length that is the scene's and not the particles'. Neighbours of fine
/// and of coarse water, and of water that rests in turn, move against each other by what their sizes and
/// steps make of it; the means of cells do not.

#include "libsim/activation/velocity_grid.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Cells of the scene's length, and what was found on them in this frame.
struct MeetingCells {
  static constexpr int most_cells = 1 << 20;

  GridFrame grid{};
  Vec3 last{1, 1, 1};  ///< sides of the cells at the high walls, which cut them, in edges
  float full = 1;      ///< mass of the water that fills a cell, m_*
  CellMomentum sums;
  /// x: speed at which water meets over its distance, 1/s; w: value_measured, or value_unknown without water.
  Array<Vec4> meeting;

  /// `wish`, or a wider edge with which most_cells are enough, m.
  static float edge_of(const Domain& domain, float wish);
  /// Cells of `edge` over the domain; finest_support in m. The edge is one of edge_of().
  void lay(const Domain& domain, float edge, float finest_support);
  std::size_t bytes() const { return sums.bytes() + meeting.bytes(); }
};

/// Fills `meeting`. The cells' mean velocities have a gradient G, fitted to a cell and the 26 round it by
/// squares; two places along e meet at |G e| - e G e over their distance (Ihmsen et al. 2012, Eq. 2), here in
/// the mean over all e. Times the share of the cells round it that is water: air is shut in between water.
/// What lies behind walls or in obstacles is not missing. Bounds: Walls, or Solids in scenes with obstacles.
template <class Bounds>
void find_meeting(MeetingCells& cells, MovingView water, const Bounds& bounds);

}  // namespace sim::SIM_BACKEND
