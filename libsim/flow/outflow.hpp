#pragma once
/// Removes what leaves through outlets: particles on the far side of a plane that has an opening.

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

  /// Removes the particles that passed an opening; the others keep their order and their densities of the
  /// last projection. The removed ids become free. The heat that leaves is added to `heat`, if not null.
  /// Waits for a read-back.
  Amount run(Particles& particles, OutflowView view, const Walls& walls, HeatLedger* heat);
  std::size_t bytes() const;

 private:
  Scanner scanner_;
  Array<int> stays_, sums_, order_;
  Array<float> density_;
  Array<Amount> left_;
};

/// Totals of a whole run.
struct Drained {
  std::int64_t particles = 0;
  std::int64_t mass = 0;  ///< in m_*
};

}  // namespace sim::SIM_BACKEND
