#pragma once
/// All state that stages may access.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
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

/// Acceleration -strength r towards an axis, with r the vector from the axis (sim::CentralForce).
struct CentralPull {
  float strength = 0;  ///< Omega^2, 1/s2; with 0 the solver runs a kernel without this term
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
  /// True without gravity and central force, even if the scene has the effect cohesion.
  bool weightless() const { return gravity.strength <= 0 && pull.strength <= 0; }
  double frame_s() const { return static_cast<double>(dt) * substeps; }
  int iterations = 4;  ///< constraint projections per substep
#define SIM_MEMBER(Type, member, name, usual, ...) Type member = usual;
  SIM_SOLVER_NUMBERS(SIM_MEMBER)
#undef SIM_MEMBER
  /// Kinematic viscosity nu, m2/s; 0: the XSPH pass only calms water at rest.
  float viscosity = 0;
  EffectCoefficients effects;  ///< coefficients in SI units; 0 = no stage of the effect runs
  /// Speed limit, m/s (most_speed() in fluid_simulation.hpp): faster particles are slowed to it and counted.
  float most_speed = 0;
  /// Minimum distance of a particle to a wall, as a share of the particle's spacing.
  float wall_gap = 0.1f;

  /// How short a substep is for particles of support h, m: h / (800 g dt^2), or 0 without gravity. Above 1
  /// the substep counts as short. The projections make particles jitter at a share of d / dt, and in short
  /// substeps that is large compared with sqrt(g d) (docs/decisions.md, "Still water of one size").
  double shortness(float support) const {
    const double g = static_cast<double>(gravity.strength), step = static_cast<double>(dt);
    return g > 0 ? static_cast<double>(support) / (g * step * step * 800) : 0;
  }
  /// True if water of one level rests by its mean motion, as water with levels does, in a run with this
  /// support of level 0, m: in short substeps, unless viscosity removes over 0.005 of the velocity
  /// differences in one (docs/decisions.md, "Still water in short substeps").
  bool rests_by_drift(float support) const {
    return still_speed > 0 && shortness(support) > 1 && 22 * viscosity * dt < 0.005f * support * support;
  }
};

/// Limits the speed of particles to `most_speed`. Counts each case, and records the removed momentum.
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

/// Scalars of a step of the conjugate gradients. They stay on the device, so that the host need not wait for
/// them.
struct ConjugateStep {
  float rest;   ///< r r, with r the residual
  float along;  ///< step length of x along p
  float turn;   ///< factor of p, the present direction, in the next direction
};

/// Memory of the conjugate gradients; empty until the first solve.
struct ConjugateGradient {
  OrderedSum sum;
  Array<ConjugateStep> step;
};

/// Step length alpha = r r / p A p, with the matrix A; 0 unless p A p > 0.
struct TakeAlong {
  ConjugateStep* step;
  SIM_FN void operator()(float bent) const { step->along = bent > 0 ? step->rest / bent : 0; }
};
/// Factor beta = new r r / old r r; 0 unless the old r r > 0.
struct TakeTurn {
  ConjugateStep* step;
  SIM_FN void operator()(float rest) const {
    step->turn = step->rest > 0 ? rest / step->rest : 0;
    step->rest = rest;
  }
};

/// Mass and mean temperature, on the device, of the water that takes part in the effect heat.
struct MeanWarmth {
  float mass;    ///< m_*
  float warmth;  ///< mean by mass, K above the reference
};

/// Memory of the effect heat's buoyancy; empty until the first pass.
struct Buoyancy {
  OrderedSum sum;
  Array<MeanWarmth> mean;
};

/// Parts of a frame, as in ViP-Fluid's Table 2. Each stage belongs to one part.
enum class Part { Saliency, Levels, Activation, Solve, count };

/// Measures the time of each part of a frame. Off until switched on. While on, it waits for the device
/// between parts.
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

  /// Time of the part in the last frame, ms.
  double milliseconds(Part part) const { return 1e3 * seconds_[static_cast<std::size_t>(part)]; }

 private:
  bool on_ = false;
  Part running_ = Part::count;
  std::chrono::steady_clock::time_point since_;
  std::array<double, static_cast<std::size_t>(Part::count)> seconds_{};
};

