/// How the levels of the factor "effects" change the effects of the scene that a cell shows.

#include "libstudy/stimulus/bakes/cell_effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/scene/picture_effects_text.hpp"
#include "libstudy/check/measured_check.hpp"
#include "libstudy/runner/cell_stimuli.hpp"
#include "libstudy/stimulus/bakes/bake_plan.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// protocols/foam.toml with this line as its list of levels of effects, these sets of effects, and this
/// scene.
study::Protocol protocol_with(const std::string& effects, const std::string& sets,
                              const std::string& scene = "sea_spray") {
  return study::parse_protocol(test::replaced(test::foam_text(effects, sets), "sea_spray", scene), "p.toml");
}

std::string error_of(const study::Protocol& protocol) {
  try {
    study::check_cell_effects(protocol);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

/// "p.toml:LINE:COLUMN:" of the '|' in `marked`, which without the '|' is a part of the text.
std::string place_in(const study::Protocol& protocol, std::string marked) {
  const auto mark = marked.find('|');
  const auto found = protocol.text.find(marked.erase(mark, 1));
  if (found == std::string::npos) return "(not in the text)";
  const auto at = found + mark, start = protocol.text.rfind('\n', at - 1) + 1;
  const auto line =
      1 + std::count(protocol.text.begin(), protocol.text.begin() + static_cast<long>(start), '\n');
  return "p.toml:" + std::to_string(line) + ":" + std::to_string(at - start + 1) + ":";
}

std::string set_of(const std::string& body) {
  return "[[design.effect_set]]\nname = \"foam\"\n" + body + "\n";
}

const char* const two_levels = "effects = [\"none\", \"foam\"]";

TEST(CellEffects, OfEachLevelAreThoseThatItNames) {
  NEEDS_EFFECTS;
  const auto protocol =
      protocol_with("effects = [\"none\", \"scene\", \"foam\"]",
                    set_of("keep = [\"foam\"]\neffect = [{kind = \"air_drag\", rate_per_s = 2}]"));
  const auto scene = sim::read_scene(base::find_input("data/scenes/sea_spray.toml"));
  EXPECT_EQ(error_of(protocol), "");
  EXPECT_THAT(*study::effects_of(protocol, "none", scene).water, IsEmpty());
  EXPECT_EQ(sim::format_effects(*study::effects_of(protocol, "scene", scene).water),
            sim::format_effects(scene.effects));
  const auto both = *study::effects_of(protocol, "foam", scene).water;
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].kind, sim::EffectKind::AirDrag);
  EXPECT_EQ(both[0].coefficient, 2);
  EXPECT_EQ(both[1].kind, sim::EffectKind::Foam);
  EXPECT_EQ(both[1].coefficient, 0.3);
  EXPECT_THAT(study::levels_in_words(protocol, scene),
              AllOf(HasSubstr("none: no effects, scene: foam emission_per_s = 0.3 "),
                    HasSubstr("foam: air_drag rate_per_s = 2 ")));
}

TEST(CellEffects, WithoutTheFactorAreTheScenesOwn) {
  NEEDS_EFFECTS;
  const auto protocol = study::read_protocol(base::resource("protocols/task1.toml"));
  const study::CellEffects of = study::cell_effects(protocol, protocol.design.cells.front().stimulus);
  EXPECT_FALSE(of.water || of.picture);
  EXPECT_EQ(error_of(protocol), "");
}

TEST(CellEffects, ThatTheSceneCannotHaveAreRefusedWithTheirPlace) {
  NEEDS_EFFECTS;
  const auto expect = [](const study::Protocol& protocol, const std::string& marked, const char* problem,
                         const char* mend) {
    EXPECT_THAT(error_of(protocol),
                AllOf(HasSubstr(place_in(protocol, marked)), HasSubstr(problem), HasSubstr(mend)));
  };
  expect(protocol_with(two_levels, set_of("keep = [\"foam\", \"froth\"]")), "\"foam\", |\"froth\"",
         "is no effect", "use one of viscosity");
  expect(protocol_with(two_levels, set_of("keep = [\"heat\"]")), "keep = [|\"heat\"",
         "is no effect of scene SeaSpray", "design.effect_set.effect");
  expect(protocol_with(two_levels, set_of("effect = [{kind = \"froth\", rate_per_s = 1}]")),
         "kind = |\"froth\"", "not a known choice", "foam");
  expect(protocol_with(two_levels, set_of("effect = [{kind = \"air_drag\"}]")), "effect = [|{kind",
         "rate_per_s' is missing", "add");
  expect(
      protocol_with(two_levels, set_of("effect = [{kind = \"air_drag\", rate_per_s = 1, lifetime_s = 2}]")),
      "lifetime_s = |2", "is no key of air_drag", "rate_per_s, coarsest_level");
  expect(protocol_with(two_levels, set_of("effect = [{kind = \"air_drag\", rate_per_s = 2e6}]")),
         "rate_per_s = |2e6", "out of range", "[0, 1000000]");
  expect(protocol_with(two_levels, set_of("effect = [{kind = \"adhesion\", work_n_m = 0.01}]")),
         "kind = |\"adhesion\"", "needs cohesion", "list cohesion too");
}

