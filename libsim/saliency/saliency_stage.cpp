#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

SaliencyFluid fluid_of(FluidState& state) {
  auto& p = state.particles;
  const auto& k = state.parameters;
  return {p.position.data(),
          p.velocity.data(),
          p.density.data(),
          p.level.data(),
          state.particle_neighbours(),
          p.size(),
          state.finest_support,
          k.gravity,
          k.dt * static_cast<float>(k.substeps),
          p.unrest.data(),
          p.saliency.data(),
          p.target.data(),
          nullptr,
          state.guard()};
}

/// Neighbours and densities where the particles are now.
void find_surroundings(FluidState& state) {
  auto& p = state.particles;
  copy_within(p.predicted.data(), p.position.data(), p.position.size() * sizeof(Vec4));
  neighbours_stage().run(state);
  density_stage().run(state);
}

/// The same from the last substep, as far as it holds: nobody was listed before the first frame, nor what a
/// nozzle has just moved, and who was not solved has no density of the last frame.
void recall_surroundings(FluidState& state) {
  if (!state.lists_hold) {
    find_surroundings(state);
  } else if (state.lists_by_slot) {
    auto& p = state.particles;
    copy_within(p.predicted.data(), p.position.data(), p.position.size() * sizeof(Vec4));
    measure_density(state, EverySlot{state.activation.slots.data()});
  }
}

}  // namespace

void measure_saliency(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                      Array<std::uint8_t>& target, Array<SaliencyParts>& parts) {
  const auto size = static_cast<std::size_t>(state.particles.size());
  saliency.resize(size);
  saliency.zero();
  target.resize(size);
  target.zero();
  parts.resize(size);
  find_surroundings(state);
  SaliencyFluid fluid = fluid_of(state);
  fluid.unrest = nullptr;
  fluid.saliency = saliency.data();
  fluid.target = target.data();
  fluid.parts = parts.data();
  evaluate_saliency(observer, fluid);
  state.lists_hold = false;
}

void measure_gaze(FluidState& state, SaliencyState& observer, Array<float>& saliency,
                  Array<std::uint8_t>& target) {
  const auto size = static_cast<std::size_t>(state.particles.size());
  saliency.resize(size);
  target.resize(size);
  SaliencyFluid fluid = fluid_of(state);
  fluid.saliency = saliency.data();
  fluid.target = target.data();
  evaluate_gaze(observer, fluid);
}

Stage saliency_stage() {
  return {
      "saliency",
      "ViP-Fluid 3.2, Eq. 1-9",
      Phase::FrameStart,
      columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
      columns(Column::Predicted, Column::Neighbours, Column::Lambda, Column::Density, Column::Unrest,
              Column::Saliency, Column::Target),
      [](const Demand& demand) -> std::string { return demand.saliency ? "levels follow what is seen" : ""; },
      [](FluidState& state) {
        recall_surroundings(state);
        evaluate_saliency(state.saliency, fluid_of(state));
      },
      Part::Saliency};
}

Stage saliency_parts_stage() {
  return {"saliency parts",
          "ViP-Fluid 3.2, f_a, f_m, f_T and F",
          Phase::FrameStart,
          columns(Column::Position, Column::Unrest),
          columns(Column::SaliencyParts),
          [](const Demand& demand) -> std::string {
            return demand.saliency && demand.saliency_parts ? "an output asks for them" : "";
          },
          [](FluidState& state) {
            auto& p = state.particles;
            SaliencyState& s = state.saliency;
            combine_features(feature_numbers(s.readings), s.eyes, p.position.data(), p.unrest.data(),
                             s.combined.data(), p.saliency_parts.data(), p.size());
          },
          Part::Saliency};
}

Stage gaze_targets_stage() {
  return {
      "gaze targets",
      "FovFluid-like: fovea, band, periphery",
      Phase::FrameStart,
      columns(Column::Position),
      columns(Column::Saliency, Column::Target),
      [](const Demand& demand) -> std::string { return demand.gaze_targets ? "levels follow the gaze" : ""; },
      [](FluidState& state) { evaluate_gaze(state.saliency, fluid_of(state)); },
      Part::Saliency};
}

}  // namespace sim::SIM_BACKEND
