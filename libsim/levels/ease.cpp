#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Lists belong to slots; who is not solved has nothing to ease.
template <class Selection>
struct Ease {
  Selection select;
  const Vec4* predicted;
  const std::uint8_t* age;
  Neighbours neighbours;
  float* ease;
  LevelRules rules;
  SIM_FN void operator()(int slot) const {
    const int i = select(slot);
    if constexpr (!Selection::everyone) {
      if (i < 0) {
        ease[~i] = 1;
        return;
      }
    }
    int youngest = age[i];
    const Vec4 self = predicted[i];
    for (int k = 0; k < neighbours.size(slot); ++k) {
      const int j = neighbours(slot, k);
      if (age[j] >= LevelRules::ease_frames || age[j] >= youngest) continue;
      const Vec4 other = predicted[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      if (dot(offset, offset) < h * h) youngest = age[j];
    }
    ease[i] = youngest < LevelRules::ease_frames ? rules.ease[youngest] : 1;
  }
};

struct Apply {
  float* lambda;
  const float* ease;
  SIM_FN void operator()(int i) const { lambda[i] *= ease[i]; }
};

template <class Selection>
void launch(FluidState& state, Selection select) {
  auto& p = state.particles;
  for_each("ease", p.size(),
           Ease<Selection>{select, p.predicted.data(), p.age.data(), state.neighbours.view(), p.ease.data(),
                           state.levels.rules});
}

}  // namespace

Stage ease_stage() {
  return {
      "ease",
      "blending of the constraint, after Orthmann and Kolb 2012",
      Phase::Substep,
      columns(Column::Predicted, Column::Age, Column::Neighbours),
      columns(Column::Ease),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      [](FluidState& state) {
        state.all_active ? launch(state, AllParticles{}) : launch(state, state.active());
      }};
}

Stage eased_constraint_stage() {
  return {
      "eased constraint",
      "blending of the constraint, after Orthmann and Kolb 2012",
      Phase::Iteration,
      columns(Column::Lambda, Column::Ease),
      columns(Column::Lambda),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      [](FluidState& state) {
        auto& p = state.particles;
        for_each("ease constraint", p.size(), Apply{p.lambda.data(), p.ease.data()});
      }};
}

}  // namespace sim::SIM_BACKEND