TEST(CellEffects, OfThePictureStayWhereNoSetNamesOne) {
  NEEDS_EFFECTS;
  const auto protocol =
      protocol_with(two_levels, set_of("effect = [{kind = \"air_drag\", rate_per_s = 1}]"), "pool_light");
  const auto scene = sim::read_scene(base::find_input("data/scenes/pool_light.toml"));
  for (const char* level : {"none", "foam"}) {
    const study::CellEffects of = study::effects_of(protocol, level, scene);
    EXPECT_FALSE(of.picture) << level;
    EXPECT_EQ(study::scene_with(scene, of).picture_effects.size(), 2u) << level;
  }
  EXPECT_THAT(study::levels_in_words(protocol, scene),
              HasSubstr("none: no effects, foam: air_drag rate_per_s = 1 "));
}

TEST(CellEffects, OfThePictureVaryWhereASetNamesOne) {
  const auto protocol = protocol_with(
      "effects = [\"none\", \"foam\", \"scene\"]",
      set_of("keep = [\"caustics\"]\neffect = [{kind = \"shadows\", strength = 0.5}]"), "pool_light");
  const auto scene = sim::read_scene(base::find_input("data/scenes/pool_light.toml"));
  EXPECT_EQ(error_of(protocol), "");
  EXPECT_EQ(
      study::levels_in_words(protocol, scene),
      "none: no effects, foam: shadows strength = 0.5; caustics strength = 1, scene: shadows strength = "
      "1; caustics strength = 1");
  const auto none = study::scene_with(scene, study::effects_of(protocol, "none", scene));
  EXPECT_THAT(none.picture_effects, IsEmpty());
  study::RunOptions options;
  options.display = "headless";
  options.backend = "cpu";
  const study::CellStimuli stimuli(options, protocol, {}, {});
  for (std::size_t cell = 0; cell < 3; ++cell) {
    const auto live = stimuli.choice_of(protocol.design.cells[cell]).picture_effects;
    const auto baked = study::order_of(protocol, study::plan_bakes(protocol)[cell], {}).fluid.picture_effects;
    ASSERT_TRUE(live && baked);
    EXPECT_EQ(live->size(), cell == 0 ? 0u : 2u);
    EXPECT_EQ(sim::format_picture_effects(*live), sim::format_picture_effects(*baked));
  }
}

TEST(CellEffects, OfThePictureThatCannotBeAreRefusedWithTheirPlace) {
  const auto expect = [](const std::string& sets, const std::string& scene, const std::string& marked,
                         const char* problem, const char* mend) {
    const auto protocol = protocol_with(two_levels, set_of(sets), scene);
    EXPECT_THAT(error_of(protocol),
                AllOf(HasSubstr(place_in(protocol, marked)), HasSubstr(problem), HasSubstr(mend)));
  };
  expect("keep = [\"shadows\"]", "single_dam", "keep = [|\"shadows\"", "is no effect of scene SingleDam",
         "design.effect_set.effect");
  expect("effect = [{kind = \"shadows\", strength = 2}]", "single_dam", "strength = |2", "out of range",
         "[0, 1]");
  expect("effect = [{kind = \"shadows\", emission_per_s = 2}]", "single_dam", "emission_per_s = |2",
         "is no key of shadows", "use strength");
  expect("effect = [{kind = \"glow\", strength = 1}]", "single_dam", "kind = |\"glow\"", "not a known choice",
         "caustics");
  const auto same = protocol_with("effects = [\"foam\", \"scene\"]",
                                  set_of("keep = [\"caustics\", \"shadows\"]"), "pool_light");
  EXPECT_THAT(error_of(same), AllOf(HasSubstr(place_in(same, "\"foam\", |\"scene\"]")),
                                    HasSubstr("is the same water and light as \"foam\" in scene PoolLight")));
  const auto dropped =
      protocol_with(two_levels, set_of("effect = [{kind = \"shadows\", strength = 0}]"), "single_dam");
  EXPECT_THAT(error_of(dropped), HasSubstr("is the same water and light as \"none\""));
}

