#pragma once
/// How fast water meets water, over a length that is the scene's and not the particles'. Neighbours of fine
/// and of coarse water, and of water that rests in turn, move against each other by what their sizes and
/// steps make of it; the means of cells do not.

#include "libsim/activation/velocity_grid.hpp"

namespace sim::SIM_BACKEND {

/// Cells of the scene's length, and what was found on them in this frame.
struct MeetingCells {
  GridFrame grid{};
  float full = 1;  ///< mass of the water that fills a cell, m_*
  Array<MomentumSum> sums;
  /// x: speed at which water meets over its distance, 1/s; w: value_measured, or value_unknown without water.
  Array<Vec4> meeting;

  /// Cells of `edge` over the domain; finest_support in m.
  void lay(const Domain& domain, float edge, float finest_support);
  std::size_t bytes() const { return sums.bytes() + meeting.bytes(); }
};

/// Fills `meeting`. The cells' mean velocities have a gradient G, fitted to a cell and the 26 round it by
/// squares; two places along e meet at |G e| - e G e over their distance (Ihmsen et al. 2012, Eq. 2), here in
/// the mean over all e. Times the share of the cells round it that is water: air is shut in between water.
void find_meeting(MeetingCells& cells, MovingView water);

}  // namespace sim::SIM_BACKEND
