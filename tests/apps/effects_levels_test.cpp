#include "libsim/measure/effects_levels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "stats/base/error.hpp"
#include "tests/apps/table_test_support.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps {
namespace {

using sim::EffectKind;
using sim::EffectOption;
using ::testing::HasSubstr;

sim::Scene scene_with(std::vector<sim::Effect> effects) {
  sim::Scene out;
  out.name = "Pond";
  out.effects = std::move(effects);
  return out;
}

TEST(EffectsLevels, EachEffectOfALevelOfItsOwnRunsAtEach) {
  const auto variants = measure::level_variants_of(scene_with(
      {{EffectKind::Cohesion, 3}, {EffectKind::Adhesion, 2}, {EffectKind::Foam, 0}, {EffectKind::Heat, 2}}));
  ASSERT_EQ(variants.size(), 12u) << "adhesion has cohesion's level, and no foam is made";
  for (std::size_t i = 0; i < 12; ++i) {
    const auto& variant = variants[i];
    const bool heat = i >= 6;
    EXPECT_EQ(variant.effect, heat ? "heat" : "cohesion");
    EXPECT_EQ(variant.levels, std::vector<std::string>(
                                  {"none", "0 to 3", "0 to 2", "0 to 1", "0", "0 to 3, start moved"})[i % 6]);
    EXPECT_EQ(variant.moved, i % 6 == 5);
    ASSERT_EQ(variant.scene.effects.size(), i % 6 == 0 ? 0u : 1u);
    if (i % 6 == 0) continue;
    const auto& effect = variant.scene.effects[0];
    EXPECT_EQ(effect.coefficient, heat ? 2 : 3);
    const auto option = heat ? EffectOption::HeatCoarsest : EffectOption::CohesionCoarsest;
    EXPECT_EQ(effect.options[static_cast<std::size_t>(option)], i % 6 == 5 ? 3 : 4 - static_cast<int>(i % 6));
  }
}

TEST(EffectsLevels, ASceneWithoutSuchAnEffectIsRefused) {
  for (const auto& effects : {std::vector<sim::Effect>{}, {{EffectKind::Foam, 0}}})
    EXPECT_THAT([&] { measure::level_variants_of(scene_with(effects)); },
                testing::ThrowsMessage<base::Error>(HasSubstr("no effect that has a coarsest_level")));
}

TEST(EffectsLevels, SavedIsOfWhatAllLevelsTake) {
  const double equal = std::numeric_limits<double>::infinity();
  const std::vector<measure::LevelCost> costs{
      {.effect = "air_drag", .levels = "none", .ms_frame = 9, .ms_passes = 0, .psnr_db = 40},
      {.effect = "air_drag", .levels = "0 to 3", .ms_frame = 11, .ms_passes = 1, .psnr_db = equal},
      {.effect = "foam", .levels = "none", .ms_frame = 10, .ms_passes = 0},
      {.effect = "foam", .levels = "0 to 3", .ms_frame = 15, .ms_passes = 4, .psnr_db = equal, .ssim = 1},
      {.effect = "foam", .levels = "0", .ms_frame = 12, .ms_passes = 1, .psnr_db = 30, .flip_percent = 2.5},
      {.effect = "foam", .levels = "0 to 3, start moved", .ms_frame = 15, .ms_passes = 4}};
  const measure::EffectsRun run{"Pond", "Ours", "cpu", "1k", 7, 2};
  const figures::TextTable table = measure::to_table(run, costs);
  ASSERT_EQ(table.rows.size(), 6u);
  const auto cell = [&](std::size_t row, const char* column) {
    const auto at = std::find(table.head.begin(), table.head.end(), column) - table.head.begin();
    return table.rows[row].at(static_cast<std::size_t>(at));
  };
  EXPECT_EQ(cell(4, "ms_added"), "2.0000");
  EXPECT_EQ(cell(1, "ms_added"), "2.0000") << "each over its own bare scene";
  EXPECT_EQ(cell(4, "saved_percent"), "75.0");
  EXPECT_EQ(cell(3, "saved_percent"), "0.0");
  EXPECT_EQ(cell(2, "saved_percent"), "100.0");
  EXPECT_EQ(cell(3, "psnr_db"), "inf");
  EXPECT_EQ(cell(4, "flip_percent"), "2.50");
  const std::string svg = measure::to_svg(run, costs);
  for (const char* words :
       {"Pond, Ours on cpu, n_* 1k", ">foam<", ">level 0 to 3<", ">level 0<", ">start moved<", "4.000"})
    EXPECT_THAT(svg, HasSubstr(words));
  EXPECT_THAT(svg, ::testing::Not(HasSubstr(">none<")));
}

class EffectsLevelsE2e : public test::TableTest {};

TEST_F(EffectsLevelsE2e, AllLevelsAreTheReferenceAndNoneIsLeftToTake) {
  NEEDS_EFFECTS;
  const auto ended = table(
      "effects data/scenes/splash.toml --levels --method Ours --n-star 64 --frames 5 --warm-up 1 "
      "--size 64x48 --csv " +
      path("l.csv") + " --svg " + path("l.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("l.csv");
  ASSERT_EQ(table.size(), 6u);
  EXPECT_EQ(table[0].at("levels"), "none");
  EXPECT_EQ(std::stod(table[0].at("ms_passes")), 0);
  EXPECT_GT(std::stod(table[1].at("ms_passes")), 0);
  EXPECT_EQ(table[1].at("psnr_db"), "inf") << "it is its own reference";
  EXPECT_EQ(table[1].at("flip_percent"), "0.00");
  EXPECT_EQ(table[5].at("levels"), "0 to 3; start moved");
  EXPECT_THAT(base::read_file(path("l.svg"), 1 << 20), HasSubstr("<svg"));
}

TEST_F(EffectsLevelsE2e, RefusesWhatHasNoLevels) {
  NEEDS_EFFECTS;
  const auto one = table("effects data/scenes/splash.toml --levels --n-star 64");
  EXPECT_EQ(one.exit_code, 1) << one.out;
  EXPECT_THAT(one.out, HasSubstr("HiRes has only one"));
  const auto none = table("effects data/scenes/single_dam.toml --levels --method Ours --n-star 64");
  EXPECT_EQ(none.exit_code, 1) << none.out;
  EXPECT_THAT(none.out, HasSubstr("no effect that has a coarsest_level"));
  EXPECT_EQ(table("effects data/scenes/splash.toml --n-star 64 --size 64x48").exit_code, 2);
}

}  // namespace
}  // namespace apps
