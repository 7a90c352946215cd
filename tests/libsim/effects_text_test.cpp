/// Effects in the text form of a scene file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libsim/scene/effects.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/toml.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::EffectKind;

TEST(Effects, AreWrittenAsTheyAreRead) {
  NEEDS_EFFECTS;
  std::vector<sim::Effect> effects{
      {EffectKind::Cohesion, 12.5}, {EffectKind::AirDrag, 0}, {EffectKind::Foam, 0.3}};
  effects[2].options[static_cast<std::size_t>(sim::EffectOption::FoamLifetime)] = 1.1;
  const std::string text = sim::format_effects(effects);
  const auto read = sim::read_effects(base::parse_toml(text, "e.toml").tables("effect"));
  ASSERT_EQ(read.size(), 2u) << "a coefficient of 0 drops the effect";
  EXPECT_EQ(read[0].coefficient, 12.5);
  EXPECT_EQ(read[1].kind, EffectKind::Foam);
  EXPECT_EQ(read[1].options, effects[2].options);
  EXPECT_THAT(
      sim::effects_in_words(effects),
      testing::StartsWith("cohesion tension_n_m = 12.5 coarsest_level = 3; foam emission_per_s = 0.3 "));
  EXPECT_EQ(sim::effects_in_words({}), "");
  effects[0].coefficient = 0.12345678;
  effects[2].options[static_cast<std::size_t>(sim::EffectOption::FoamLifetime)] = 1.23456789;
  EXPECT_THAT(sim::effects_in_words(effects),
              testing::AllOf(testing::HasSubstr("tension_n_m = 0.12345678 "),
                             testing::HasSubstr(" lifetime_s = 1.23456789 ")));
  EXPECT_EQ(sim::effect_named("air_drag"), EffectKind::AirDrag);
  EXPECT_FALSE(sim::effect_named("froth"));
}

/// All digits are printed, so that two different runs do not look alike.
TEST(Effects, AreExplainedInAllTheirDigits) {
  NEEDS_EFFECTS;
  auto scene = fluid_test::tank({1, 1, 1}, {0.5, 0.5, 0.5});
  scene.effects = {{EffectKind::AirDrag, 1.23456789}};
  sim::SimulationOptions options;
  options.n_star = 64;
  EXPECT_THAT(sim::make_simulation(scene, options)->explain(),
              testing::AllOf(testing::HasSubstr("effects: air_drag rate_per_s = 1.23456789 "),
                             testing::HasSubstr("the scene lists rate_per_s = 1.23456789 ")));
}

TEST(Effects, BesideOthersMayNeedThemAndNotRepeatThem) {
  NEEDS_EFFECTS;
  const auto read = [](const std::string& text) {
    return sim::read_effects(base::parse_toml(text, "e.toml").tables("effect"), {{EffectKind::Cohesion, 20}});
  };
  EXPECT_EQ(read("[[effect]]\nkind = \"adhesion\"\nwork_n_m = 10\n").size(), 2u);
  EXPECT_THAT([&] { read("[[effect]]\nkind = \"cohesion\"\ntension_n_m = 10\n"); },
              testing::ThrowsMessage<base::Error>(
                  testing::AllOf(testing::HasSubstr("e.toml:2:8"), testing::HasSubstr("listed twice"))));
}

TEST(Effects, EachHasOneStageFileAndOneRowInTheDocs) {
  const std::string root = std::string(VIP_TEST_DIR) + "/../";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root + "libsim/solver/effects"))
    files += entry.path().extension() == ".cpp";
  EXPECT_EQ(files, sim::effect_count);
  const std::string page = base::read_file(root + "docs/methods.md", 1 << 20);
  for (std::size_t k = 0; k < sim::effect_count; ++k) {
    const auto& traits = sim::traits_of(static_cast<EffectKind>(k));
    EXPECT_THAT(page, testing::HasSubstr(std::string("| `") + traits.word + "` | `" + traits.key + "` |"));
  }
}

}  // namespace
