#pragma once
/// The stages of the solver and the passes that they share. A stage is data, and a function that accesses
/// only the columns it declares.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// Requirements on the schedule by a scene, a method and the requested outputs.
struct Demand {
  SolverParameters parameters;
  std::vector<Effect> effects;    ///< effects that the scene lists
  int finest_level = 0;           ///< finest level of water that may be present
  bool nozzles = false;           ///< the scene has a nozzle
  bool outlets = false;           ///< the scene has an outlet
  bool narrow_outlets = false;    ///< an outlet is narrower than two spacings of the coarsest particles
  bool moving_obstacles = false;  ///< an obstacle moves along a given path
  bool free_obstacles = false;    ///< an obstacle is moved by the water
  bool obstacles_meet = false;    ///< a free obstacle may meet another, or has friction
  bool settling = false;          ///< the water comes to rest before frame 0, behind the gate if there is one
  bool levels = false;            ///< particles split and merge
  bool rests_by_drift = false;    ///< water of one level rests by its mean motion
  bool forced_targets = false;    ///< a test gives the target levels
  bool gaze_targets = false;      ///< saliency and targets are computed from the gaze alone
  bool saliency = false;          ///< saliency and targets are computed by ViP-Fluid, Eq. 1-9
  bool saliency_parts = false;    ///< an output needs the parts of saliency
  bool activation = false;        ///< temporal acceleration selects the solved particles
  /// The effect because of which there is no activation, although the method accelerates in time: effects
  /// other than foam change velocities in every substep, so that no particle may rest.
  EffectKind keeps_all_solved = no_effect;
  bool wall_impulse = false;  ///< an output needs the walls' impulse on the water
};

/// True if the scene lists the effect with a coefficient other than 0, and its water may have a level on
/// which the effect acts.
inline bool acts(const Demand& demand, EffectKind kind) {
  return std::any_of(demand.effects.begin(), demand.effects.end(), [&](const Effect& effect) {
    return effect.kind == kind && effect.coefficient != 0 &&
           !is_idle(effect, demand.effects, demand.finest_level);
  });
}

enum class Phase { FrameStart, Substep, Iteration, SubstepEnd, FrameEnd };

/// The sum over neighbours that a stage computes. Stages with certain pairs of sums can share a loop
/// (SharedLoop).
enum class SharedTerm { None, SurfaceNormals, Curl, Conduction };

struct Stage {
  const char* name;
  const char* source = "";  ///< paper and equation that the stage follows
  Phase phase;
  /// Returns the reason why the stage is required, or an empty string. An effect's stage needs no such
  /// function; with one it runs only if the function also requires it.
  std::string (*called_for)(const Demand&) = nullptr;
  Part part = Part::Solve;
  /// Entry of the momentum account that records the stage's change of the water's momentum. None: the change
  /// is counted in the entry of the next stage that has one.
  Change changes = Change::None;
  EffectKind effect = no_effect;  ///< the effect to which the stage belongs, if any
  SharedTerm loop = SharedTerm::None;
  std::size_t place = 0;  ///< index among the passes of a schedule, set by the schedule
  // Set by stage_of from the function's view:
  ColumnSet reads = {}, writes = {};
  void (*run)(FluidState&) = nullptr;
};

namespace stage_detail {
template <class View>
View view_of(void (*)(FluidState&, View));
}

/// The stage that runs `function`, a void(FluidState&, ColumnView<...>): the stage declares the columns that
/// the view declares.
template <auto function>
Stage stage_of(Stage stage) {
  using View = decltype(stage_detail::view_of(function));
  stage.reads = View::reads;
  stage.writes = View::writes;
  stage.run = [](FluidState& state) { function(state, View(state.particles)); };
  return stage;
}

// Reasons shared by several stages.
inline std::string always_moves(const Demand&) { return "every method moves its particles"; }
inline std::string keeps_density(const Demand&) { return "every method keeps the density"; }
inline std::string if_levels(const Demand& demand) {
  return demand.levels ? "particles split and merge" : "";
}
inline std::string if_wall_impulse(const Demand& demand) {
  return demand.wall_impulse ? "the walls' impulse is asked for" : "";
}
inline std::string if_pushes(const Demand& demand) {
  const std::string asked = if_wall_impulse(demand);
  return asked.empty() && demand.free_obstacles ? "an obstacle is free" : asked;
}
inline std::string if_activation(const Demand& demand) {
  return demand.activation && !demand.settling ? "the method accelerates in time" : "";
}

