/// vip-study check as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "libstudy/check/measured_check.hpp"
#include "libstudy/check/refresh_check.hpp"
#include "libstudy/check/session_outline.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

apps::test::Ended vip_study(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-study " + arguments);
}

study::Protocol shipped(const std::string& name) {
  return study::read_protocol(base::resource("protocols/" + name + ".toml"));
}

TEST(VipStudyCheckE2e, ReportsThePilotOn90Hz) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto outcome = vip_study("check protocols/ptpe_pilot.toml --refresh 90 --json " + json_path.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, testing::HasSubstr("14 exact, 7 approximate, 0 unreachable of 21"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("play speed: 0.17 to 0.83 of real time"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("gaze: not needed"));
  const auto json = base::Json::parse(base::read_file(json_path, 1 << 20));
  EXPECT_EQ(json.at("exact"), 14);
  EXPECT_EQ(json.at("settings").size(), 21u);
  EXPECT_EQ(json.at("common_refreshes").size(), 11u);
  // Five to seven minutes with the answers (our reading of the paper's protocol).
  EXPECT_GE(json.at("plan_with_answers_s").at(0), 5 * 60);
  EXPECT_LE(json.at("plan_with_answers_s").at(1), 7 * 60);
  for (const auto& setting : json.at("settings")) {
    EXPECT_LE(setting.at("longest_hold_ms"), 250);
    EXPECT_EQ(setting.at("status") == "exact", setting.at("reason") == "");
  }
}

TEST(VipStudyCheckE2e, AMeasuredRateCountsAsInRun) {
  const study::test::TemporaryFolder folder;
  const std::string protocol = folder / "short.toml";
  std::ofstream(protocol) << apps::test::short_protocol("2");
  const auto check = [&](const std::string& refresh_hz) {
    const auto outcome = vip_study("check " + protocol + " --refresh " + refresh_hz + " 2>/dev/null");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
    return outcome.out;
  };
  const std::string whole = check("60");
  EXPECT_THAT(whole, testing::HasSubstr("3 exact"));
  const std::string counts =
      "59.94 Hz counts as 60 Hz, as in run: holds are whole periods of it, and each showing is "
      "0.10 % slower\n\n";
  EXPECT_EQ(apps::test::replaced(check("59.94"), counts, ""), whole);
}

TEST(VipStudyCheckE2e, BadInputGivesOneErrorAndNoFile) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto broken = folder / "broken.toml";
  std::ofstream(broken) << "format = 2\nname = \"x\"\nversion = 3\n";
  const auto outcome = vip_study("check " + broken.string() + " --refresh 90 --json " + json_path.string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, testing::HasSubstr("broken.toml:3:11: 'version' must be text"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("mend: "));
  EXPECT_FALSE(std::filesystem::exists(json_path));
  EXPECT_EQ(vip_study("check " + broken.string() + " --refresh 0").exit_code, 2);
  EXPECT_EQ(vip_study("check").exit_code, 2);
}

TEST(VipStudyCheckE2e, ReportsBlocksBalanceAndStimuliOfTask1) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto outcome = vip_study("check protocols/task1.toml --json " + json_path.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr("10 trials: stimulus 30 s, ask 5, rest 30 s; 120 s between groups"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("does not divide by 12: 24 or 36 would"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("Ours-TSp faucet 32k"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("gaze: needed"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("cut, and fails, when it goes on for 30 s past its 30 s"));
  const auto json = base::Json::parse(base::read_file(json_path, 1 << 20));
  EXPECT_EQ(json.at("timing"), "table2");
  EXPECT_EQ(json.at("overrun_s"), 30);
  EXPECT_EQ(json.at("trials"), 10);
  EXPECT_EQ(json.at("blocks").size(), 4u);
  EXPECT_EQ(json.at("stimuli").size(), 30u);
  EXPECT_EQ(json.at("balance").at("even_above"), 36);
  EXPECT_FALSE(json.contains("settings"));  // no refresh was given
}

TEST(VipStudyCheckE2e, ListsCellsOfFactorsAndWhatTheDisplayMakesOfTheirProfiles) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto outcome = vip_study("check hitches --refresh 60 --json " + json_path.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr("  h50    drop               HiRes droplet 8k     60 frames/s, a "
                                 "hitch of 50 ms every 2 s, jitter 0.5\n"));
  EXPECT_THAT(outcome.out,
              testing::ContainsRegex("a hitch of 50 ms every 2 s, jitter 0.5 +236  exact +59.0000"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("reported by cell: stall\n"));
  EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("not tested")));
  const auto json = base::Json::parse(base::read_file(json_path, 1 << 20));
  EXPECT_EQ(json.at("cells").size(), 12u);
  EXPECT_EQ(json.at("cells").at(8).at("levels").at("content"), "drop");
  EXPECT_EQ(json.at("factors").at(1).at("vary"), "between");
  EXPECT_EQ(json.at("settings").at(2).at("timing"), "60 frames/s, a hitch of 50 ms every 2 s, jitter 0.5");
  EXPECT_EQ(json.at("analyses").at("by_cell").at(0), "stall");
  EXPECT_TRUE(json.at("analyses").at("not_tested").empty());
}

TEST(VipStudyCheckE2e, SaysWhatAnAdaptiveProcedureChoosesFrom) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto outcome = vip_study("check hitch_quest --json " + json_path.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out,
              testing::HasSubstr("quest_plus chooses the level of hitch by the answers to stall; 1 "
                                 "track of 40 trials in a session\n"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("candidate levels (hitch_ms): h17 (16.667), h33 (33.333), "));
  const auto procedure = base::Json::parse(base::read_file(json_path, 1 << 20)).at("procedure");
  EXPECT_EQ(procedure.at("tracks"), 1);
  EXPECT_EQ(procedure.at("values").size(), 12u);
  // The standard, level 0 ms, is not listed among the candidate levels.
  const auto staircase = vip_study("check " VIP_TEST_DIR "/fuzz/corpus/protocol/staircase.toml");
  EXPECT_THAT(staircase.out,
              testing::HasSubstr("candidate levels (latency_ms): l40 (40), l80 (80), l120 (120)\n"));
  EXPECT_THAT(staircase.out, testing::HasSubstr("starts at l120, down after 2, up after 1; leads to 70.7 %"));
}

TEST(VipStudyTraceE2e, PrintsTheTimingOfALevelAndRefusesJunk) {
  const study::test::TemporaryFolder folder;
  const auto file = folder / "game.csv";
  std::ofstream(file) << "MsBetweenPresents\n10\n20\n30\n";
  const auto outcome = vip_study("trace " + file.string());
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, testing::EndsWith("\ntiming = {profile = \"trace\", frame_ms = [10, 20, 30]}\n"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("MsBetweenPresents: 3 frames in 0.060 s, mean 50.00"));
  std::ofstream(file, std::ios::app) << "x\n";
  const auto refused = vip_study("trace " + file.string());
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, testing::HasSubstr("game.csv:5: \"x\" is no frame time"));
}

TEST(VipStudyCheckE2e, MeasuringNeedsTheRefresh) {
  const auto outcome = vip_study("check protocols/demo.toml --measure");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, testing::HasSubstr("add --refresh HZ"));
}

