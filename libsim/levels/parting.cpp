#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Moves by what parted them, at the substep's beginning and where the substep leads, so that no velocity
/// comes of it.
struct Follow {
  const Vec4* parted;
  const Vec4* led_to;
  Vec4* position;
  Vec4* predicted;
  Vec4* predicted_next;
  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    const Vec3 to = xyz(led_to[i]) + (xyz(parted[i]) - xyz(at));
    position[i] = with_w(xyz(parted[i]), at.w);
    predicted[i] = with_w(to, at.w);
    predicted_next[i] = predicted[i];
  }
};

/// Parts at the substep's beginning: what is dense there is overlap, while on its way water is compressed
/// too.
template <class Selection>
void launch(FluidState& state, Selection select) {
  auto& p = state.particles;
  const auto& rules = state.levels.rules;
  const auto bytes = static_cast<std::size_t>(p.size()) * sizeof(Vec4);
  Vec4* led_to = p.velocity_next.data();
  copy_within(led_to, p.predicted.data(), bytes);
  copy_within(p.predicted.data(), p.position.data(), bytes);
  copy_within(p.predicted_next.data(), p.position.data(), bytes);
  p.lambda.zero();
  const BesideFresh<Selection> fresh{select, p.ease.data(), rules.ease[0]};
  for (int k = 0; k < rules.partings; ++k) {
    measure_density(state, fresh);
    displace(state, fresh);
  }
  for_each(
      "follow parting", p.size(),
      Follow{p.predicted.data(), led_to, p.position.data(), p.predicted.data(), p.predicted_next.data()});
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