/// Reason for the stages that prepare the effect viscosity (forces, present neighbours). They are needed
/// because this effect acts on the velocities before the particles move.
inline std::string if_thick(const Demand& demand) {
  return acts(demand, EffectKind::Viscosity) ? "viscosity acts before the particles move" : "";
}

/// Takes water in the tank's four corners, the lowest first, and pours it from the nozzles.
Stage nozzle_stage();
/// Computes saliency and target levels from the eyes, the last picture and the fluid.
Stage saliency_stage();
/// Stores the parts of saliency (f_a, f_m, f_T and F of ViP-Fluid) for an output.
Stage saliency_parts_stage();
/// Computes target levels from the gaze alone.
Stage gaze_targets_stage();
/// Lists neighbours at the frame's start, for stages that read the fluid before it moves.
Stage frame_neighbours_stage();
/// Sets the target levels that a test prescribes (LevelState::forced).
Stage forced_targets_stage();
/// Limits targets near narrow outlets to levels that fit through them.
Stage opening_targets_stage();
/// Applies the dead band (LevelRules::dead_band) to the targets; then, if LevelRules::graded, limits the
/// difference between targets of neighbours to one level.
Stage graded_targets_stage();
/// Splits and merges particles (ViP-Fluid, Algorithms 1 and 2). This changes the number of particles and
/// invalidates the neighbour list.
Stage split_and_merge_stage();
/// Moves moving obstacles to their positions at the substep's end.
Stage obstacles_stage();
/// Moves free obstacles that can touch only walls and have no friction.
Stage bodies_move_stage();
/// Moves free obstacles that may touch other obstacles or have friction, and computes their contacts.
Stage bodies_meet_stage();
/// Updates the forces on free obstacles from the water's push in the substep.
Stage bodies_pushed_stage();
/// Resets particles whose position or velocity is lost (not finite, or far outside the tank), and changes the
/// velocities of all particles by the forces and the speed limit; the effect viscosity acts next.
Stage forces_stage();
/// Lists neighbours at the positions before the substep's move, for the effect viscosity.
Stage present_neighbours_stage();
/// Resets lost particles, and applies the forces (unless forces_stage did so in this substep) and the speed
/// limit, like forces_stage. Then moves the particles by one explicit step to their predicted positions.
Stage predict_stage();
/// Builds the grid and the neighbour lists at the predicted positions.
Stage neighbours_stage();
/// Computes the share of its density constraint that each particle enforces: below 1 near particles that just
/// split or merged.
Stage ease_stage();
/// The low-frequency part of the pressure, solved on cells and applied before the projections.
Stage coarse_pressure_stage();
/// Removes compression that existed before a frame's first substep, without adding velocity.
Stage pre_stabilisation_stage();
/// Separates particles that overlap after a split or a merge, without adding velocity.
Stage parting_stage();
/// Computes the density and the multiplier lambda of the unilateral density constraint; lambda is multiplied
/// by the share that ease_stage computes.
Stage density_stage();
/// Moves particles by their multipliers, and back inside the walls. The pair terms conserve momentum exactly.
/// Pushes close pairs apart, and moves their Position too.
Stage displacement_stage();
/// held_at_walls_stage, missing_density_stage and wall_cells_stage record the momentum that walls and
/// obstacles give the water: by holding particles back, by their share in the density constraint, and by the
/// coarse pressure on cells, in this order.
Stage held_at_walls_stage();
Stage missing_density_stage();
Stage wall_cells_stage();
/// Saves the positions before the projections, which the velocities after a rest of one substep need.
Stage before_projections_stage();
/// Computes the velocities from the predicted positions.
Stage velocity_stage();
/// XSPH viscosity.
Stage xsph_stage();
Stage xsph_of_short_steps_stage();
/// XSPH viscosity for methods that split and merge, with a filter of velocity changes near particles that
/// just split or merged.
Stage xsph_of_levels_stage();
/// Multiplies velocities by 0.9 per frame while the water settles.
Stage settling_stage();
/// Moves the particles of thick fluid by random steps; a stage of the effect viscosity.
Stage loosening_stage();