TEST(VipStudyCheckE2e, AMethodThatIsNotThereIsNamed) {
  const study::test::TemporaryFolder folder;
  const auto file = folder / "p.toml";
  std::ofstream(file) << test::with_keys(test::shipped_text("ptpe_pilot"), {{"method", "[\"Best\"]"}});
  const auto outcome = vip_study("check " + file.string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, testing::HasSubstr("'design.method[0]' = \"Best\""));
  EXPECT_THAT(outcome.out, testing::HasSubstr("\"LoRes\", \"HiRes\""));
}

TEST(VipStudyCheckE2e, EveryShippedProtocolIsSound) {
  for (const auto& entry : std::filesystem::directory_iterator(base::resource("protocols"))) {
    if (!entry.is_regular_file()) continue;
    const auto protocol = study::read_protocol(entry.path());
    const auto outline = study::outline_session(protocol);
    EXPECT_GT(outline.trials, 0);
    EXPECT_LT(outline.session_s.least, outline.session_s.most);
    EXPECT_LE(study::check_balance(protocol).even_below, protocol.participants);
  }
}

TEST(VipStudyReferenceE2e, PrintsThePageInDocs) {
  const auto outcome = vip_study("reference");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, base::read_file(VIP_TEST_DIR "/../docs/protocol.md", 1 << 20));
}

TEST(SessionOutline, TasksLastAsThePaperSays) {
  const auto minutes = [](const char* name) {
    const auto span = study::outline_session(shipped(name)).session_s;
    return std::pair(span.least / 60, span.most / 60);
  };
  const auto [task1_least, task1_most] = minutes("task1");
  EXPECT_GE(task1_least, 13);
  EXPECT_LE(task1_most, 22);
  const auto [task2_least, task2_most] = minutes("task2");
  EXPECT_GE(task2_least, 21.5);
  EXPECT_LE(task2_most, 25);
  const auto [demo_least, demo_most] = minutes("demo");
  EXPECT_GE(demo_most, 8);
  EXPECT_LE(demo_most, 12);
}

