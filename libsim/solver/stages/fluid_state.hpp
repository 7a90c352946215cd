#pragma once
/// Everything a stage may touch.

#include <limits>

#include "libsim/activation/activation.hpp"
#include "libsim/flow/heat_ledger.hpp"
#include "libsim/flow/jets.hpp"
#include "libsim/flow/outflow.hpp"
#include "libsim/foam/foam_pool.hpp"
#include "libsim/impulse/impulse_recorder.hpp"
#include "libsim/levels/level_state.hpp"
#include "libsim/neighbors/neighbour_list.hpp"
#include "libsim/particles/kernels.hpp"
#include "libsim/particles/walls.hpp"
#include "libsim/pressure/coarse_grid.hpp"
#include "libsim/pressure/waterline.hpp"
#include "libsim/saliency/saliency.hpp"
#include "libsim/scene/effects.hpp"
#include "libsim/solver/stages/conjugate_gradient.hpp"
#include "libsim/solver/stages/obstacle_state.hpp"
#include "libsim/solver/stages/part_clock.hpp"

namespace sim::SIM_BACKEND {

/// Acceleration -strength r towards an axis (sim::CentralForce).
struct CentralPull {
  float strength = 0;  ///< Omega^2, 1/s2; 0 leaves it out of the kernel
  Vec3 centre{};
  Vec3 axis{0, 0, 1};
};

/// Numbers of the solver. Defaults are measured ones; docs/solver_notes.md says how.
struct SolverParameters {
  float rest_density = 1000;  ///< rho_0, kg/m3
  float gravity = 9.81f;      ///< along -y, m/s2
  CentralPull pull;           ///< beside gravity
  float dt = 1.0f / 180;      ///< substep, s
  int substeps = 3;           ///< a frame
  double frame_s() const { return static_cast<double>(dt) * substeps; }
  int iterations = 4;  ///< constraint projections a substep
  /// Relaxation without unit, one number for all levels: epsilon_i = relaxation / (m_i d_i^2).
  float relaxation = 0.01f;
  /// s_corr without unit: s_ij = -tensile m_i m_j d^2 (W / W(0.2 h))^4; 0 leaves the term out of the kernel.
  float tensile = 0;
  /// Share of the last projection's step that is taken again (momentum); 0 in a substep's first projection.
  float momentum = 0.4f;
  /// V-cycles of the coarse pressure before the projections; 0 leaves the pass out.
  int coarse_cycles = 2;
  /// Edge of its cells as a share of the finest h, before it is fitted between the walls.
  float coarse_edge = 2;
  /// Kinematic viscosity nu, m2/s; 0 leaves the pass out.
  float viscosity = 0;
  EffectCoefficients effects;  ///< SI; 0 = no such stage runs
  /// No water gets so fast by itself, m/s: what is faster is braked and counted.
  float most_speed = 0;
  /// Nearest distance to a wall, as a share of d.
  float wall_gap = 0.1f;
};

/// Takes from a particle's velocity what guards do not allow, and counts it.
struct Brake {
  Witness witness;
  float most_speed, finest_support;

