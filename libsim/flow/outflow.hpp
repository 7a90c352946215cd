#pragma once
/// What leaves through outlets: particles on the far side of a plane that has an opening.

#include "libsim/flow/heat_ledger.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/walls.hpp"

namespace sim::SIM_BACKEND {

using OutflowView = ColumnView<columns(Column::Position, Column::Level),
                               columns(Column::Position, Column::Velocity, Column::Id, Column::Level,
                                       Column::Predicted, Column::Density),
                               columns(Column::Temperature)>;

class Outflow {
 public:
  /// Particles and their mass in units of m_*.
  struct Amount {
    int particles, mass;
  };

  /// Removes those that are through and keeps the others in their order, with their densities of the last
  /// projection. The ids that leave are free. What heat leaves is told to `heat`, where there is any. Waits
  /// for a read-back.
  Amount run(Particles& particles, OutflowView view, const Walls& walls, HeatLedger* heat);
  std::size_t bytes() const;

 private:
  Scanner scanner_;
  Array<int> stays_, sums_, order_;
  Array<float> density_;
  Array<Amount> left_;
};

/// Of a whole run.
struct Drained {
  std::int64_t particles = 0;
  std::int64_t mass = 0;  ///< in m_*
};

}  // namespace sim::SIM_BACKEND