TEST(SessionOutline, BalanceNamesTheNextEvenNumbers) {
  auto protocol = shipped("task1");
  auto balance = study::check_balance(protocol);
  EXPECT_EQ(balance.sequences, 12);
  EXPECT_EQ(balance.least, 2);
  EXPECT_EQ(balance.most, 3);
  EXPECT_EQ(balance.even_below, 24);
  EXPECT_EQ(balance.even_above, 36);
  protocol.participants = 24;
  balance = study::check_balance(protocol);
  EXPECT_EQ(balance.most, 2);
  EXPECT_EQ(balance.even_above, 24);
  protocol.participants = 5;
  EXPECT_EQ(study::check_balance(protocol).least, 0);
  EXPECT_EQ(study::check_balance(protocol).even_below, 0);
  protocol.design.order = study::TrialOrder::Williams;
  EXPECT_EQ(study::check_balance(protocol).even, 120);

  auto pairs = shipped("task2");
  EXPECT_EQ(study::check_balance(pairs).even, 6);
  EXPECT_EQ(study::check_balance(pairs).interval_difference, 1);
  EXPECT_THAT(
      study::describe_balance(pairs, study::check_balance(pairs)),
      ::testing::HasSubstr("the numbers of times that the two orders of a pair come differ by at most 1"));
  pairs.participants = 30;
  EXPECT_EQ(study::check_balance(pairs).interval_difference, 0);
  EXPECT_THAT(study::describe_balance(pairs, study::check_balance(pairs)),
              ::testing::AllOf(::testing::HasSubstr("is met by 10 of them"),
                               ::testing::HasSubstr("the two orders of a pair come equally often")));
  EXPECT_EQ(study::check_balance(shipped("ptpe_pilot")).even, 1);
}

/// Every step takes 1 / fps seconds, half of it for drawing.
study::StepTimes steps_at(double fps, std::size_t steps = 60) {
  return {std::vector<double>(steps, 0.5 / fps), std::vector<double>(steps, 0.5 / fps)};
}

/// Measured step times for each cell of the protocol, all at `fps`.
std::vector<study::MeasuredStimulus> all_at(const study::Protocol& protocol, double fps) {
  std::vector<study::MeasuredStimulus> out;
  for (std::size_t i = 0; i < protocol.design.cells.size(); ++i) {
    const bool temporal = protocol.design.cells[i].stimulus.method == "Ours-TSp";
    out.push_back({{static_cast<int>(i)}, temporal, steps_at(fps)});
  }
  return out;
}

study::MeasuredReport judged(const study::Protocol& protocol,
                             const std::vector<study::MeasuredStimulus>& measured) {
  return study::judge_measured(protocol, measured, 90,
                               [](const auto&) { return std::vector<std::int64_t>(); });
}

study::Protocol native_task1() {
  auto protocol = shipped("task1");
  protocol.design.timing = study::TimingSource::Native;
  for (auto& cell : protocol.design.cells) cell.setting.mean = cell.setting.sd = 0;
  return protocol;
}

TEST(MeasuredCheck, FastMachinesEraseTheConditionsOfNative) {
  const auto protocol = native_task1();
  const auto report = judged(protocol, all_at(protocol, 300));
  EXPECT_THAT(report.collapse, testing::HasSubstr("every method reaches the 90 Hz"));
  EXPECT_FALSE(report.too_slow);
  EXPECT_NEAR(report.cells.front().fps.mean, 90, 1e-9);
  EXPECT_NEAR(report.cells.front().tau_min, 90 - 23.68, 1e-9);
}

TEST(MeasuredCheck, AccelerationThatNeverStartsIsACollapseToo) {
  const auto protocol = native_task1();
  auto frames = all_at(protocol, 60);
  frames.front().times = steps_at(40);
  EXPECT_THAT(judged(protocol, frames).collapse, testing::HasSubstr("never falls below zero"));
  for (auto& one : frames) {
    if (one.temporal) one.times = steps_at(20);
  }
  EXPECT_EQ(judged(protocol, frames).collapse, "");
}

TEST(MeasuredCheck, SlowMachinesAreNamedWithTheirRates) {
  const auto protocol = shipped("task1");
  const auto slow = judged(protocol, all_at(protocol, 30));
  EXPECT_TRUE(slow.too_slow);
  EXPECT_EQ(slow.collapse, "");  // only native timing can collapse
  EXPECT_THAT(slow.cells.front().words, testing::HasSubstr("30 frames/s where 55.25 are asked for"));
  EXPECT_FALSE(judged(protocol, all_at(protocol, 80)).too_slow);
  const auto native = native_task1();
  EXPECT_TRUE(judged(native, all_at(native, 3)).too_slow);
}

TEST(RefreshCheck, CellsOfEqualMomentsAreOneSetting) {
  const auto protocol = shipped("task1");
  const auto settings = study::checked_settings(protocol);
  EXPECT_EQ(settings.size(), 29u);  // two cells of LoRes have equal moments
  std::size_t cells = 0;
  for (const auto& one : settings) cells += one.cells.size();
  EXPECT_EQ(cells, 30u);
  EXPECT_TRUE(study::checked_settings(native_task1()).empty());
}

}  // namespace