/// Removes particles that passed an outlet; last in a frame.
Stage outflow_stage();

/// Selects the particles that the frame solves.
Stage activation_stage();
/// Updates the grids of mean velocity and kinetic energy, and sets the velocities of unsolved particles from
/// those of the solved particles in their cells.
Stage velocity_grid_stage();

// Passes that other stages reuse. Each declares the columns it touches; a caller that does not declare them
// does not compile.

using NeighboursView =
    ColumnView<columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id, Column::Level),
               columns(Column::Neighbours)>;
/// Sorts the particles by the grid's cells at their predicted positions, and lists all particles' neighbours.
void find_neighbours(FluidState& state, NeighboursView particles);

using DensityView =
    ColumnView<columns(Column::Predicted, Column::Neighbours), columns(Column::Lambda, Column::Density)>;
/// Computes densities and multipliers at the predicted positions of the particles that the frame solves.
void constrain_density(FluidState& state, DensityView particles);
/// Computes densities and multipliers of all particles, solved or not; needs lists that are indexed by slots
/// (particles/selection.hpp).
void constrain_density(FluidState& state, DensityView particles, EverySlot everyone);

using DisplacementView =
    ColumnView<columns(Column::Predicted, Column::Lambda, Column::Neighbours, Column::Id),
               columns(Column::PredictedNext, Column::Predicted)>;
/// Moves the particles that the frame solves by their multipliers.
void displace(FluidState& state, DisplacementView particles);

using CoarsePressureView =
    ColumnView<columns(Column::Predicted, Column::Neighbours, Column::Id),
               columns(Column::Lambda, Column::Density, Column::PredictedNext, Column::Predicted),
               columns(Column::Ease)>;
/// Moves the predicted positions by the coarse pressure.
void press(FluidState& state, CoarsePressureView particles);

/// The forces that move free obstacles in the present substep.
BodyDrive body_drive(FluidState& state);

// For the momentum account of the walls: while it records, kernels skip the clamp at the walls, and
// clamp_and_listen() applies and records the clamp.

/// Minimum distance to a wall that kernels enforce, as a share of the particle's spacing. While the account
/// records, -1e30: kernels then enforce no distance.
float gap_of_kernels(const FluidState& state);
using ClampView = ColumnView<ColumnSet{}, columns(Column::Predicted, Column::PredictedNext)>;
/// Applies the clamp that kernels skipped; does nothing unless an account records. `from`: positions before
/// the step. `times`: factor on the recorded pushes (times_taken). `in_both`: also write PredictedNext.
void clamp_and_listen(FluidState& state, ClampView particles, const Vec4* from, float times, bool in_both);
/// Corrects the coarse pressure's move from Predicted to PredictedNext, so that its total equals the push of
/// walls and obstacles, and stops particles at the walls. Afterwards both columns contain the same positions.
void balance_push(FluidState& state, ClampView particles);
/// Factor on a recorded push of this projection: 1 plus the shares of it that the substep's later projections
/// add again, because each repeats the share SolverParameters::momentum of the step before.
float times_taken(const SolverParameters& parameters, int iteration);

/// The two halves of one projection that moves only the particles `few`. All other particles need lambda = 0
/// and equal positions in Predicted and PredictedNext.
void constrain_density(FluidState& state, DensityView particles, Listed<AllParticles> few);
void constrain_density(FluidState& state, DensityView particles, Listed<ActiveParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<AllParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<ActiveParticles> few);

/// Saliency of the present state for an output, for any method, as seen by the eyes that `observer` stores.
/// Permutes the columns and fills the given arrays in the new order.
void measure_saliency(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                      Array<std::uint8_t>& target, Array<SaliencyParts>& parts);
/// Saliency and targets from the gaze alone, in the present order.
void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target);

/// A stage that replaces two stages: one loop over neighbours computes the sums of both.
struct SharedLoop {
  SharedTerm first, second;
  Stage stage;
};
std::vector<SharedLoop> shared_loops();

/// All stages in the fixed order in which a schedule may call them.
std::vector<Stage> all_stages();

}  // namespace sim::SIM_BACKEND
