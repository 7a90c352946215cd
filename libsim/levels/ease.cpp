#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Ease {
  const Vec4* predicted;
  const std::uint8_t* age;
  Neighbours neighbours;
  float* ease;
  LevelRules rules;
  SIM_FN void operator()(int i) const {
    int youngest = age[i];
    const Vec4 self = predicted[i];
    for (int k = 0; k < neighbours.size(i); ++k) {
      const int j = neighbours(i, k);
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
        auto& p = state.particles;
        for_each("ease", p.size(),
                 Ease{p.predicted.data(), p.age.data(), state.neighbours.view(), p.ease.data(),
                      state.levels.rules});
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
