#include "libsim/measure/effects_cost.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/scene/effects.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/table_test_support.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps {
namespace {

using sim::EffectKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names_of(const std::vector<measure::EffectVariant>& variants) {
  std::vector<std::string> out;
  for (const auto& variant : variants) out.push_back(variant.name);
  return out;
}

sim::Scene scene_with(std::vector<sim::Effect> effects) {
  sim::Scene out;
  out.name = "Pond";
  out.effects = std::move(effects);
  return out;
}

TEST(EffectsCost, EachEffectRunsAloneWithWhatItNeeds) {
  const auto variants = measure::variants_of(
      scene_with({{EffectKind::Adhesion, 2}, {EffectKind::Cohesion, 3}, {EffectKind::AirDrag, 1}}));
  EXPECT_THAT(names_of(variants),
              ElementsAre("none", "cohesion + adhesion", "cohesion", "air_drag", "all", "all at 0"));
  EXPECT_TRUE(variants[0].scene.effects.empty());
  EXPECT_EQ(variants[1].scene.effects.size(), 2u);
  for (const auto& effect : variants.back().scene.effects) EXPECT_EQ(effect.coefficient, 0);
  EXPECT_THAT(
      names_of(measure::variants_of(scene_with({{EffectKind::AirDrag, 1}, {EffectKind::Cohesion, 0}}))),
      ElementsAre("none", "air_drag", "all at 0"));
}

TEST(EffectsCost, ASceneWithoutEffectsIsRefused) {
  EXPECT_THROW(measure::variants_of(scene_with({})), base::Error);
  EXPECT_THROW(measure::variants_of(scene_with({{EffectKind::AirDrag, 0}})), base::Error);
}

TEST(EffectsCost, WhatIsAddedIsOverTheFirstRow) {
  const std::vector<measure::EffectCost> costs{
      {.name = "none", .ms_frame = 4, .launches = 10, .column_bytes = 100},
      {.name = "foam", .ms_frame = 5, .launches = 13, .column_bytes = 160}};
  const measure::EffectsRun run{"Pond", "Ours", "cpu", "1k", 7, 2};
  const figures::TextTable table = measure::to_table(run, costs);
  ASSERT_EQ(table.rows.size(), 2u);
  const auto cell = [&](const char* column) {
    const auto at = std::find(table.head.begin(), table.head.end(), column) - table.head.begin();
    return table.rows[1].at(static_cast<std::size_t>(at));
  };
  EXPECT_EQ(cell("ms_added"), "1.0000");
  EXPECT_EQ(cell("added_percent"), "25.0");
  EXPECT_EQ(cell("launches_added"), "3.0");
  EXPECT_EQ(cell("column_bytes_added"), "60");
  EXPECT_EQ(cell("device_bytes_added"), "-");
  const std::string svg = measure::to_svg(run, costs);
  for (const char* words : {"Pond, Ours on cpu, n_* 1k", ">foam<", "5.000"})
    EXPECT_THAT(svg, HasSubstr(words));
}

class EffectsCostE2e : public test::TableTest {};

TEST_F(EffectsCostE2e, ACoefficientOfZeroAddsNothing) {
  NEEDS_EFFECTS;
  const auto ended = table("effects data/scenes/splash.toml --n-star 64 --frames 3 --warm-up 1 --csv " +
                           path("e.csv") + " --markdown " + path("e.md") + " --svg " + path("e.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("e.csv");
  ASSERT_GE(table.size(), 3u);
  EXPECT_EQ(table.front().at("effects"), "none");
  EXPECT_EQ(table.front().at("same_state"), "yes");
  const auto& zero = table.back();
  EXPECT_EQ(zero.at("effects"), "all at 0");
  EXPECT_EQ(zero.at("same_state"), "yes");
  EXPECT_EQ(zero.at("launches_added"), "0.0");
  EXPECT_EQ(zero.at("column_bytes_added"), "0");
  EXPECT_EQ(table[1].at("same_state"), "no") << "an effect moves the water";
  EXPECT_GT(std::stod(table[1].at("launches_added")), 0);
  EXPECT_THAT(base::read_file(path("e.md"), 1 << 20), HasSubstr("| all at 0 |"));
}

TEST_F(EffectsCostE2e, RefusesASceneWithoutEffects) {
  const auto ended = table("effects data/scenes/single_dam.toml --n-star 64");
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("lists no effect"));
}

}  // namespace
}  // namespace apps