TEST(CellEffects, LevelsOfTheSameWaterAreRefused) {
  NEEDS_EFFECTS;
  const auto same = protocol_with("effects = [\"foam\", \"scene\"]", set_of("keep = [\"foam\"]"));
  EXPECT_THAT(error_of(same),
              AllOf(HasSubstr(place_in(same, "\"foam\", |\"scene\"]")),
                    HasSubstr("is the same water as \"foam\" in scene SeaSpray"), HasSubstr("remove one")));
  const auto bare = protocol_with("effects = [\"none\", \"scene\"]", "", "single_dam");
  EXPECT_THAT(error_of(bare), HasSubstr("is the same water as \"none\" in scene SingleDam"));
}

TEST(CellEffects, ThatLeaveNoTemperatureToPaintAreRefused) {
  NEEDS_EFFECTS;
  const std::string overlay = "overlay = \"temperature\"\n", scene_and = "effects = [\"scene\", ";
  const auto expect = [](const study::Protocol& protocol, const std::string& problem) {
    EXPECT_THAT(error_of(protocol),
                AllOf(HasSubstr(place_in(protocol, "overlay = |\"temperature\"")), HasSubstr(problem)));
  };
  EXPECT_EQ(error_of(protocol_with(overlay, "", "hot_jet")), "");
  expect(protocol_with(overlay, "", "sea_spray"),
         "needs the effect heat, which is missing in scene SeaSpray\n");
  expect(protocol_with(overlay + scene_and + "\"none\"]", "", "hot_jet"),
         "needs the effect heat, which is missing in scene HotJet at level \"none\"");
  const auto heat_with = [&](const std::string& keys) {
    return protocol_with(overlay + scene_and + "\"foam\"]",
                         set_of("effect = [{kind = \"heat\", diffusivity_m2_s = 0.01" + keys + "}]"),
                         "hot_jet");
  };
  EXPECT_EQ(error_of(heat_with("")), "") << "from 293.15 to 353.15 K as the scene's";
  EXPECT_EQ(error_of(heat_with(", wall_k = 300")), "") << "and so is this";
  expect(heat_with(", wall_k = 373.15"),
         "other colours in scene HotJet at level \"foam\", temperature 293.15 to 373.15 K, than at level "
         "\"scene\", temperature 293.15 to 353.15 K");
}

TEST(CellEffects, ReachTheFluidOfTheirCells) {
  NEEDS_EFFECTS;
  const auto protocol = study::read_protocol(base::resource("protocols/foam.toml"));
  study::RunOptions options;
  options.display = "headless";
  options.backend = "cpu";
  const study::CellStimuli stimuli(options, protocol, {}, {});
  const auto live = [&](std::size_t cell) { return stimuli.choice_of(protocol.design.cells[cell]).effects; };
  const auto baked = [&](std::size_t cell) {
    return study::order_of(protocol, study::plan_bakes(protocol)[cell], {}).fluid.effects;
  };
  for (const auto& effects : {live(0), baked(0)}) {
    ASSERT_TRUE(effects) << "none, not the scene's own";
    EXPECT_THAT(*effects, IsEmpty());
  }
  for (const auto& effects : {live(1), baked(1)}) {
    ASSERT_TRUE(effects);
    ASSERT_EQ(effects->size(), 1u);
    EXPECT_EQ(effects->front().coefficient, 0.3) << "as the scene's file lists it";
  }
}

TEST(CellEffects, NameTheirBakesAndStimuli) {
  NEEDS_EFFECTS;
  const auto plan = study::plan_bakes(study::read_protocol(base::resource("protocols/foam.toml")));
  std::vector<std::string> files, names;
  for (const auto& one : plan) {
    files.push_back(one.file);
    names.push_back(study::stimulus_name(one.what));
  }
  EXPECT_THAT(files, ElementsAre("sea_spray_16k_LoRes_none.bake", "sea_spray_16k_LoRes_foam.bake",
                                 "sea_spray_16k_HiRes_none.bake", "sea_spray_16k_HiRes_foam.bake"));
  EXPECT_THAT(names, ElementsAre("LoRes sea_spray 16k none", "LoRes sea_spray 16k foam",
                                 "HiRes sea_spray 16k none", "HiRes sea_spray 16k foam"));
}

}  // namespace
}  // namespace apps
