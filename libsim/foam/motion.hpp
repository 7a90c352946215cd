#pragma once
/// Emission of diffuse particles, where water entrains air, and their motion (Ihmsen et al. 2012, sections 3
/// and 4). Emission is counted by volume: fine and coarse water emit the same amount.

#include "libsim/foam/foam_pool.hpp"
#include "libsim/neighbors/grid.hpp"
#include "libsim/particles/calm.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Phi: 0 up to `from`, 1 from `from + span` on, linear between.
struct Potential {
  float from, span;
  SIM_FN float operator()(float value) const { return at_most(at_least((value - from) / span, 0.0f), 1.0f); }
};

/// The effect's parameters in the form that kernels use.
struct FoamRules {
  float dt = 0;  ///< of the frame, s
  Fall gravity{0};
  float rate = 0;        ///< volume of foam per second and volume of water at full potential, 1/s
  Potential approach{};  ///< tau_ta, 1/s: closing speed of water divided by its distance
  Potential crest{};     ///< tau_wc, 1/m: curvature of moving crests
  /// Depth of water at full trapped air that emits as much as a full crest's surface, m.
  float crest_depth = 1;
  Potential energy{};     ///< tau_k, J/kg: v^2 / 2
  int coarsest = 3;       ///< coarsest level that still emits
  int coarsest_seen = 3;  ///< coarsest level that may be next to such water
  float lifetime = 1;     ///< mean time on the water, s
  float volume = 1;       ///< of a diffuse particle, m3
  float air_drag = 0;     ///< of spray, 1/s
  float rise = 0;         ///< speed of bubbles relative to the water in Earth's gravity, m/s
};

using FoamView = ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
                            columns(Column::Normal)>;

// Bounds: Walls, or Solids in scenes with obstacles.

/// Fills Normal (outwards, dimensionless: about 1 at a surface; 0 for water that is too slow to foam) and
/// FoamPool::approach, from the cells that find_meeting() filled.
template <class Bounds>
void find_foam_surface(FoamPool& pool, FoamView water, const Grid& grid, const Bounds& bounds,
                       const FoamRules& rules);
/// Fills FoamPool::births from both.
void count_foam_births(FoamPool& pool, FoamView water, const Grid& grid, const FoamRules& rules);
/// Places the counted births in free slots of the pool, as many as there are, and updates the ledger. If too
/// few slots are free, the dropped births are spread evenly.
template <class Bounds>
void emit_foam(FoamPool& pool, FoamView water, const Bounds& bounds, const FoamRules& rules);

using FoamWaterView = Reads<Column::Position, Column::Velocity>;

/// Moves the diffuse particles over a frame with the surrounding water, ages foam, and records in the ledger
/// which dissolved or left. Particles beyond the walls' openings have left. Walls and obstacles stop
/// particles; a moving obstacle carries them along.
template <class Bounds>
void move_foam(FoamPool& pool, FoamWaterView water, const Grid& grid, const Bounds& bounds,
               const FoamRules& rules);

}  // namespace sim::SIM_BACKEND
