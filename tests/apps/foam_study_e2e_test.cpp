/// A study with foam as a factor, from plan to report, with simulated participants.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "libsim/bake/bake_file.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/shown_study.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps::test {
namespace {

using json = base::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string vip_stats = VIP_BIN_DIR "/vip-stats";

std::string foam_protocol() { return base::resource("protocols/foam.toml").string(); }

/// The entry of the list that has these values.
json entry(const json& list, const std::map<std::string, std::string>& words) {
  for (const auto& one : list) {
    bool same = true;
    for (const auto& [key, word] : words) same = same && one.at(key) == word;
    if (same) return one;
  }
  return {};
}

class FoamStudyE2e : public ::testing::Test {
 protected:
  void SetUp() override { NEEDS_EFFECTS; }
  /// The report's numbers for `participants` of an observer who prefers foam by `effects` points of score.
  json report_of(const std::string& effects, const std::string& participants) {
    const std::string database = folder_ / ("study_" + effects + ".db"),
                      results = folder_ / ("results_" + effects + ".json");
    const Ended ran =
        run_program({vip_study, "run", foam_protocol(), "--db", database, "--participants", participants,
                     "--seed", "5", "--observer", "ptpe:a=24,b=0.02,effects=" + effects});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const Ended told = run_program({vip_stats, "report", database, "--json", results, "--html", page_});
    EXPECT_EQ(told.exit_code, 0) << told.err;
    return json::parse(base::read_file(results, 1 << 24));
  }

  TemporaryFolder folder_;
  const std::string page_ = folder_ / "report.html";
};

TEST_F(FoamStudyE2e, TheColumnsOfTask2StandUnderTheirHeads) {
  report_of("1", "4");
  const std::string printed = run_program({vip_stats, "task2", folder_ / "study_1.db"}).out;
  const auto from = printed.find("\nchosen") + 1;
  const std::string head = printed.substr(from, printed.find('\n', from) - from);
  const auto at = head.find("95 %");
  int pairs = 0;
  std::istringstream lines(printed.substr(from + head.size() + 1));
  for (std::string line; std::getline(lines, line) && line.find(" over ") < line.find(':'); ++pairs)
    EXPECT_EQ(line.find('['), at) << head << "\n" << line;
  EXPECT_GT(pairs, 3);
}

// P(foam chosen) = Phi(1 / sqrt 2) = .76: foam adds 1 to the score of a stimulus, and the score of each of
// the two has noise of SD 1.
TEST_F(FoamStudyE2e, TheReportFindsWhatFoamIsWorth) {
  const json results = report_of("1", "40");
  const json& task2 = results.at("task2");
  EXPECT_EQ(task2.at("methods"), (json{"LoRes, none", "LoRes, foam", "HiRes, none", "HiRes, foam"}));
  const json foam = entry(task2.at("factors"), {{"factor", "effects"}, {"a", "none"}, {"b", "foam"}});
  EXPECT_EQ(foam.at("n"), 80) << "of each person the pair of LoRes and that of HiRes";
  EXPECT_NEAR(foam.at("share").get<double>(), 0.24, 0.11);
  EXPECT_LT(foam.at("p").get<double>(), 1e-4);
  EXPECT_LT(foam.at("ci")[1].get<double>(), 0.5);
  const json method = entry(task2.at("factors"), {{"factor", "method"}, {"a", "LoRes"}, {"b", "HiRes"}});
  EXPECT_EQ(method.at("n"), 80);
  EXPECT_GT(method.at("p").get<double>(), 0.01) << "nothing of the particles reaches this observer";
}

// Both pairs are LoRes over HiRes: a report that ignored the factor would print one number for them, near .5.
TEST_F(FoamStudyE2e, TwoPairsOfTheSameMethodsDifferByTheirFoam) {
  const json pairs = report_of("1.5", "40").at("task2").at("pairs");
  ASSERT_EQ(pairs.size(), 6u);
  const json gained = entry(pairs, {{"a", "LoRes, foam"}, {"b", "HiRes, none"}}),
             lost = entry(pairs, {{"a", "LoRes, none"}, {"b", "HiRes, foam"}});
  EXPECT_GT(gained.at("share").get<double>(), 0.7);
  EXPECT_LT(gained.at("p").get<double>(), 0.01);
  EXPECT_LT(lost.at("share").get<double>(), 0.3);
  EXPECT_LT(lost.at("p").get<double>(), 0.01);
}

TEST_F(FoamStudyE2e, NoPreferenceIsReportedAsNone) {
  const json factors = report_of("0", "40").at("task2").at("factors");
  EXPECT_GT(entry(factors, {{"factor", "effects"}}).at("p").get<double>(), 0.01);
}

TEST_F(FoamStudyE2e, ThePageTellsTheLevelsAndTestsNoClaimAboutMethods) {
  const json results = report_of("1", "4");
  EXPECT_THAT(results.at("hypotheses"), IsEmpty());
  EXPECT_EQ(results.at("study").at("protocols")[0].at("effects"),
            (json{{"none", "no effects"}, {"foam", "keeps foam"}}));
  const std::string page = std::regex_replace(base::read_file(page_, 1 << 24), std::regex("<[^>]*>"), "");
  EXPECT_THAT(
      page, AllOf(HasSubstr("Effects were a factor of"), HasSubstr("effects: none over foam"),
                  HasSubstr("LoRes, foam over HiRes, none"), HasSubstr("H4 to H6"), HasSubstr("not tested")));
}

TEST_F(FoamStudyE2e, PowerTellsHowManyPeopleItTakes) {
  const Ended power =
      run_program({vip_stats, "power", foam_protocol(), "--n", "24", "--effect", "0.76", "--studies", "200"});
  ASSERT_EQ(power.exit_code, 0) << power.err;
  EXPECT_THAT(power.out,
              AllOf(HasSubstr("effects supported (true: power)"), HasSubstr("foam over none"),
                    HasSubstr("truth   0.76"), HasSubstr("World \"null\""), Not(HasSubstr("paper"))));
}

TEST_F(FoamStudyE2e, ABundleFreezesTheProtocolWithoutClaimsAboutMethods) {
  const fs::path bundle = folder_ / "bundle";
  const Ended frozen = run_program({vip_stats, "preregister", foam_protocol(), "--out", bundle});
  ASSERT_EQ(frozen.exit_code, 0) << frozen.err;
  EXPECT_EQ(json::parse(base::read_file(bundle / "hypotheses.json", 1 << 20)), json::array());
  EXPECT_THAT(base::read_file(bundle / "PREREGISTRATION.txt", 1 << 20),
              AllOf(HasSubstr("Hypotheses\nNone.\n- Not tested: H1 to H6 of foam: effects are a factor, and "
                              "H1 to H6 are about methods alone"),
                    Not(HasSubstr("estimates a and b"))));
  EXPECT_THAT(base::read_file(bundle / "plan.toml", 1 << 20),
              HasSubstr(study::read_protocol(foam_protocol()).sha256));
  const fs::path pilot = folder_ / "pilot";
  ASSERT_EQ(
      run_program({vip_stats, "preregister", base::resource("protocols/ptpe_pilot.toml"), "--out", pilot})
          .exit_code,
      0);
  EXPECT_THAT(base::read_file(pilot / "PREREGISTRATION.txt", 1 << 20),
              HasSubstr("the study estimates a and b of mu = a exp(b delta).\n"));
}

TEST_F(FoamStudyE2e, CheckNamesLevelsAndStimuli) {
  const std::string found = folder_ / "check.json";
  const Ended ended = run_program({vip_study, "check", foam_protocol(), "--json", found});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("effects \"none\": no effects\n"), HasSubstr("effects \"foam\": keeps foam\n"),
                    HasSubstr("HiRes sea_spray 16k foam"), HasSubstr("6 trials of the design")));
  EXPECT_EQ(json::parse(base::read_file(found, 1 << 20)).at("stimuli")[1].at("effects"), "foam");
}

