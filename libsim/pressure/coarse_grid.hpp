#pragma once
/// The bridge between particles and the coarse pressure's cells.

#include "libsim/pressure/multigrid.hpp"

namespace sim::SIM_BACKEND {

/// Cells of one edge from a low corner.
struct CellFrame {
  Vec3 low{};
  float edge = 1;
};

/// A box that holds the whole tank.
struct Domain {
  Vec3 low{}, high{};
};

/// What particles bring to a cell, in fixed point, so that the sum does not depend on the order of adding.
struct CellSum {
  std::uint64_t volume, excess;
};

struct CoarseGrid {
  CellFrame frame;
  Array<CellSum> sums;
  Multigrid multigrid;

  /// Cells of `edge`, or wider where the domain would need more than `most_cells`.
  void fit(const Domain& domain, float edge);
  static constexpr double most_cells = 1 << 24;
};

}  // namespace sim::SIM_BACKEND
