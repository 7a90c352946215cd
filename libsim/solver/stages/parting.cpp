#include "libsim/solver/stages/stages.hpp"

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

using Columns = ColumnView<columns(Column::Predicted, Column::Ease, Column::Neighbours, Column::Id),
                           columns(Column::Predicted, Column::PredictedNext, Column::Position,
                                   Column::VelocityNext, Column::Lambda, Column::Density)>;

/// Parts at the substep's beginning: what is dense there is overlap, while on its way water is compressed
/// too.
template <class Selection>
void launch(FluidState& state, Columns p, Selection select) {
  const auto& rules = state.levels.rules;
  p.copy<Column::VelocityNext, Column::Predicted>();
  p.copy<Column::Predicted, Column::Position>();
  p.copy<Column::PredictedNext, Column::Position>();
  p.zero<Column::Lambda>();
  const BesideFresh<Selection> fresh{select, p.ease(), rules.ease[0]};
  for (int k = 0; k < rules.partings; ++k) {
    constrain_density(state, p, fresh);
    displace(state, p, fresh);
  }
  for_each("follow parting", p.size(),
           Follow{.parted = p.predicted(),
                  .led_to = p.velocity_next(),
                  .position = p.position(),
                  .predicted = p.predicted(),
                  .predicted_next = p.predicted_next()});
}

void run(FluidState& state, Columns p) {
  // The frame's first substep has the fresh particles; most frames of water at rest have none.
  if (!state.levels.changed || state.substep > 0) return;
  state.all_active ? launch(state, p, AllParticles{}) : launch(state, p, state.active());
}

}  // namespace

Stage parting_stage() {
  return stage_of<run>({.name = "parting",
                        .source = "pre-stabilisation, Macklin et al. 2014, 4.4",
                        .phase = Phase::Substep,
                        .called_for = if_levels});
}

}  // namespace sim::SIM_BACKEND