  /// v, or as much of it as is allowed, of particle i with support h.
  SIM_FN Vec3 limited(Vec3 v, float h, int i) const {
    const float speed = length(v);
    if (!(speed > most_speed)) return v;
    atomic_add(&witness.guards->speed_limited, std::uint64_t{1});
    witness.note(Trouble::TooFast, i);
    const Vec3 left = (most_speed / speed) * v;
    take(v - left, h);
    return left;
  }
  SIM_FN void take(Vec3 v, float h) const {
    Momentum taken{};
    taken.add(mass_units_of(h, finest_support), v);
    witness.guards->braked.add_at_once(taken);
  }
};

/// The fluid between two passes. Arrays of particles are in the grid's order of the last substep.
struct FluidState {
  SolverParameters parameters;
  Walls walls{};
  ObstacleState obstacles;
  Domain domain{};
  float finest_support = 0;    ///< h_* = 4 r_*, m: h of level 0, whether the method holds it or not
  float lightest_support = 0;  ///< h of the lightest particles that the method can hold, m
  /// Of all particles at the start less what has drained, in m_*; what a nozzle holds back is a trace.
  std::int64_t mass_units = 0;
  LevelSupports supports{};
  Vec3 refuge{};           ///< where a particle goes whose place is lost
  bool one_level = true;   ///< all particles have one level, for good
  bool compressed = true;  ///< was lately, or may be: frames begin with a pre-stabilisation
  int substep = 0;
  int iteration = 0;  ///< projection within the substep
  Particles particles;
  Grid grid;
  NeighbourList neighbours;
  /// The lists of the last substep hold everyone's neighbours in today's order: what looks at the fluid
  /// before it moves need not look for them again. Between h and the list's margin they tell the truth of a
  /// moment before.
  bool lists_hold = false;
  bool lists_by_slot = false;  ///< they belong to the slots of that substep
  CoarseGrid coarse;
  Jets jets;
  Outflow outflow;
  Drained drained;         ///< since the run began
  Array<HeatLedger> heat;  ///< one, where particles have a temperature
  FoamPool foam;           ///< of no capacity where the scene lists none
  SaliencyState saliency;
  LevelState levels;
  /// False while a frame is solved that leaves particles out: its passes run over active() and lists belong
  /// to slots. True between frames.
  bool all_active = true;
  Activation activation;
  Array<Guards> guards;
  ImpulseRecorder impulse;
  ConjugateGradient conjugate_gradient;
  PartClock clock;
  PassClock pass_clock;

  /// Who was solved in the last frame; nullptr when everyone was.
  const std::uint8_t* last_active() const {
    return activation.columns_set && !activation.all_marked ? particles.all().active.data() : nullptr;
  }
  ParticleNeighbours particle_neighbours() const {
    return {neighbours.view(), lists_by_slot ? activation.slot_of.data() : nullptr};
  }
  ActiveParticles active() {
    return {activation.slots.data(), particles.all().active.data(), activation.rules.pressed};
  }
  /// What bounds the water of a scene with obstacles; others have `walls`. Kernels are templates of the two,
  /// so that those of a scene without obstacles know nothing of them.
  Solids solids() const {
    return {walls, obstacles.bodies.data(), obstacles.count(), parameters.dt, obstacles.meshes.data()};
  }
  /// Supports above this, m, are of levels that an effect's coarsest_level leaves out: halfway to the next
  /// one's, or wider than any.
  float widest_support(EffectOption coarsest_level) const {
    const auto level = static_cast<std::size_t>(parameters.effects[coarsest_level]);
    if (level + 1 >= static_cast<std::size_t>(most_levels)) return std::numeric_limits<float>::max();
    return 0.5f * (supports.h[level] + supports.h[level + 1]);
  }
  /// True if position corrections by walls and obstacles are recorded.
  bool listens() const { return !impulse.deaf() && (impulse.on() || obstacles.told()); }
  BodyListener body_listener(float times) {
    return {listens() && obstacles.told() ? obstacles.sums.data() : nullptr, obstacles.bodies.data(),
            finest_support, times};
  }
  /// For effects, whose pushes are summed apart from the constraint's; records nothing without those sums.
  BodyListener effects_listener() {
    return {obstacles.told() ? obstacles.sums.data() + obstacles.count() : nullptr, obstacles.bodies.data(),
            finest_support, 1};
  }
  /// Of scenes with obstacles, while the coarse pressure's cells hold their sums.
  Waterline waterline() {
    return {{coarse.frame, mass_of(lightest_support, 1)},
            coarse.multigrid.finest().block,
            solids(),
            coarse.sums.data(),
            coarse.volume.data()};
  }
  Guards* guard() { return guards.data(); }
  /// For a pass in the first (0) or second (1) half of the present substep.
  Witness witness(const int* id, int half) { return {guards.data(), id, 2 * substep + half}; }
  Brake brake(const int* id, int half) { return {witness(id, half), parameters.most_speed, finest_support}; }
};

}  // namespace sim::SIM_BACKEND
