/// Effects that leave out coarse water, in scenes and whole runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "stats/base/error.hpp"
#include "stats/base/toml.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::EffectKind;
using sim::MethodKind;
using testing::HasSubstr;
using testing::Not;

std::vector<EffectKind> all_kinds() {
  std::vector<EffectKind> out;
  for (std::size_t k = 0; k < sim::effect_count; ++k) out.push_back(static_cast<EffectKind>(k));
  return out;
}

TEST(OwnLevels, EveryEffectHasACoarsestLevelAndAdhesionThatOfCohesion) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : all_kinds()) {
    const auto option = sim::coarsest_level_of(kind);
    ASSERT_TRUE(option) << sim::traits_of(kind).word;
    EXPECT_EQ(sim::traits_of(*option).usual, sim::most_levels - 1) << sim::traits_of(kind).word;
    if (kind == EffectKind::Adhesion) {
      EXPECT_EQ(sim::traits_of(*option).of, EffectKind::Cohesion);
      continue;
    }
    EXPECT_EQ(sim::traits_of(*option).of, kind);
    const std::string table = std::string("[[effect]]\nkind = \"") + sim::traits_of(kind).word + "\"\n" +
                              sim::traits_of(kind).key + " = 1\ncoarsest_level = ";
    const auto read = [&](const char* value) {
      return sim::read_effects(base::parse_toml(table + value + "\n", "e.toml").tables("effect"));
    };
    EXPECT_EQ(read("2")[0].options[static_cast<std::size_t>(*option)], 2);
    for (const char* wrong : {"4", "-1"})
      EXPECT_THAT([&] { read(wrong); }, testing::ThrowsMessage<base::Error>(testing::AllOf(
                                            HasSubstr("e.toml:4:"), HasSubstr("out of range"))));
    EXPECT_THAT([&] { read("0.5"); }, testing::ThrowsMessage<base::Error>(HasSubstr("is no whole number")));
    sim::Effect effect{kind, 1};
    effect.options[static_cast<std::size_t>(*option)] = 4;
    EXPECT_THROW(sim::check_effects({effect}), base::Error);
  }
}

/// All effects up to this level, with coefficients that need no additional substeps.
std::vector<sim::Effect> effects_to(double coarsest) {
  std::vector<sim::Effect> out{{EffectKind::Viscosity, 0.05}, {EffectKind::Cohesion, 20},
                               {EffectKind::Adhesion, 10},    {EffectKind::AirDrag, 2},
                               {EffectKind::Vorticity, 1},    {EffectKind::Friction, 0.5},
                               {EffectKind::Heat, 0.02}};
  for (auto& effect : out)
    effect.options[static_cast<std::size_t>(*sim::coarsest_level_of(effect.kind))] = coarsest;
  return out;
}

struct Outcome {
  std::string explanation;
  std::vector<fluid_test::ParticleState> state;
};
Outcome run(MethodKind method, std::vector<sim::Effect> effects) {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.effects = std::move(effects);
  if (!scene.effects.empty()) scene.warm = {{{0, 0, 0}, {0.6, 0.6, 0.6}, 350}};
  sim::SimulationOptions options;
  options.method = method;
  options.n_star = 64;
  const auto fluid = sim::make_simulation(scene, options);
  Outcome out{.explanation = fluid->explain(), .state = {}};
  for (int frame = 0; frame < 6; ++frame) fluid->step_frame();
  out.state = fluid->read_state();
  return out;
}
bool same_bits(const Outcome& a, const Outcome& b) {
  return a.state.size() == b.state.size() &&
         std::memcmp(a.state.data(), b.state.data(), a.state.size() * sizeof a.state[0]) == 0;
}

TEST(OwnLevels, WaterOfCoarserLevelsAloneIsThatWithoutEffectsAndExplainSaysSo) {
  NEEDS_EFFECTS;
  const Outcome bare = run(MethodKind::LoRes, {});
  const Outcome idle = run(MethodKind::LoRes, effects_to(2));
  EXPECT_TRUE(same_bits(bare, idle));
  EXPECT_FALSE(same_bits(bare, run(MethodKind::LoRes, effects_to(3))))
      << "they must act for the test to mean anything";
  for (const auto& effect : effects_to(2))
    EXPECT_THAT(idle.explanation, HasSubstr(std::string("  ") + sim::traits_of(effect.kind).word +
                                            ": does nothing, as no water is of level 0 to 2\n"));
  EXPECT_THAT(run(MethodKind::LoRes, effects_to(0)).explanation, HasSubstr("no water is of level 0\n"));
}

TEST(OwnLevels, ExplainSaysNothingOfEffectsThatAct) {
  NEEDS_EFFECTS;
  const std::string words = "does nothing";
  EXPECT_THAT(run(MethodKind::LoRes, effects_to(3)).explanation, Not(HasSubstr(words)));
  for (const MethodKind method : {MethodKind::HiRes, MethodKind::Ours})
    EXPECT_THAT(run(method, effects_to(0)).explanation, Not(HasSubstr(words)));
  EXPECT_THAT(run(MethodKind::LoRes, {{EffectKind::Cohesion, 0}}).explanation, Not(HasSubstr(words)));
}

TEST(OwnLevels, FineWaterIsThatOfEffectsAtAllLevels) {
  NEEDS_EFFECTS;
  EXPECT_TRUE(same_bits(run(MethodKind::HiRes, effects_to(0)), run(MethodKind::HiRes, effects_to(3))));
  EXPECT_FALSE(same_bits(run(MethodKind::Ours, effects_to(0)), run(MethodKind::Ours, effects_to(3))));
}

}  // namespace
