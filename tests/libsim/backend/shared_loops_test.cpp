/// Loops over neighbours that two effects share, against the two passes alone.

#include <gmock/gmock.h>

#include "libsim/solver/schedule.hpp"
#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Demand demand_of(std::vector<Effect> effects) {
  Demand out;
  out.effects = std::move(effects);
  return out;
}
std::vector<std::string> names_of(const std::vector<Stage>& passes) {
  std::vector<std::string> out;
  for (const Stage& pass : passes) out.emplace_back(pass.name);
  return out;
}

/// own_levels: each effect leaves out different levels, and the
/// particles cycle through the levels.
FluidState warm_ball(bool one_level, bool own_levels) {
  auto state = state_of(one_level ? cube(6, 0.1f) : mixed_ball(), one_level);
  std::vector<float> warmth;
  std::vector<Vec4> velocity;
  for (const Vec4& x : state.particles.all().position.to_host())
    velocity.push_back({std::sin(9 * x.y), std::cos(7 * x.z), std::sin(5 * x.x + x.y), 0});
  state.particles.all().velocity.from_host(velocity);
  for (int i = 0; i < state.particles.size(); ++i) warmth.push_back(static_cast<float>(i * 37 % 11));
  state.particles.all().temperature.from_host(warmth);
  state.parameters.effects = coefficients_of({{EffectKind::Heat, 0.02}});
  if (own_levels) {
    state.supports = level_supports(0.25);
    auto& options = state.parameters.effects.options;
    options[static_cast<std::size_t>(EffectOption::HeatCoarsest)] = 1;
    options[static_cast<std::size_t>(EffectOption::CohesionCoarsest)] = 2;
    options[static_cast<std::size_t>(EffectOption::VorticityCoarsest)] = 0;
  }
  return state;
}

void equals_both(const SharedLoop& loop, bool one_level, bool own_levels = false) {
  auto apart = warm_ball(one_level, own_levels);
  for (const Stage& stage : all_stages())
    if (stage.loop == loop.first || stage.loop == loop.second) stage.run(apart);
  auto together = warm_ball(one_level, own_levels);
  loop.stage.run(together);
  const auto normal = apart.particles.all().normal.to_host();
  const auto warmth = apart.particles.all().temperature.to_host();
  const auto shared_normal = together.particles.all().normal.to_host();
  const auto shared_warmth = together.particles.all().temperature.to_host();
  float longest = 0, warmed = 0;
  for (std::size_t i = 0; i < normal.size(); ++i) {
    const float size = length(xyz(normal[i]));
    EXPECT_NEAR(length(xyz(normal[i]) - xyz(shared_normal[i])), 0, 1e-5f + 1e-5f * size);
    EXPECT_NEAR(normal[i].w, shared_normal[i].w, 1e-5f + 1e-5f * size);
    EXPECT_NEAR(warmth[i], shared_warmth[i], 1e-5f);
    longest = at_least(size, longest);
    warmed = at_least(std::abs(warmth[i] - static_cast<float>(i * 37 % 11)), warmed);
  }
  EXPECT_GT(longest, 0.3f);
  EXPECT_GT(warmed, own_levels ? 0.05f : 0.1f);
}

SIM_TEST(SharedLoop, FindsTheSumsOfBothPasses) {
  NEEDS_EFFECTS;
  const auto loops = shared_loops();
  EXPECT_EQ(loops.size(), 2u);
  for (const SharedLoop& loop : loops) {
    SCOPED_TRACE(loop.stage.name);
    for (const bool one_level : {true, false}) equals_both(loop, one_level);
    equals_both(loop, false, true);
  }
}

SIM_TEST(SharedLoop, IsTakenWhereBothEffectsAreListed) {
  NEEDS_EFFECTS;
  const auto both = compile_schedule(demand_of({{EffectKind::Cohesion, 20}, {EffectKind::Heat, 0.02}}));
  EXPECT_THAT(names_of(both.substep_end),
              ElementsAre("velocity", "xsph", "normals and heat", "cohesion", "warm at walls", "buoyancy"));
  EXPECT_THAT(both.explanation, HasSubstr("one loop     normals and heat"));
  const auto heat = compile_schedule(demand_of({{EffectKind::Cohesion, 0}, {EffectKind::Heat, 0.02}}));
  EXPECT_THAT(names_of(heat.substep_end),
              ElementsAre("velocity", "xsph", "conduct heat", "warm at walls", "buoyancy"));
  EXPECT_THAT(heat.explanation, testing::Not(HasSubstr("one loop")));
}

SIM_TEST(SharedLoop, IsLeftWhereAPassBetweenWouldSeeTheDifference) {
  const Stage first{.name = "first",
                    .phase = Phase::SubstepEnd,
                    .called_for = always_moves,
                    .loop = SharedTerm::SurfaceNormals,
                    .reads = columns(Column::Position),
                    .writes = columns(Column::Normal)};
  const Stage last{.name = "last",
                   .phase = Phase::SubstepEnd,
                   .called_for = always_moves,
                   .loop = SharedTerm::Conduction,
                   .reads = columns(Column::Position),
                   .writes = columns(Column::Temperature)};
  const Stage both{.name = "both", .phase = Phase::SubstepEnd, .writes = first.writes | last.writes};
  const auto passes = [&](ColumnSet reads, ColumnSet writes) {
    const Stage between{.name = "between",
                        .phase = Phase::SubstepEnd,
                        .called_for = always_moves,
                        .reads = reads,
                        .writes = writes};
    return names_of(compile_schedule({}, {first, between, last},
                                     {{SharedTerm::SurfaceNormals, SharedTerm::Conduction, both}})
                        .substep_end);
  };
  const ColumnSet none;
  EXPECT_THAT(passes(columns(Column::Velocity), columns(Column::Velocity)), ElementsAre("both", "between"));
  EXPECT_THAT(passes(columns(Column::Position, Column::Normal), none), ElementsAre("both", "between"));
  EXPECT_THAT(passes(none, columns(Column::Position)), ElementsAre("first", "between", "last"));
  EXPECT_THAT(passes(none, columns(Column::Temperature)), ElementsAre("first", "between", "last"));
  EXPECT_THAT(passes(columns(Column::Temperature), none), ElementsAre("first", "between", "last"));
}

}  // namespace
}  // namespace sim::SIM_BACKEND
