#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

using SurroundingsView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
               columns(Column::Predicted, Column::Neighbours, Column::Lambda, Column::Density)>;

/// The reason for computing saliency, as --explain prints it.
std::string reader(const Demand& demand, const char* of_levels) {
  if (demand.levels) return of_levels;
  return demand.activation ? "the choice of solved particles weighs by it" : "an output asks for it";
}

/// Inputs of saliency; the caller sets the outputs.
SaliencyFluid fluid_of(FluidState& state, SurroundingsView p) {
  return {.position = p.position(),
          .velocity = p.velocity(),
          .density = p.density(),
          .level = p.level(),
          .neighbours = state.particle_neighbours(),
          .n = p.size(),
          .finest_support = state.finest_support,
          .gravity = state.gravity_of_rest(),
          .guards = state.guard()};
}

/// Finds neighbours at the present positions, and densities if requested.
void find_surroundings(FluidState& state, SurroundingsView p, bool densities) {
  p.copy<Column::Predicted, Column::Position>();
  find_neighbours(state, p);
  if (densities) constrain_density(state, p);
}

/// Reuses the last substep's lists and densities if FluidState::lists_hold; otherwise computes both anew. If
/// the last frame did not solve all particles, it computes all densities with the old lists, because the
/// densities of unsolved particles were not measured.
void recall_surroundings(FluidState& state, SurroundingsView p, bool densities) {
  if (!state.lists_hold) {
    find_surroundings(state, p, densities);
  } else if (state.lists_by_slot && densities) {
    p.copy<Column::Predicted, Column::Position>();
    constrain_density(state, p, EverySlot{state.activation.slots.data()});
  }
}

using SaliencyColumns =
    ColumnView<SurroundingsView::reads,
               SurroundingsView::writes | columns(Column::Unrest, Column::Saliency, Column::Target),
               columns(Column::Swirl)>;

void run_saliency(FluidState& state, SaliencyColumns p) {
  if (!state.levels.turns.due) {
    ++state.saliency.frames_since;
    return;
  }
  recall_surroundings(state, p, state.saliency.due() || state.saliency.readings.drop_density > 0);
  SaliencyFluid fluid = fluid_of(state, p);
  fluid.unrest = p.unrest();
  const auto& effects = state.parameters.effects;
  fluid.swirl = {.rate = p.swirl(),
                 .from = effects[EffectOption::VorticityFrom],
                 .weight = effects[EffectOption::VorticitySaliency]};
  fluid.saliency = p.saliency();
  fluid.target = p.target();
  evaluate_saliency(state.saliency, fluid);
}

using PartsView = ColumnView<columns(Column::Position, Column::Unrest), columns(Column::SaliencyParts)>;

void keep_parts(FluidState& state, PartsView p) {
  if (!state.levels.turns.due) return;
  SaliencyState& s = state.saliency;
  combine_features(feature_numbers(s.readings), s.eyes, p.position(), p.unrest(), s.combined.data(),
                   p.saliency_parts(), p.size());
}

}  // namespace

void measure_saliency(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                      Array<std::uint8_t>& target, Array<SaliencyParts>& parts) {
  const SurroundingsView p(state.particles);
  const auto size = static_cast<std::size_t>(p.size());
  saliency.resize(size);
  saliency.zero();
  target.resize(size);
  target.zero();
  parts.resize(size);
  find_surroundings(state, p, true);
  SaliencyFluid fluid = fluid_of(state, p);
  fluid.saliency = saliency.data();
  fluid.target = target.data();
  fluid.parts = parts.data();
  observer.look_around(state.parameters.frame_s());
  evaluate_saliency(observer, fluid);
  state.lists_hold = false;
}

Stage saliency_stage() {
  return stage_of<run_saliency>({.name = "saliency",
                                 .source = "ViP-Fluid 3.2, Eq. 1-9",
                                 .phase = Phase::FrameStart,
                                 .called_for = [](const Demand& demand) -> std::string {
                                   return demand.saliency ? reader(demand, "levels follow what is seen") : "";
                                 },
                                 .part = Part::Saliency});
}

Stage saliency_parts_stage() {
  return stage_of<keep_parts>({.name = "saliency parts",
                               .source = "ViP-Fluid 3.2, f_a, f_m, f_T and F",
                               .phase = Phase::FrameStart,
                               .called_for = [](const Demand& demand) -> std::string {
                                 return demand.saliency && demand.saliency_parts ? "an output asks for them"
                                                                                 : "";
                               },
                               .part = Part::Saliency});
}

namespace {

SaliencyFluid fluid_of(FluidState& state, Reads<Column::Position> p, float* saliency, std::uint8_t* target) {
  return {.position = p.position(),
          .n = p.size(),
          .finest_support = state.finest_support,
          .saliency = saliency,
          .target = target,
          .guards = state.guard()};
}

using GazeTargetsColumns = ColumnView<columns(Column::Position), columns(Column::Saliency, Column::Target)>;

void run_gaze_targets(FluidState& state, GazeTargetsColumns p) {
  if (!state.levels.turns.due) return;
  evaluate_gaze(state.saliency, fluid_of(state, p, p.saliency(), p.target()));
}

}  // namespace

void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target) {
  const auto size = static_cast<std::size_t>(state.particles.size());
  saliency.resize(size);
  target.resize(size);
  const Reads<Column::Position> p(state.particles);
  observer.look_around(state.parameters.frame_s());
  evaluate_gaze(observer, fluid_of(state, p, saliency.data(), target.data()));
}

Stage gaze_targets_stage() {
  return stage_of<run_gaze_targets>({.name = "gaze targets",
                                     .source = "FovFluid-like: fovea, band, periphery",
                                     .phase = Phase::FrameStart,
                                     .called_for = [](const Demand& demand) -> std::string {
                                       return demand.gaze_targets ? reader(demand, "levels follow the gaze")
                                                                  : "";
                                     },
                                     .part = Part::Saliency});
}

}  // namespace sim::SIM_BACKEND
