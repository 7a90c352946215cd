#pragma once
/// Emission of diffuse particles where water entrains air, and their motion (Ihmsen et al. 2012, sections 3
/// and 4). Emission is counted by volume, so that fine and coarse water emit the same amount.

#include "libsim/foam/foam_pool.hpp"
#include "libsim/neighbors/grid.hpp"
#include "libsim/particles/calm.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Potential Phi of a value: 0 up to `from`, 1 from `from + span` on, linear between.
struct Potential {
  float from, span;
  SIM_FN float operator()(float value) const { return at_most(at_least((value - from) / span, 0.0f), 1.0f); }
};

/// Parameters of the effect foam in the form that kernels use.
struct FoamRules {
  float dt = 0;  ///< duration of the frame, s
  Fall gravity{0};
  float rate = 0;  ///< volume of foam per second and volume of water at full potential, 1/s
  /// Potential of trapped air, tau_ta. Its argument is the closing speed of two points in the water divided
  /// by their distance, 1/s.
  Potential approach{};
  /// Potential of wave crests, tau_wc. Its argument is the curvature of a moving crest, 1/m.
  Potential crest{};
  /// Weight of crests: the surface of a full crest emits as much as water of this depth whose potential of
  /// trapped air is 1, m.
  float crest_depth = 1;
  Potential energy{};     ///< potential of kinetic energy, tau_k, of a value in J/kg: v^2 / 2
  int coarsest = 3;       ///< coarsest level that still emits
  int coarsest_seen = 3;  ///< coarsest level that may lie next to emitting water
  float lifetime = 1;     ///< mean time on the water, s
  float volume = 1;       ///< volume of a diffuse particle, m3
  float air_drag = 0;     ///< drag of air on spray: deceleration divided by speed, 1/s
  float rise = 0;         ///< speed of bubbles relative to the water in Earth's gravity, m/s
};

using FoamView = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                            columns(Column::Normal)>;

// Bounds: Walls, or Solids in scenes with obstacles.

/// Fills the column Normal (outwards, dimensionless: about 1 at a surface; 0 for water that is too slow or
/// too coarse to foam), and FoamPool::approach from the cells that find_meeting() filled.
template <class Bounds>
void find_foam_surface(FoamPool& pool, FoamView water, const Grid& grid, const Bounds& bounds,
                       const FoamRules& rules);
/// Fills FoamPool::births from the column Normal and FoamPool::approach.
void count_foam_births(FoamPool& pool, FoamView water, const Grid& grid, const FoamRules& rules);
/// Stores the emitted particles (FoamPool::births) in free slots of the pool, and updates the ledger. If too
/// few slots are free, the dropped particles are spread evenly.
template <class Bounds>
void emit_foam(FoamPool& pool, FoamView water, const Bounds& bounds, const FoamRules& rules);

using FoamWaterView = Reads<Column::Position, Column::Velocity>;

/// Moves the diffuse particles over a frame, ages foam, and counts in the ledger the particles that dissolved
/// or left. A particle has left if it is beyond an opening in a wall, or not finite. Walls and obstacles stop
/// particles; a moving obstacle carries them along.
template <class Bounds>
void move_foam(FoamPool& pool, FoamWaterView water, const Grid& grid, const Bounds& bounds,
               const FoamRules& rules);

}  // namespace sim::SIM_BACKEND
