#pragma once
/// sim::Simulation on this back end.

#include <memory>
#include <utility>
#include <vector>

#include "libsim/scene/fill.hpp"
#include "libsim/simulation.hpp"
#include "libsim/solver/schedule.hpp"
#include "libsim/solver/substeps.hpp"

namespace sim::SIM_BACKEND {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const SimulationOptions& options);

/// Content time of a frame, s.
double frame_dt_of(const Scene& scene, const SimulationOptions& options);
/// Substeps that every frame takes at least: the scene's rule or the options', and what its effects need.
/// base::Error when the options' are too few for an effect, or the effect's too many.
int substeps_needed(const Scene& scene, const SimulationOptions& options);
/// The scene's effects, their step and the numbers of its scale, and which of them have no level to act on
/// where the water is of finest_level and coarser; empty without effects and obstacles.
std::string effects_in_words(const Scene& scene, const SimulationOptions& options, int finest_level);
/// Solver numbers that follow from scene and options.
SolverParameters solver_parameters(const Scene& scene, const SimulationOptions& options);
/// sqrt(v0^2 + 2 g H + (Omega R)^2), m/s: what water that starts so, pours in or falls all the way to the
/// floor and to the axis of the central force gets to at most without being pushed. v0 is the fastest of the
/// start and the nozzles, H their largest height, R their largest distance from the axis.
double fall_speed(const Scene& scene, const std::vector<ParticleState>& start);
/// g + Omega^2 R, m/s2: the largest acceleration that the forces give the start.
double start_acceleration(const Scene& scene, const std::vector<ParticleState>& start);
/// Number of substeps from now on; `fastest` m/s are what the start, the nozzles and the obstacles bring.
SubstepRule substep_rule(const Scene& scene, const SimulationOptions& options, const Resolution& resolution,
                         double fastest, double acceleration);
/// Three times what falling gives, and what the surface's energy may add, m/s. Water that strikes a wall
/// shoots up at twice that (PeersDam: 8.7 m/s where it falls at 4.4); what is faster is no water's speed.
/// Without gravity and speed there is no such measure; then two supports of the finest a substep.
float most_speed(double fall_speed, const Scene& scene, const Resolution& resolution,
                 const SolverParameters& parameters);
/// Speed of the fastest of the start, the nozzles and the obstacles, m/s.
double start_speed(const Scene& scene, const std::vector<ParticleState>& start);
/// What the method calls for while it runs.
Demand demand_of(const Scene& scene, const SimulationOptions& options, const SolverParameters& parameters);
/// base::Error for a level that does not exist.
TargetSphere sphere_of(const TargetRegion& region);
/// The tank's floor and sides with their outlets. While the water settles outlets are shut, and where there
/// is a gate the walls are those of the water block. Open above.
Walls walls_of(const Scene& scene, bool settling);

/// The scene's obstacles at rest where they are at this time; `told`: somebody asks what they give the water.
/// base::Error for one that is thinner than the coarsest particles' spacing: water would pass through it.
void begin_obstacles(FluidState& state, const Scene& scene, double time_s, bool told);
/// Adds what the obstacles gave in the frame.
void count_obstacles(const FluidState& state, MomentumAccount& account);
/// The scene's obstacles at this time.
std::vector<BodyMotion> motions_of(const FluidState& state, double time_s);

/// Density and neighbour counts at the present positions, measured on a copy: the run goes on as if nobody
/// had asked.
struct Measured {
  double density_error_mean = 0;  ///< mean of max(rho / rho_0 - 1, 0)
  double density_max = 0;
  double neighbours_mean = 0;  ///< within h, without self
  double listed_mean = 0;      ///< length of a list
  double speed_max_m_s = 0;
  double jump_share = 0;  ///< share of the pairs within h whose levels differ by more than one
};
Measured measure(const FluidState& state);

/// The scene's water at rest, at one level, ids from 0.
std::vector<ParticleState> filled(const Scene& scene, const SimulationOptions& options, int level);
/// base::Error for what the solver could not hold: levels that do not exist and, where particles split and
/// merge, ids that repeat or reach the capacity.
void check_start(const std::vector<ParticleState>& start, int capacity, bool adaptive);
/// The finest and the coarsest level of the particles; `level` twice when there are none.
std::pair<int, int> levels_of(const std::vector<ParticleState>& start, int level);
/// Particles of a start, in columns that have room for them, and the mass units that they make.
void put_in(FluidState& state, const std::vector<ParticleState>& start);
/// Temperatures of the water as frame 0 begins, by the scene's boxes, and an empty ledger of heat; nothing
/// where no stage calls for them.
void warm_up(FluidState& state, const Scene& scene);
/// Places and velocities of particles that are there, by id. base::Error for an id that nobody has.
void put_again(FluidState& state, const std::vector<ParticleState>& particles);
/// The scene's jets as they stand before `frame`.
void begin_jets(FluidState& state, const Scene& scene, const SimulationOptions& options,
                const Resolution& resolution, int frame);
/// base::Error when foam's particles are so small that a frame may make more than an int counts.
void check_foam(const FluidState& state, const EffectCoefficients& effects, const Scene& scene,
                double frame_dt_s);
/// The pool of the scene's foam, with nobody in it.
void begin_foam(FluidState& state, const Scene& scene);
/// What the effects keep, after others than before are in force: with these columns, and with the memory of
/// those alone that the scene lists. What stays keeps its values.
void exchange_effects(FluidState& state, const Scene& scene, ColumnSet columns);
/// Lets the water come to rest, at one level and behind the gate where there is one; the walls are the tank's
/// then. base::Error when a particle was not finite.
void settle(FluidState& state, const Scene& scene, const SimulationOptions& options);
/// Position-only density projections, at most `most`, until the mass-weighted mean of max(rho / rho_0 - 1, 0)
/// is below 1 %. Velocities stay.
RelaxedStart relax_start(FluidState& state, int most);
/// V^n and E^n of temporal acceleration from the present particles, as the frame before would have left them.
/// Call after relax_start: spray is told by its density.
void start_velocity_grid(FluidState& state);
/// Both, of a start in the middle of a run; what the guards met meanwhile does not count.
RelaxedStart prepare_start(FluidState& state, int most);

}  // namespace sim::SIM_BACKEND