TEST_F(FoamStudyE2e, CheckSaysThatFreeObstaclesTakePictures) {
  std::string text = shipped_text("foam");
  text = replaced(replaced(text, "sea_spray", "float"), "keep = [\"foam\"]",
                  "effect = [{kind = \"air_drag\", rate_per_s = 1}]");
  base::write_file_atomically(folder_ / "float.toml", text);
  const std::string free = "baked with --keep pictures, because its obstacles are free, 510 frames";
  EXPECT_THAT(run_program({vip_study, "check", folder_ / "float.toml"}).out, HasSubstr(free));
  EXPECT_THAT(run_program({vip_study, "check", foam_protocol()}).out, HasSubstr("  baked, 510 frames"));
}

TEST_F(FoamStudyE2e, CheckRefusesALevelThatTheSceneCannotHaveAtItsPlace) {
  const std::string text = shipped_text("foam"), path = folder_ / "wrong.toml";
  base::write_file_atomically(path, replaced(text, "keep = [\"foam\"]", "keep = [\"heat\"]"));
  const Ended ended = run_program({vip_study, "check", path});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("wrong.toml:25:9: "), HasSubstr("is no effect of scene SeaSpray")));
}

/// The study's scene, coarse and short: 0.5 s around the first foam.
class FoamShownE2e : public ShownStudy {
 protected:
  void SetUp() override { NEEDS_EFFECTS; }
  FoamShownE2e() : ShownStudy("foam", "64x36") {
    base::write_file_atomically(protocol_, replaced(coarse(shipped_text("foam")), "keep = [\"foam\"]",
                                                    "effect = [{kind = \"foam\", emission_per_s = 3}]"));
  }
};

TEST_F(FoamShownE2e, LiveCellsHaveTheEffectsOfTheirLevel) {
  const Ended ended = run({"--participant", "P01"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("live on cpu"), HasSubstr("effects none: no effects, foam: foam "
                                                                    "emission_per_s = 3 ")));
}

TEST_F(FoamShownE2e, BakesHoldTheFoamOfTheirLevelAndArePlayed) {
  const Ended baked = bake();
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const sim::BakeReader with(fs::path(bakes_) / "sea_spray_256_LoRes_foam.bake"),
      without(fs::path(bakes_) / "sea_spray_256_LoRes_none.bake");
  sim::BakeFrame frame;
  with.read_frame(with.header().frame_count - 1, frame);
  EXPECT_FALSE(frame.foam.empty());
  EXPECT_EQ(without.header().max_foam, 0);
  const Ended ended = run({"--participant", "P01", "--stimulus", bakes_});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("sea_spray 256 LoRes none bake"),
                                HasSubstr("sea_spray 256 LoRes foam bake"), Not(HasSubstr("live"))));
  // If the protocol changes a number of the foam, the existing bakes no longer match it.
  replace_in(protocol_, "emission_per_s = 3", "emission_per_s = 4");
  fs::remove(database_);
  const Ended other = run({"--participant", "P01", "--stimulus", bakes_});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("holds foam emission_per_s = 3"));
}

}  // namespace
}  // namespace apps::test
