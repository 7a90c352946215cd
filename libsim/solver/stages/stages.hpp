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

/// What a scene, a method and the requested outputs require.
struct Demand {
  SolverParameters parameters;
  std::vector<Effect> effects;    ///< that the scene lists
  int finest_level = 0;           ///< of all water that may be present: effects of finer levels are idle
  bool nozzles = false;           ///< the scene has one
  bool outlets = false;           ///< the scene has one
  bool narrow_outlets = false;    ///< of which one is narrower than two spacings of the coarsest particles
  bool moving_obstacles = false;  ///< the scene has one that moves along a given path
  bool free_obstacles = false;    ///< the scene has one that is moved by the water
  bool obstacles_meet = false;    ///< a free obstacle may meet another, or has friction
  bool settling = false;          ///< the gate is closed and the water comes to rest
  bool levels = false;            ///< particles split and merge
  bool forced_targets = false;    ///< a test gives their targets
  bool gaze_targets = false;      ///< targets follow the gaze alone
  bool saliency = false;          ///< targets follow saliency
  bool saliency_parts = false;    ///< an output needs the parts of saliency
  bool activation = false;        ///< temporal acceleration selects the solved particles
  bool wall_impulse = false;      ///< an output needs the walls' impulse on the water
};

/// True if the scene lists the effect with a coefficient, and not only for levels finer than all water.
inline bool acts(const Demand& demand, EffectKind kind) {
  return std::any_of(demand.effects.begin(), demand.effects.end(), [&](const Effect& effect) {
    return effect.kind == kind && effect.coefficient != 0 &&
           !is_idle(effect, demand.effects, demand.finest_level);
  });
}

enum class Phase { FrameStart, Substep, Iteration, SubstepEnd, FrameEnd };

/// Sums over neighbours that a stage computes, for stages that can share a loop (SharedLoop).
enum class SharedTerm { None, SurfaceNormals, Curl, Conduction };

