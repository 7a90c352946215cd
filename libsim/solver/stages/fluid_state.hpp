#pragma once
/// All state that stages may access.

#include <array>
#include <chrono>
#include <limits>
#include <vector>

#include "libsim/activation/activation.hpp"
#include "libsim/exec/ordered_sum.hpp"
#include "libsim/exec/space.hpp"
#include "libsim/flow/flow.hpp"
#include "libsim/foam/foam_pool.hpp"
#include "libsim/impulse/impulse_recorder.hpp"
#include "libsim/levels/level_state.hpp"
#include "libsim/methods/solver_numbers.hpp"
#include "libsim/neighbors/neighbour_list.hpp"
#include "libsim/particles/calm.hpp"
#include "libsim/particles/kernels.hpp"
#include "libsim/particles/walls.hpp"
#include "libsim/pressure/coarse_grid.hpp"
#include "libsim/saliency/saliency.hpp"
#include "libsim/scene/effects.hpp"
#include "libsim/solver/stages/obstacle_state.hpp"

namespace sim::SIM_BACKEND {

/// Acceleration -strength r towards an axis (sim::CentralForce).
struct CentralPull {
  float strength = 0;  ///< Omega^2, 1/s2; 0 removes the term from the kernel
  Vec3 centre{};
  Vec3 axis{0, 0, 1};
};

/// Solver numbers. The defaults were measured, see docs/decisions.md.
struct SolverParameters {
  float rest_density = 1000;  ///< rho_0, kg/m3
  Fall gravity;
  CentralPull pull;       ///< in addition to gravity
  float dt = 1.0f / 180;  ///< substep, s
  int substeps = 3;       ///< per frame
  /// No force holds the water together or down; cohesion does not count.
  bool weightless() const { return gravity.strength <= 0 && pull.strength <= 0; }
  double frame_s() const { return static_cast<double>(dt) * substeps; }
  int iterations = 4;  ///< constraint projections per substep
#define SIM_MEMBER(Type, member, name, usual, ...) Type member = usual;
  SIM_SOLVER_NUMBERS(SIM_MEMBER)
#undef SIM_MEMBER
  /// Kinematic viscosity nu, m2/s; 0 omits the pass.
  float viscosity = 0;
  EffectCoefficients effects;  ///< SI; 0 = no such stage runs
  /// Speed that no water exceeds by itself, m/s: faster particles are braked and counted.
  float most_speed = 0;
  /// Minimum distance to a wall, as a share of d.
  float wall_gap = 0.1f;
};

/// Limits a particle's velocity to what the guards allow, and counts each case.
struct Brake {
  Witness witness;
  float most_speed, finest_support;

  /// v limited to the allowed speed, for particle i with support h.
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

// State of the conjugate gradients between passes (libsim/solver/effects).

/// Scalars of a step, on the device: the host decides nothing.
struct ConjugateStep {
  float rest;   ///< r r
  float along;  ///< step length of x along p
  float turn;   ///< factor of p in the next direction
};

/// Empty until the first solve.
struct ConjugateGradient {
  OrderedSum sum;
  Array<ConjugateStep> step;
};

/// alpha = r r / p A p, or 0 if p A p is 0.
struct TakeAlong {
  ConjugateStep* step;
  SIM_FN void operator()(float bent) const { step->along = bent > 0 ? step->rest / bent : 0; }
};
/// beta = new r r / old r r, or 0 if the old r r is 0.
struct TakeTurn {
  ConjugateStep* step;
  SIM_FN void operator()(float rest) const {
    step->turn = step->rest > 0 ? rest / step->rest : 0;
    step->rest = rest;
  }
};

// State of buoyancy between its passes.

/// On the device, of the water that takes part in heat.
struct MeanWarmth {
  float mass;    ///< m_*
  float warmth;  ///< mean by mass, K above the reference
};

/// Empty until the first pass.
struct Buoyancy {
  OrderedSum sum;
  Array<MeanWarmth> mean;
};

// Timers for the parts of a frame, and for its passes.

/// The parts of the paper's Table 2 to which stages are assigned.
enum class Part { Saliency, Levels, Activation, Solve, count };

/// Off until switched on. Waits for the device between parts.
class PartClock {
 public:
  void switch_on() { on_ = true; }
  void start_frame() { seconds_.fill(0); }
  void enter(Part part) {
    if (!on_ || part == running_) return;
    synchronize();
    const auto now = std::chrono::steady_clock::now();
    if (running_ != Part::count) {
      seconds_[static_cast<std::size_t>(running_)] += std::chrono::duration<double>(now - since_).count();
    }
    running_ = part;
    since_ = now;
  }
  void end_frame() { enter(Part::count); }

  /// In the last frame.
  double milliseconds(Part part) const { return 1e3 * seconds_[static_cast<std::size_t>(part)]; }

 private:
  bool on_ = false;
  Part running_ = Part::count;
  std::chrono::steady_clock::time_point since_;
  std::array<double, static_cast<std::size_t>(Part::count)> seconds_{};
};

/// The same for each pass of a schedule, by its index.
class PassClock {
 public:
  /// Discards earlier measurements. 0 passes: off.
  void measure(std::size_t passes) {
    seconds_.assign(passes, 0);
    running_ = passes;
  }
  void start_frame() { seconds_.assign(seconds_.size(), 0); }
  void enter(std::size_t pass) {
    if (seconds_.empty()) return;
    synchronize();
    const auto now = std::chrono::steady_clock::now();
    if (running_ < seconds_.size()) seconds_[running_] += std::chrono::duration<double>(now - since_).count();
    running_ = pass;
    since_ = now;
  }
  void end_frame() { enter(seconds_.size()); }