/// Measures the time of each pass of a schedule, by the pass's index.
class PassClock {
 public:
  /// Starts to measure this number of passes, and discards earlier times. 0 = off.
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

  /// Time of the pass in the last frame, ms; 0 while off.
  double milliseconds(std::size_t pass) const { return seconds_.empty() ? 0 : 1e3 * seconds_[pass]; }

 private:
  std::size_t running_ = 0;
  std::chrono::steady_clock::time_point since_;
  std::vector<double> seconds_;
};

/// The fluid between two passes. The last neighbour search sorted the particle arrays by cell; later splits,
/// merges, nozzles and outlets may have changed them.
struct FluidState {
  SolverParameters parameters;
  Walls walls{};
  ObstacleState obstacles;
  Domain domain{};
  float finest_support = 0;  ///< h_* = 4 r_*, m: h of level 0, even if the method has no particles of level 0
  float lightest_support = 0;  ///< h of the lightest particles that the method can hold, m
  /// Mass of the water, in m_*, the mass of a particle of level 0: the mass at the start minus the drained
  /// mass. It includes mass that nozzles have taken but not yet poured, which is negligible.
  std::int64_t mass_units = 0;
  LevelSupports supports{};
  Vec3 refuge{};          ///< new position of particles that are not finite or far outside the tank
  bool one_level = true;  ///< all particles have one level throughout the run
  bool one_level_rests_by_drift = false;  ///< Demand::rests_by_drift
  bool compressed = true;  ///< the water is or may be compressed: frames begin with a pre-stabilisation
  int substep = 0;
  bool forces_acted = false;  ///< velocities already include the substep's forces: predict adds none
  int iteration = 0;          ///< projection within the substep
  Particles particles;
  Grid grid;
  NeighbourList neighbours;
  /// The last substep's lists contain the neighbours of all particles in the present order, so that passes
  /// before the particles move need no new search. List entries between h and the lists' margin may be
  /// slightly out of date.
  bool lists_hold = false;
  /// lists are indexed by the slots of the last substep (particles/selection.hpp), not by particles
  bool lists_by_slot = false;
  CoarseGrid coarse;
  Jets jets;
  Outflow outflow;
  Drained drained;         ///< water that left through outlets since the run began
  Array<HeatLedger> heat;  ///< one element, if particles have a temperature
  Buoyancy buoyancy;
  FoamPool foam;  ///< capacity 0 if the scene does not list the effect foam
  SaliencyState saliency;
  LevelState levels;
  /// False in a substep that does not solve all particles, and during all of a frame with whole-frame rests.
  /// Passes then run over active(), and lists are indexed by slots (particles/selection.hpp). True between
  /// frames.
  bool all_active = true;
  Activation activation;
  Array<Guards> guards;
  ImpulseRecorder impulse;
  ConjugateGradient conjugate_gradient;
  PartClock clock;
  PassClock pass_clock;

