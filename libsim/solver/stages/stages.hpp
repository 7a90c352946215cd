#pragma once
/// The stages of the solver, one source file each, and what they lend to each other.

#include <vector>

#include "libsim/particles/body_drive.hpp"
#include "libsim/solver/stages/stage.hpp"

namespace sim::SIM_BACKEND {

/// Moves the lowest water of the corner columns into the jets.
Stage nozzle_stage();
/// Saliency and target levels from the eyes, the last picture and the fluid.
Stage saliency_stage();
/// What saliency is made of, for an output.
Stage saliency_parts_stage();
/// Target levels from the gaze alone.
Stage gaze_targets_stage();
/// Neighbour list at the frame's start, for what looks at the fluid before it moves.
Stage frame_neighbours_stage();
/// Targets of tests (LevelState::forced).
Stage forced_targets_stage();
/// Targets of neighbours differ by one level at most.
Stage graded_targets_stage();
/// Algorithms 1 and 2; changes the number of particles and makes the neighbour list stale.
Stage split_and_merge_stage();
/// Brings moving obstacles to their places at the substep's end.
Stage obstacles_stage();
/// Moves an obstacle that is free and meets walls alone, which are smooth.
Stage bodies_move_stage();
/// Moves obstacles that are free, and holds them apart from others.
Stage bodies_meet_stage();
/// Takes what the water gave them.
Stage bodies_pushed_stage();
/// Gravity and the explicit step to predicted positions; speed limit; quarantine of what is not finite.
Stage predict_stage();
/// Grid and combined neighbour list at the predicted positions.
Stage neighbours_stage();
/// Shares of the constraint round fresh particles.
Stage ease_stage();
/// The slow part of the pressure, solved on cells and applied first.
Stage coarse_pressure_stage();
/// Takes compression away that was there before the substep, without giving it speed.
Stage pre_stabilisation_stage();
/// Parts what overlaps after a split or a merge, without giving it speed.
Stage parting_stage();
/// Density, unilateral constraint and its multiplier lambda, times these shares.
Stage density_stage();
/// Position correction, momentum-exact, and wall projection.
Stage displacement_stage();
/// Accounts of what the walls give: holding back, missing density, pressure of cells.
Stage held_at_walls_stage();
Stage missing_density_stage();
Stage wall_cells_stage();
/// Velocity from the positions.
Stage velocity_stage();
/// XSPH viscosity.
Stage xsph_stage();
/// The same for methods that split and merge: fresh particles come to rest among their neighbours.
Stage xsph_of_levels_stage();
/// Velocity x 0.9 a frame while the water settles.
Stage settling_stage();

/// What is through an outlet leaves; last in a frame.
Stage outflow_stage();

/// Which particles the frame solves.
Stage activation_stage();
/// Velocity and energy grids; what was not solved inherits from them.
Stage velocity_grid_stage();

// Passes that others borrow. Each says which columns it touches; a caller that does not declare them does not
// compile.

using NeighboursView =
    ColumnView<columns(Column::Predicted, Column::Position, Column::Velocity, Column::Id, Column::Level),
               columns(Column::Neighbours)>;
/// Sorts the particles by the grid's cells at their predicted positions, and lists everyone's neighbours
/// there.
void find_neighbours(FluidState& state, NeighboursView particles);

using DensityView =
    ColumnView<columns(Column::Predicted, Column::Neighbours), columns(Column::Lambda, Column::Density)>;
/// Densities and multipliers at the predicted positions of those whom the frame solves.
void constrain_density(FluidState& state, DensityView particles);
/// The same of everyone outside the schedule, over lists that belong to slots.
void constrain_density(FluidState& state, DensityView particles, EverySlot everyone);

using DisplacementView =
    ColumnView<columns(Column::Predicted, Column::Lambda, Column::Neighbours, Column::Id),
               columns(Column::PredictedNext, Column::Predicted)>;
/// Moves those whom the frame solves by their multipliers.
void displace(FluidState& state, DisplacementView particles);

using CoarsePressureView =
    ColumnView<columns(Column::Predicted, Column::Neighbours, Column::Id),
               columns(Column::Lambda, Column::Density, Column::PredictedNext, Column::Predicted),
               columns(Column::Ease)>;
/// Shifts the predicted positions by the pressure on cells.
void press(FluidState& state, CoarsePressureView particles);

/// What moves free obstacles in the present substep.
BodyDrive body_drive(FluidState& state);

// For the momentum account of the walls. While it records, kernels leave the clamp at the walls to a pass of
// its own, which records what it does.

/// Smallest distance to a wall that kernels keep, as a share of d; none while the account records.
float gap_of_kernels(const FluidState& state);
using ClampView = ColumnView<ColumnSet{}, columns(Column::Predicted, Column::PredictedNext)>;
/// The clamp that kernels left out; does nothing while no account records. `from`: positions before the step.
/// `times`: as in WallListener. `in_both`: PredictedNext holds the same places afterwards.
void clamp_and_listen(FluidState& state, ClampView particles, const Vec4* from, float times, bool in_both);
/// Ends the coarse pressure's push from Predicted to PredictedNext: it gives the water what the walls gave,
/// and stops at the walls. Both hold the places then.
void balance_push(FluidState& state, ClampView particles);
/// Weight of a push of this projection, including the shares of it that later projections repeat as
/// momentum steps.
float times_taken(const SolverParameters& parameters, int iteration);

/// The two halves of one projection of a few. The others need lambda = 0 and the same
/// place in both buffers.
void constrain_density(FluidState& state, DensityView particles, Listed<AllParticles> few);
void constrain_density(FluidState& state, DensityView particles, Listed<ActiveParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<AllParticles> few);
void displace(FluidState& state, DisplacementView particles, Listed<ActiveParticles> few);

/// Saliency of the present state for an output, in whatever method: `observer` has the eyes. Permutes the
/// columns and fills the given ones in the new order.
void measure_saliency(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                      Array<std::uint8_t>& target, Array<SaliencyParts>& parts);
/// The same from the gaze alone, in the present order.
void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target);

/// Two stages in one: its loop finds the sums of both.
struct SharedLoop {
  SharedTerm first, second;
  Stage stage;
};
std::vector<SharedLoop> shared_loops();

/// All stages in the fixed order in which a schedule may call them.
std::vector<Stage> all_stages();

}  // namespace sim::SIM_BACKEND
