/// A study with light on the floor as a factor, from plan to report, live and baked.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "libsim/bake/bake_file.hpp"
#include "libsim/scene/picture_effects_text.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/shown_study.hpp"

namespace apps::test {
namespace {

using json = base::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string vip_stats = VIP_BIN_DIR "/vip-stats";

/// protocols/foam.toml with PoolLight: without light on the floor, and with caustics and half of the shadows.
class LightStudyE2e : public ShownStudy {
 protected:
  LightStudyE2e() : ShownStudy("light", "128x72") { write(protocol_, false); }
  void write(const std::string& path, bool small) const {
    std::string text = replaced(replaced(shipped_text("foam"), "sea_spray", "pool_light"),
                                "name = \"foam\"\nkeep = [\"foam\"]",
                                "name = \"lit\"\nkeep = [\"caustics\"]\n"
                                "effect = [{kind = \"shadows\", strength = 0.5}]");
    text = with_keys(text, {{"effects", "[\"none\", \"lit\"]"}});
    if (small) text = coarse(text);
    base::write_file_atomically(path, text);
  }
};

// P(lit chosen) = Phi(1 / sqrt 2) = .76: light adds 1 to the score of a stimulus, and the score of each of
// the two has noise of SD 1.
TEST_F(LightStudyE2e, TheReportFindsWhatLightIsWorth) {
  const std::string results = folder_ / "results.json", page = folder_ / "report.html";
  const Ended ran = run_program({vip_study, "run", protocol_, "--db", database_, "--participants", "40",
                                 "--seed", "5", "--observer", "ptpe:a=24,b=0.02,effects=1"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const Ended told = run_program({vip_stats, "report", database_, "--json", results, "--html", page});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const json found = json::parse(base::read_file(results, 1 << 24));
  EXPECT_EQ(found.at("study").at("protocols")[0].at("effects"),
            (json{{"none", "no effects"}, {"lit", "keeps caustics; shadows strength = 0.5"}}));
  bool told_factor = false;
  for (const auto& one : found.at("task2").at("factors")) {
    if (one.at("factor") != "effects") continue;
    told_factor = true;
    EXPECT_EQ(one.at("a"), "none");
    EXPECT_EQ(one.at("b"), "lit");
    EXPECT_EQ(one.at("n"), 80);
    EXPECT_NEAR(one.at("share").get<double>(), 0.24, 0.11);
    EXPECT_LT(one.at("p").get<double>(), 1e-4);
  }
  EXPECT_TRUE(told_factor);
  const std::string text = std::regex_replace(base::read_file(page, 1 << 24), std::regex("<[^>]*>"), "");
  EXPECT_THAT(text,
              AllOf(HasSubstr("with the levels none (no effects), lit (keeps caustics; shadows strength"),
                    HasSubstr("effects: none over lit")));
  const fs::path csv = folder_ / "csv";
  ASSERT_EQ(run_program({vip_study, "export", "--db", database_, "--csv", csv}).exit_code, 0);
  EXPECT_THAT(base::read_file(csv / "cells.csv", 1 << 20),
              AllOf(HasSubstr("none,no effects"), HasSubstr("lit,keeps caustics; shadows strength = 0.5")));
}

TEST_F(LightStudyE2e, CheckNamesLevelsAndRefusesWhatTheSceneDoesNotList) {
  const Ended ended = run_program({vip_study, "check", protocol_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("effects \"lit\": keeps caustics; shadows strength = 0.5\n"));
  replace_in(protocol_, "pool_light", "single_dam");
  const Ended wrong = run_program({vip_study, "check", protocol_});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("light.toml:25:9: "),
                               HasSubstr("\"caustics\" is no effect of scene SingleDam")));
}

TEST_F(LightStudyE2e, LiveCellsHaveTheLightOfTheirLevel) {
  write(protocol_, true);
  const Ended ended = run({"--participant", "P01"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("live on cpu, scene PoolLight"),
                                HasSubstr("effects none: no effects, lit: shadows strength = 0.5; caustics "
                                          "strength = 1")));
}

TEST_F(LightStudyE2e, BakesOfParticlesTellTheirLightAndAreDrawnByIt) {
  write(protocol_, true);
  const Ended baked = bake();
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const sim::BakeReader lit(fs::path(bakes_) / "pool_light_256_LoRes_lit.bake"),
      unlit(fs::path(bakes_) / "pool_light_256_LoRes_none.bake");
  EXPECT_EQ(sim::picture_effects_in_words(sim::baked_scene(lit.header()).picture_effects),
            "shadows strength = 0.5; caustics strength = 1");
  EXPECT_TRUE(sim::baked_scene(unlit.header()).picture_effects.empty());
  EXPECT_FALSE(sim::parse_scene(unlit.header().scene_text, "s").picture_effects.empty());
  const Ended ended = run({"--participant", "P01", "--stimulus", bakes_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("pool_light 256 LoRes none bake"),
                                HasSubstr("pool_light 256 LoRes lit bake"), Not(HasSubstr("live"))));
  // If the protocol changes the strength of the light, the existing bakes no longer match it.
  replace_in(protocol_, "strength = 0.5", "strength = 0.25");
  fs::remove(database_);
  const Ended other = run({"--participant", "P01", "--stimulus", bakes_});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("holds shadows strength = 0.5; caustics strength = 1 instead of shadows "
                                   "strength = 0.25"));
}

/// The water is the same at both levels, so the pictures differ only in light.
TEST_F(LightStudyE2e, BakesOfPicturesHoldTheirLight) {
  write(protocol_, true);
  ASSERT_EQ(bake({"--keep", "pictures"}).exit_code, 0);
  const sim::BakeReader lit(fs::path(bakes_) / "pool_light_256_LoRes_lit.bake"),
      unlit(fs::path(bakes_) / "pool_light_256_LoRes_none.bake");
  sim::BakeFrame with, without;
  lit.read_frame(40, with);
  unlit.read_frame(40, without);
  ASSERT_EQ(with.particles.size(), without.particles.size());
  EXPECT_EQ(with.particles[5].y_m, without.particles[5].y_m);
  sim::PictureReader lit_pictures(lit), unlit_pictures(unlit);
  EXPECT_NE(lit_pictures.read(40).rgba, unlit_pictures.read(40).rgba);
  EXPECT_EQ(run({"--participant", "P01", "--stimulus", bakes_}).exit_code, 0);
}

}  // namespace
}  // namespace apps::test
