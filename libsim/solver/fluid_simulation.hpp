#pragma once
/// Implementation of sim::Simulation on this back end.

#include <memory>
#include <utility>
#include <vector>

#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"
#include "libsim/solver/schedule.hpp"
#include "libsim/solver/substeps.hpp"

namespace sim::SIM_BACKEND {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);

/// Simulated time of a frame, s.
double frame_dt_of(const Scene& scene, const SimulationOptions& options);
/// Minimum number of substeps per frame: the number in the options or, if that is 0, the scene's, raised to
/// what the scene's effects need. base::Error if the options set fewer than an effect needs, or if an effect
/// needs more than 1000.
int substeps_needed(const Scene& scene, const SimulationOptions& options);
/// substeps_needed for those effects of the scene that act on its water.
int least_substeps(const Scene& scene, const SimulationOptions& options);
/// Text that lists the effects `listed`, then the longest substep that the effects of `scene` allow, and the
/// scene's characteristic scales and Reynolds, Weber and Bond numbers; with viscosity and gravity also the
/// shear rate below which the particles' lattice adds more than a quarter to the viscous stress. `scene` must
/// contain only effects that act on its water (acting_scene). Empty text without effects and obstacles.
std::string effects_in_words(const std::vector<Effect>& listed, const Scene& scene,
                             const SimulationOptions& options);
/// Solver numbers that follow from scene and options.
SolverParameters solver_parameters(const Scene& scene, const SimulationOptions& options);
/// sqrt(v0^2 + 2 g H + (Omega R)^2), m/s: upper bound on the speed of water that starts at v0 and falls
/// freely to the tank's lowest corner along gravity and to the axis of the central force. v0: largest speed
/// of the start, the nozzles and the moving obstacles. H: largest height of the water, the nozzles and the
/// free obstacles above that corner. R: largest distance of the start and the nozzles from the axis.
double fall_speed(const Scene& scene, const std::vector<ParticleState>& start);
/// g + Omega^2 R, m/s2: the largest acceleration of the start by gravity and the central force; R as in
/// fall_speed.
double start_acceleration(const Scene& scene, const std::vector<ParticleState>& start);
/// Rule for the number of substeps. `fastest`: largest speed of the start, the nozzles and the obstacles,
/// m/s. `acceleration`: largest acceleration by gravity and the central force, m/s2. base::Error if water at
/// rest needs more substeps than a frame may have and the options set neither these nor the frame's duration.
SubstepRule substep_rule(const Scene& scene, const SimulationOptions& options, const Resolution& resolution,
                         double fastest, double acceleration);
/// Speed limit, m/s: three times fall_speed, plus three times the capillary speed, plus the squeeze speed of
/// obstacles that turn or swing. Water that strikes a wall shoots up at twice fall_speed (PeersDam: 8.7 m/s
/// with a fall of 4.4); a higher speed is an error of the solver. Squeeze speed: an obstacle of half width a
/// that moves at up to u drives water through gaps of at least one spacing d, at u a / d at most. Without
/// gravity and with a speed below 0.001 d per frame, the limit is two supports of the finest particles per
/// substep.
float most_speed(double fall_speed, const Scene& scene, const Resolution& resolution,
                 const SolverParameters& parameters);
/// Largest speed of the particles at the start, of water from nozzles, and of the obstacles, m/s.
double start_speed(const Scene& scene, const std::vector<ParticleState>& start);
/// Requirements on the schedule of a run, from scene, method and options. `levels`: finest and coarsest level
/// of the water.
Demand demand_of(const Scene& scene, const SimulationOptions& options, const SolverParameters& parameters,
                 std::pair<int, int> levels);
/// base::Error for a number of levels outside 1 .. 4.
void check_levels(int levels);
/// Maximum number of particles. If particles split: particle_capacity of the options, or 8 n_*, the number of
/// particles if all water is at level 0. Never less than the number `start` of particles at the start.
/// base::Error if `start` is too large for indices.
int capacity_for(std::size_t start, const SimulationOptions& options, bool splits);
/// Converts the region for kernels. base::Error for an unknown level.
TargetSphere sphere_of(const TargetRegion& region);
/// The tank's floor, sides and lid with their outlets. While the water settles, outlets are shut, and if
/// there is a gate the walls enclose the water block, except on the side against gravity.
Walls walls_of(const Scene& scene, bool settling);

