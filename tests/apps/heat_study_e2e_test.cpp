/// A study whose participants see temperature, baked and live, through to the record, exports and report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/shown_study.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps::test {
namespace {

using json = base::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string vip_stats = VIP_BIN_DIR "/vip-stats";

/// protocols/foam.toml with HotJet, coarse and short: LoRes and HiRes are compared, painted by temperature.
class HeatStudyE2e : public ShownStudy {
 protected:
  void SetUp() override { NEEDS_EFFECTS; }
  HeatStudyE2e() : ShownStudy("heat", "64x36") {
    const std::string text = replaced(foam_text("overlay = \"temperature\"", ""), "sea_spray", "hot_jet");
    base::write_file_atomically(protocol_, with_keys(text, {{"n_star", "[\"256\"]"}, {"duration_s", "0.5"}}));
  }
};

TEST_F(HeatStudyE2e, LiveWaterIsPaintedAndEveryRecordSaysSo) {
  const Ended ended = run({"--participants", "2"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const std::string words = "painted temperature 293.15 to 353.15 K";
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("live on cpu, scene HotJet"), HasSubstr(words)));

  const fs::path csv = folder_ / "csv";
  ASSERT_EQ(run_program({vip_study, "export", "--db", database_, "--csv", csv}).exit_code, 0);
  EXPECT_THAT(base::read_file(csv / "sessions.csv", 1 << 20), HasSubstr(words));

  const std::string results = folder_ / "results.json", page = folder_ / "report.html";
  const Ended told = run_program({vip_stats, "report", database_, "--json", results, "--html", page});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const json study = json::parse(base::read_file(results, 1 << 24)).at("study");
  EXPECT_EQ(study.at("protocols")[0].at("overlay"), "temperature");
  const std::string text = std::regex_replace(base::read_file(page, 1 << 24), std::regex("<[^>]*>"), "");
  EXPECT_THAT(text, HasSubstr("temperature was painted"));
}

TEST_F(HeatStudyE2e, BakesHoldTemperaturesAndArePlayedPainted) {
  const Ended baked = bake();
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const std::string file = bakes_ + "/hot_jet_256_LoRes.bake";
  const Ended checked = run_program({vip_study, "bake", "--verify", file});
  EXPECT_THAT(checked.out, HasSubstr("  with the temperature of each, off by at most 0.00046 K\n"));
  const Ended ended = run({"--participant", "P01", "--stimulus", bakes_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("hot_jet 256 HiRes bake"), HasSubstr("; painted temperature"),
                                Not(HasSubstr("live"))));
  // When repeated, the command finds complete bakes.
  EXPECT_THAT(bake().out, HasSubstr("hot_jet_256_LoRes.bake: whole, kept"));
}

TEST_F(HeatStudyE2e, PicturesWithoutTheirPaintAreRefused) {
  ASSERT_EQ(bake({"--keep", "pictures"}).exit_code, 0);
  const std::string file = bakes_ + "/hot_jet_256_LoRes.bake";
  EXPECT_THAT(run_program({vip_study, "bake", "--verify", file}).out,
              HasSubstr("64x36 pictures (view, temperature painted) read"));
  ASSERT_EQ(run({"--participant", "P01", "--stimulus", bakes_}).exit_code, 0);
  replace_in(protocol_, "overlay = \"temperature\"", "overlay = \"none\"");
  fs::remove(database_);
  const Ended other = run({"--participant", "P01", "--stimulus", bakes_});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("holds pictures with temperature painted over them instead of nothing"));
}

TEST_F(HeatStudyE2e, CheckTellsTheOverlayAndRefusesWaterWithoutHeat) {
  const std::string found = folder_ / "check.json";
  const Ended ended = run_program({vip_study, "check", protocol_, "--json", found});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("overlay: temperature is painted over the water of every stimulus\n"));
  EXPECT_EQ(json::parse(base::read_file(found, 1 << 20)).at("overlay"), "temperature");
  EXPECT_THAT(run_program({vip_study, "check", base::resource("protocols/foam.toml")}).out,
              Not(HasSubstr("overlay:")));
  replace_in(protocol_, "hot_jet", "single_dam");
  const Ended cold = run_program({vip_study, "check", protocol_});
  EXPECT_EQ(cold.exit_code, 1);
  EXPECT_THAT(cold.err, AllOf(HasSubstr("heat.toml:15:11: "),
                              HasSubstr("needs the effect heat, which is missing in scene SingleDam")));
}

TEST_F(HeatStudyE2e, ABakeOfAScenePaintsItsPicturesAlone) {
  const std::string scene = base::resource("data/scenes/hot_jet.toml"), out = folder_ / "a.bake";
  const auto baked = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {vip_study, "bake", scene, "--n-star", "64", "--frames", "2", "--backend",
                               "cpu", "--out", out, "--force", "--overlay", "temperature"});
    return run_program(more);
  };
  EXPECT_THAT(baked({}).err, HasSubstr("--overlay requires --pictures"));
  const Ended ended = baked({"--pictures", "64x36"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(sim::BakeReader(out).header().overlay, "temperature");
}

}  // namespace
}  // namespace apps::test
