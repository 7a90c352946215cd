#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// What parted them is moved at the substep's beginning too, so that no velocity comes of it.
template <class Selection>
struct Follow {
  BesideFresh<Selection> fresh;
  const Vec4* before;
  const Vec4* predicted;
  Vec4* position;
  SIM_FN void operator()(int slot) const {
    const int i = fresh(slot);
    if (i < 0) return;
    const Vec4 at = position[i];
    position[i] = with_w(xyz(at) + (xyz(predicted[i]) - xyz(before[i])), at.w);
  }
};

template <class Selection>
void launch(FluidState& state, Selection select) {
  auto& p = state.particles;
  const auto& rules = state.levels.rules;
  const auto bytes = static_cast<std::size_t>(p.size()) * sizeof(Vec4);
  Vec4* before = p.velocity_next.data();
  copy_within(before, p.predicted.data(), bytes);
  copy_within(p.predicted_next.data(), p.predicted.data(), bytes);
  p.lambda.zero();
  const BesideFresh<Selection> fresh{select, p.ease.data(), rules.ease[0]};
  for (int k = 0; k < rules.partings; ++k) {
    measure_density(state, fresh);
    displace(state, fresh);
  }
  for_each("follow parting", p.size(),
           Follow<Selection>{fresh, before, p.predicted.data(), p.position.data()});
}

}  // namespace

Stage parting_stage() {
  return {
      "parting",
      "pre-stabilisation, Macklin et al. 2014, 4.4",
      Phase::Substep,
      columns(Column::Predicted, Column::Ease, Column::Neighbours, Column::Id),
      columns(Column::Predicted, Column::PredictedNext, Column::Position, Column::VelocityNext,
              Column::Lambda, Column::Density),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      [](FluidState& state) {
        // The frame's first substep has the fresh particles; most frames of water at rest have none.
        if (!state.levels.changed || state.substep > 0) return;
        state.all_active ? launch(state, AllParticles{}) : launch(state, state.active());
      }};
}

}  // namespace sim::SIM_BACKEND