/// Sets up the scene's obstacles at their positions at `time_s`, without motion. `recorded`: record their
/// pushes on the water. base::Error if an obstacle is thinner than the spacing of particles of
/// `coarsest_level`: water would pass through it. base::Error for a free obstacle that is too light, or in a
/// scene with a central force, or at time_s > 0.
void begin_obstacles(FluidState& state, const Scene& scene, int coarsest_level, double time_s, bool recorded);
/// Starts to record, for each gauge, the push on the water by the gauge's part of an obstacle. base::Error if
/// a gauge names an obstacle that the scene lacks, or covers no part of its obstacle's bounding box.
void begin_patches(FluidState& state, const std::vector<ObstacleGauge>& gauges);
/// Adds the momentum that the obstacles gave the water in the last frame to `account`.
void count_obstacles(const FluidState& state, MomentumAccount& account);
/// The scene's obstacles at `time_s`: their poses and the impulses from other obstacles in the last frame;
/// for free obstacles also velocities, the impulse not yet applied, and impulses from walls.
std::vector<BodyMotion> motions_of(const FluidState& state, double time_s);

/// Densities, neighbour counts and speeds at the present positions. They are measured on a copy of the
/// particles, so that measuring does not change the run.
struct Measured {
  double density_error_mean = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  double density_max = 0;
  double neighbours_mean = 0;  ///< within h, without self
  double listed_mean = 0;      ///< mean list length
  double speed_max_m_s = 0;
  double jump_share = 0;  ///< share of pairs within h whose levels differ by more than one
};
Measured measure(const FluidState& state);

/// The scene's water at rest, at one level, ids from 0.
std::vector<ParticleState> filled(const Scene& scene, const SimulationOptions& options, int level);
/// base::Error for a start that the solver cannot store: unknown levels and, if particles split and merge,
/// ids that repeat or reach the capacity.
void check_start(const std::vector<ParticleState>& start, int capacity, bool adaptive);
/// The finest and the coarsest level that particles may have in a run that does not resume: the levels of its
/// start, of water from nozzles, and of particles that split and merge.
std::pair<int, int> levels_at_start(const Scene& scene, const SimulationOptions& options);
/// Copies the particles of a start into the allocated columns, and sums their mass in m_*, the mass of a
/// particle of level 0.
void put_in(FluidState& state, const std::vector<ParticleState>& start);
/// Sets the temperatures at frame 0 from the scene's boxes, and an empty heat ledger; does nothing if no
/// stage needs temperatures.
void warm_up(FluidState& state, const Scene& scene);
/// Sets positions and velocities of existing particles, by id. base::Error for an unknown id.
void put_again(FluidState& state, const std::vector<ParticleState>& particles);
/// Sets up the nozzles, and what each has poured before `frame`. base::Error if the water of a frame would
/// begin above the lid.
void begin_jets(FluidState& state, const Scene& scene, const SimulationOptions& options,
                const Resolution& resolution, int frame);
/// base::Error if foam particles are so small that a frame may create more than an int can count.
void check_foam(const FluidState& state, const EffectCoefficients& effects, const Scene& scene,
                double frame_dt_s);
/// Allocates the pool of the scene's foam, without particles.
void begin_foam(FluidState& state, const Scene& scene);
/// Updates effect state after the list of effects has changed: allocates `columns`, and memory only for the
/// listed effects. Remaining effects keep their values, except that foam begins anew if its most_particles
/// changed.
void exchange_effects(FluidState& state, const Scene& scene, ColumnSet columns);
/// Lets the water come to rest, at one level and behind the gate if there is one, in substeps of
/// state.parameters; afterwards the walls are the tank's. base::Error if a particle was not finite or far
/// outside the tank.
void settle(FluidState& state, const Scene& scene, const SimulationOptions& options);
/// Projects the positions onto the density constraint, at most `most` times, until the mass-weighted mean of
/// max(rho / rho_0 - 1, 0) is below 0.2 %. Velocities do not change.
RelaxedStart relax_start(FluidState& state, int most);
/// Computes the grids of temporal acceleration, mean velocity V^n and kinetic energy E^n, from the present
/// particles, as the end of a frame does. Call it after relax_start, which measures the densities that decide
/// which particles count as spray.
void start_velocity_grid(FluidState& state);
/// relax_start and, with temporal acceleration, start_velocity_grid, for a start in the middle of a run.
/// Guard counts of this phase are discarded.
RelaxedStart prepare_start(FluidState& state, int most);

}  // namespace sim::SIM_BACKEND