  /// Flags of the particles solved in every substep of the last frame; nullptr if all were.
  const std::uint8_t* last_active() const {
    return activation.columns_set && !activation.all_marked ? particles.all().active.data() : nullptr;
  }
  ParticleNeighbours particle_neighbours() const {
    return {neighbours.view(), lists_by_slot ? activation.slot_of.data() : nullptr};
  }
  ActiveParticles active() {
    return {activation.slots.data(), particles.all().active.data(), activation.rules.within_frame};
  }
  /// The boundaries of a scene with obstacles; other scenes use `walls`. Kernels are templates over both
  /// types, so that kernels of scenes without obstacles contain no obstacle code.
  Solids solids() const {
    return {walls, obstacles.bodies.data(), obstacles.count(), parameters.dt, obstacles.meshes.data()};
  }
  /// Largest support, m, of particles on which an effect with this option coarsest_level acts: halfway
  /// between the supports of this level and the next. The maximum float if the effect acts on all levels.
  float widest_support(EffectOption coarsest_level) const {
    const auto level = static_cast<std::size_t>(parameters.effects[coarsest_level]);
    if (level + 1 >= static_cast<std::size_t>(most_levels)) return std::numeric_limits<float>::max();
    return 0.5f * (supports.h[level] + supports.h[level + 1]);
  }
  /// The gravity g, m/s2, in the speed sqrt(g d_*), with the finest spacing d_*, that saliency and the
  /// particles' importance use as the scale of slow motion. Without gravity, a value that makes this speed
  /// 0.01 d_* per frame; otherwise the smallest motion would count as fast.
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
  /// Records the pushes of effects on bodies. They are summed separately from the pushes of the density
  /// constraint. Records nothing if the obstacles' pushes are not recorded.
  BodyListener effects_listener() {
    return {obstacles.recorded() ? obstacles.sums.data() + obstacles.count() : nullptr,
            obstacles.bodies.data(), finest_support, 1, obstacles.listening_patches()};
  }
  /// The water level beside obstacles. Valid in scenes with obstacles, after the coarse pressure has summed
  /// its cells.
  Waterline waterline() {
    return {{coarse.frame, mass_of(lightest_support, 1)},
            coarse.multigrid.finest().block,
            solids(),
            coarse.sums.data(),
            coarse.volume.data(),
            parameters.gravity.axis()};
  }
  Guards* guard() { return guards.data(); }
  /// Begins a substep. With rests of one substep (Readings::rest_within_frame), every second substep solves
  /// all particles, counted from the frame's last one.
  void begin_substep(int number) {
    substep = number;
    iteration = 0;
    if (activation.rests_within_frame()) all_active = (parameters.substeps - number) % 2 == 1;
  }
  /// True in a substep that solves particles which rested in the substep before.
  bool after_rest() const { return activation.rests_within_frame() && all_active && substep > 0; }
  /// The time since each particle was last solved, in a substep of after_rest(); else 1 substep for each.
  TimeOfRest time_of_rest() const { return {after_rest() ? particles.all().active.data() : nullptr}; }
  /// Recorder of troubled particles for a pass in the first (0) or second (1) half of the present substep.
  Witness witness(const int* id, int half) { return {guards.data(), id, 2 * substep + half}; }
  /// Degree of rest with the limit speed share x sqrt(g d_*).
  Calm calm_under(double share) const {
    return calm_below(share, static_cast<double>(parameters.gravity.strength),
                      static_cast<double>(finest_support) / 2);
  }
  /// Support of the run's smallest particles, m: that of level 0, except in runs of one coarser level.
  float smallest_support() const { return std::max(finest_support, lightest_support); }
  /// SolverParameters::shortness() of the smallest particles, at least 1.
  double shortness() const { return std::max(1.0, parameters.shortness(smallest_support())); }
  /// Degree of rest with `share` times the limit speed of water at rest (Readings::calm_speed).
  Calm calm(double share) const { return calm_under(share * saliency.readings.calm_speed); }
  /// The same for splits and merges: in short substeps the limit is up to twice as high, as the projections'
  /// jitter is faster.
  Calm calm_for_events(double share) const { return calm(share * std::sqrt(std::min(4.0, shortness()))); }
  /// Degree of rest by the mean motion of the surroundings (the column Drift), with `share` times that
  /// motion's limit speed (docs/decisions.md, "Boiling and waves", "Still water in short substeps").
  Calm drift_calm(double share) const {
    constexpr double of_still_speed = 0.45;
    const double raised = std::sqrt(std::max(std::min(shortness(), 2.0), shortness() / 2));
    return calm_below(share * raised * of_still_speed * static_cast<double>(parameters.still_speed),
                      static_cast<double>(parameters.gravity.strength),
                      static_cast<double>(smallest_support()) / 2);
  }
  Brake brake(const int* id, int half) { return {witness(id, half), parameters.most_speed, finest_support}; }
};

}  // namespace sim::SIM_BACKEND
