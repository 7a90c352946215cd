#include "libsim/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Begin {
  const std::uint8_t* level;
  std::uint8_t* target;
  std::uint8_t* history;
  std::uint8_t* age;
  std::uint8_t* waiting;
  SIM_FN void operator()(int i) const {
    target[i] = level[i];
    history[i] = steady_history(level[i]);
    age[i] = 255;
    waiting[i] = 0;
  }
};

struct Force {
  const Vec4* position;
  std::uint8_t* target;
  TargetSphere sphere;
  int coarsest;
  SIM_FN void operator()(int i) const {
    const Vec3 offset = xyz(position[i]) - sphere.centre;
    const bool inside = dot(offset, offset) <= sphere.radius * sphere.radius;
    const int wish = inside ? sphere.inside : sphere.outside;
    target[i] = static_cast<std::uint8_t>(wish < coarsest ? wish : coarsest);
  }
};

/// Keeps the level of those that are not far enough beyond the border to a coarser one.
struct Hold {
  const std::uint8_t* level;
  const float* saliency;
  std::uint8_t* target;
  float levels, dead_band;
  SIM_FN void operator()(int i) const {
    if (target[i] <= level[i]) return;
    const float border = static_cast<float>(level[i] + 1) + dead_band;
    if (levels * (1 - saliency[i]) < border) target[i] = level[i];
  }
};

/// l_i <= min_j l_j + 1 over the neighbours: one sweep carries a step one support radius far.
struct Grade {
  const Vec4* position;
  const std::uint8_t* target;
  ParticleNeighbours neighbours;
  std::uint8_t* out;
  SIM_FN void operator()(int i) const {
    int wish = target[i];
    const Vec4 self = position[i];
    const int count = wish > 1 ? neighbours.size(i) : 0;  // 0 and 1 are never too coarse
    for (int k = 0; k < count; ++k) {
      const int j = neighbours(i, k);
      if (target[j] + 1 >= wish) continue;
      const Vec4 other = position[j];
      const Vec3 offset = xyz(self) - xyz(other);
      const float h = 0.5f * (self.w + other.w);
      if (dot(offset, offset) < h * h) wish = target[j] + 1;
    }
    out[i] = static_cast<std::uint8_t>(wish);
  }
};

/// A step of three levels needs three sweeps.
constexpr int sweeps = 3;

void grade(FluidState& state) {
  auto& p = state.particles;
  auto& out = state.levels.graded;
  const auto& rules = state.levels.rules;
  if (rules.dead_band > 0 && p.has(Column::Saliency)) {
    for_each("hold levels", p.size(),
             Hold{p.level.data(), p.saliency.data(), p.target.data(), static_cast<float>(rules.coarsest + 1),
                  rules.dead_band});
  }
  if (!state.levels.rules.graded) return;
  out.reserve(static_cast<std::size_t>(p.capacity()));
  out.resize(static_cast<std::size_t>(p.size()));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for_each("grade targets", p.size(),
             Grade{p.position.data(), p.target.data(), state.particle_neighbours(), out.data()});
    p.target.swap(out);
  }
}

}  // namespace

void LevelState::begin(Particles& particles) {
  counts.resize(1);
  counts.zero();
  for_each("begin levels", particles.size(),
           Begin{particles.level.data(), particles.target.data(), particles.history.data(),
                 particles.age.data(), particles.waiting.data()});
}

Stage frame_neighbours_stage() {
  return {"frame neighbours",
          "neighbour list at the frame's start",
          Phase::FrameStart,
          columns(Column::Position, Column::Velocity, Column::Id, Column::Level),
          columns(Column::Predicted, Column::Neighbours),
          [](const Demand& demand) -> std::string {  // Saliency finds them itself.
            return demand.levels && !demand.saliency ? "levels compare neighbours" : "";
          },
          [](FluidState& state) {
            if (state.lists_hold) return;
            auto& p = state.particles;
            copy_within(p.predicted.data(), p.position.data(), p.position.size() * sizeof(Vec4));
            neighbours_stage().run(state);
          },
          Part::Levels};
}

Stage forced_targets_stage() {
  return {
      "forced targets",
      "a test's levels",
      Phase::FrameStart,
      columns(Column::Position),
      columns(Column::Target),
      [](const Demand& demand) -> std::string { return demand.forced_targets ? "a test gives them" : ""; },
      [](FluidState& state) {
        auto& p = state.particles;
        for_each("force targets", p.size(),
                 Force{p.position.data(), p.target.data(), state.levels.forced, state.levels.rules.coarsest});
      },
      Part::Levels};
}

Stage graded_targets_stage() {
  return {
      "graded targets",
      "neighbours differ by one level at most",
      Phase::FrameStart,
      columns(Column::Position, Column::Target, Column::Neighbours),
      columns(Column::Target),
      [](const Demand& demand) -> std::string { return demand.levels ? "particles split and merge" : ""; },
      grade,
      Part::Levels};
}

}  // namespace sim::SIM_BACKEND