  /// In the last frame; 0 while off.
  double milliseconds(std::size_t pass) const { return seconds_.empty() ? 0 : 1e3 * seconds_[pass]; }

 private:
  std::size_t running_ = 0;
  std::chrono::steady_clock::time_point since_;
  std::vector<double> seconds_;
};

/// The fluid between two passes. Particle arrays are in the grid's order of the last substep.
struct FluidState {
  SolverParameters parameters;
  Walls walls{};
  ObstacleState obstacles;
  Domain domain{};
  float finest_support = 0;  ///< h_* = 4 r_*, m: h of level 0, even if the method has no particles of level 0
  float lightest_support = 0;  ///< h of the lightest particles that the method can hold, m
  /// Mass of the particles at the start minus the drained mass, in m_*; the mass that nozzles hold back is
  /// negligible.
  std::int64_t mass_units = 0;
  LevelSupports supports{};
  Vec3 refuge{};           ///< position for particles whose own position is lost
  bool one_level = true;   ///< all particles have one level throughout the run
  bool compressed = true;  ///< the water is or may be compressed: frames begin with a pre-stabilisation
  int substep = 0;
  bool forces_acted = false;  ///< the substep's forces are in the velocities: predict adds none
  int iteration = 0;          ///< projection within the substep
  Particles particles;
  Grid grid;
  NeighbourList neighbours;
  /// The lists of the last substep hold all particles' neighbours in the present order: passes that read the
  /// fluid before it moves need not search again. Between h and the list's margin they may be slightly out of
  /// date.
  bool lists_hold = false;
  bool lists_by_slot = false;  ///< the lists belong to the slots of that substep
  CoarseGrid coarse;
  Jets jets;
  Outflow outflow;
  Drained drained;         ///< since the run began
  Array<HeatLedger> heat;  ///< one element, if particles have a temperature
  Buoyancy buoyancy;
  FoamPool foam;  ///< capacity 0 if the scene lists none
  SaliencyState saliency;
  LevelState levels;
  /// False while solving a frame that leaves particles out: its passes run over active() and lists belong to
  /// slots. True between frames.
  bool all_active = true;
  Activation activation;
  Array<Guards> guards;
  ImpulseRecorder impulse;
  ConjugateGradient conjugate_gradient;
  PartClock clock;
  PassClock pass_clock;

  /// Flags of the particles solved in the last frame; nullptr if all were.
  const std::uint8_t* last_active() const {
    return activation.columns_set && !activation.all_marked ? particles.all().active.data() : nullptr;
  }
  ParticleNeighbours particle_neighbours() const {
    return {neighbours.view(), lists_by_slot ? activation.slot_of.data() : nullptr};
  }
  ActiveParticles active() {
    return {activation.slots.data(), particles.all().active.data(), activation.rules.pressed};
  }
  /// The boundaries of a scene with obstacles; other scenes use `walls`. Kernels are templates over both
  /// types, so that kernels of scenes without obstacles contain no obstacle code.
  Solids solids() const {
    return {walls, obstacles.bodies.data(), obstacles.count(), parameters.dt, obstacles.meshes.data()};
  }
  /// Supports above this, m, belong to levels that an effect's coarsest_level excludes: halfway to the next
  /// level's support, or the maximum float.
  float widest_support(EffectOption coarsest_level) const {
    const auto level = static_cast<std::size_t>(parameters.effects[coarsest_level]);
    if (level + 1 >= static_cast<std::size_t>(most_levels)) return std::numeric_limits<float>::max();
    return 0.5f * (supports.h[level] + supports.h[level + 1]);
  }
  /// Gravity for the measures of rest, which go by sqrt(g d_*), m/s2. In a scene without gravity a value that
  /// makes this speed a hundredth of d_* per frame: otherwise the smallest motion counts as fast.
  float gravity_of_rest() const {
    if (parameters.gravity.strength > 0) return parameters.gravity.strength;
    const auto frame = static_cast<float>(parameters.frame_s());
    return 1e-4f * 0.5f * finest_support / (frame * frame);
  }
  /// True if position corrections by walls and obstacles are recorded.
  bool recording() const { return !impulse.paused() && (impulse.on() || obstacles.recorded()); }
  BodyListener body_record(float times) {
    return {recording() && obstacles.recorded() ? obstacles.sums.data() : nullptr, obstacles.bodies.data(),
            finest_support, times, obstacles.listening_patches()};
  }
  /// For effects, whose pushes are summed apart from the constraint's; records nothing if those sums are off.
  BodyListener effects_listener() {
    return {obstacles.recorded() ? obstacles.sums.data() + obstacles.count() : nullptr,
            obstacles.bodies.data(), finest_support, 1, obstacles.listening_patches()};
  }
  /// For scenes with obstacles, while the coarse pressure's cells hold their sums.
  Waterline waterline() {
    return {{coarse.frame, mass_of(lightest_support, 1)},
            coarse.multigrid.finest().block,
            solids(),
            coarse.sums.data(),
            coarse.volume.data(),
            parameters.gravity.axis()};
  }
  Guards* guard() { return guards.data(); }
  /// For a pass in the first (0) or second (1) half of the present substep.
  Witness witness(const int* id, int half) { return {guards.data(), id, 2 * substep + half}; }
  Brake brake(const int* id, int half) { return {witness(id, half), parameters.most_speed, finest_support}; }
};

}  // namespace sim::SIM_BACKEND