struct Stage {
  const char* name;
  const char* source = "";  ///< paper and equation
  Phase phase;
  /// Returns the reason why the stage is required, or an empty string. An effect's stage needs no such
  /// function; with one it runs only if the function also requires it.
  std::string (*called_for)(const Demand&) = nullptr;
  Part part = Part::Solve;
  /// How its change of the water's momentum is booked; each stage that writes velocities has one.
  Change changes = Change::None;
  EffectKind effect = no_effect;  ///< the effect that alone requires the stage
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

/// Thick fluid must feel its viscosity before the forces have moved it.
inline std::string if_thick(const Demand& demand) {
  return acts(demand, EffectKind::Viscosity) ? "viscosity acts before the particles move" : "";
}

/// Moves the lowest water of the corner columns into the jets.
Stage nozzle_stage();
/// Saliency and target levels from the eyes, the last picture and the fluid.
Stage saliency_stage();
/// The parts of saliency, for an output.
Stage saliency_parts_stage();
/// Target levels from the gaze alone.
Stage gaze_targets_stage();
/// Neighbour list at the frame's start, for stages that read the fluid before it moves.
Stage frame_neighbours_stage();
/// Targets of tests (LevelState::forced).
Stage forced_targets_stage();
/// Limits targets near narrow outlets to levels that fit through them.
Stage opening_targets_stage();
/// Limits targets of neighbours to differ by at most one level.
Stage graded_targets_stage();
/// Algorithms 1 and 2; changes the number of particles and invalidates the neighbour list.
Stage split_and_merge_stage();
/// Moves moving obstacles to their positions at the substep's end.
Stage obstacles_stage();
/// Moves free obstacles that meet only walls, without friction.
Stage bodies_move_stage();
/// Moves free obstacles, and keeps them apart from others.
Stage bodies_meet_stage();
/// Applies what the water gave the free obstacles.
Stage bodies_pushed_stage();
/// Forces alone, without a move, for the effect viscosity, which comes next; with quarantine and speed limit.
Stage forces_stage();
/// Neighbours at the positions that the forces found, for the same effect.
Stage present_neighbours_stage();
/// Forces, unless they have acted, and the explicit step to predicted positions; speed limit; quarantine of
/// non-finite particles.
Stage predict_stage();
/// Grid and combined neighbour list at the predicted positions.
Stage neighbours_stage();
/// Share of the constraint near fresh particles.
Stage ease_stage();
/// The low-frequency part of the pressure, solved on cells and applied first.
Stage coarse_pressure_stage();
/// Removes compression that existed before the substep, without adding velocity.
Stage pre_stabilisation_stage();
/// Separates particles that overlap after a split or a merge, without adding velocity.
Stage parting_stage();
/// Density, unilateral constraint and its multiplier lambda, times the shares of ease_stage.
Stage density_stage();
/// Position correction, which conserves momentum exactly, and wall projection.
Stage displacement_stage();
/// Accounts of what the walls give the water: holding back, missing density, pressure of cells.
Stage held_at_walls_stage();
Stage missing_density_stage();
Stage wall_cells_stage();
/// Velocity from the positions.
Stage velocity_stage();
/// XSPH viscosity.
Stage xsph_stage();
/// The same for methods that split and merge: fresh particles are damped among their neighbours.
Stage xsph_of_levels_stage();
/// Velocity x 0.9 per frame while the water settles.
Stage settling_stage();
/// Random steps of thick fluid; one of viscosity's stages.
Stage loosening_stage();

/// Removes particles that passed an outlet; last in a frame.
Stage outflow_stage();

/// Selects the particles that the frame solves.
Stage activation_stage();
/// Velocity and energy grids; unsolved particles inherit from them.
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
/// Densities and multipliers at the predicted positions of the particles that the frame solves.
void constrain_density(FluidState& state, DensityView particles);
/// The same for all particles outside the schedule, with lists that belong to slots.
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
/// Shifts the predicted positions by the pressure on cells.
void press(FluidState& state, CoarsePressureView particles);

/// The forces that move free obstacles in the present substep.
BodyDrive body_drive(FluidState& state);

// For the momentum account of the walls. While it records, kernels skip the clamp at the walls; a separate
// pass applies and records it.

/// Minimum distance to a wall that kernels enforce, as a share of d; none while the account records.
float gap_of_kernels(const FluidState& state);
using ClampView = ColumnView<ColumnSet{}, columns(Column::Predicted, Column::PredictedNext)>;
/// Applies the clamp that kernels skipped; does nothing unless an account records. `from`: positions before
/// the step. `times`: as in WallRecord. `in_both`: also write PredictedNext.
void clamp_and_listen(FluidState& state, ClampView particles, const Vec4* from, float times, bool in_both);
/// Ends the coarse pressure's push from Predicted to PredictedNext: gives the water the walls' share, and
/// stops it at the walls. Afterwards both hold the same positions.
void balance_push(FluidState& state, ClampView particles);
/// Weight of a push of this projection, including the shares of it that later projections repeat as
/// momentum steps.
float times_taken(const SolverParameters& parameters, int iteration);

/// The two halves of one projection of a few particles. The others need lambda = 0 and equal positions in
/// both buffers.
void constrain_density(FluidState& state, DensityView particles, Listed<AllParticles> few);
void constrain_density(FluidState& state, DensityView particles, Listed<ActiveParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<AllParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<ActiveParticles> few);

/// Saliency of the present state for an output, for any method: `observer` has the eyes. Permutes the columns
/// and fills the given arrays in the new order.
void measure_saliency(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                      Array<std::uint8_t>& target, Array<SaliencyParts>& parts);
/// The same from the gaze alone, in the present order.
void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target);

/// A stage that combines two: its loop computes the sums of both.
struct SharedLoop {
  SharedTerm first, second;
  Stage stage;
};
std::vector<SharedLoop> shared_loops();

/// All stages in the fixed order in which a schedule may call them.
std::vector<Stage> all_stages();

}  // namespace sim::SIM_BACKEND
