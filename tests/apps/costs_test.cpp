/// Cost and error of frames in the report, next to the answers.
#include "libstudy/analysis/tasks/costs_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/setting/setting_file.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/measured_setting.hpp"
#include "tests/apps/small_sweep.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t n_star = 16 * 1024;

std::string sha256_of_dam() { return sim::scenes_of("SingleDam").front().scene.sha256; }

/// Sessions whose recorded stimulus names all scene files as shown live.
study::TaskProtocol shown_live() {
  auto out = made_study::task1(6);
  std::string stimulus = "live on cpu";
  for (const auto& scene : sim::scenes_of("all"))
    stimulus += ", scene " + scene.name + " " + scene.scene.sha256;
  for (auto& session : out.sessions) session.stimulus = stimulus;
  return out;
}

std::string setting_text(const std::string& scene_sha256) {
  auto out = test::measured_setting(test::hires_at(n_star));
  out.setting[sim::SolverKnob::Iterations] = 8;
  out.measured.scene_sha256 = scene_sha256;
  return sim::format_setting_file(out);
}

study::RunSetting recorded(const std::string& text) { return {base::sha256_hex(text), text}; }

study::Json results_of(const study::TaskProtocol& protocol, bool sweep = false) {
  study::ResultsRequest request{"study.db", {study::TaskKind::Task1, study::TaskKind::Task2}, "", {}};
  request.plan.plan.resamples = 200;
  if (sweep) {
    request.sweep =
        std::make_shared<const study::SweepTables>(study::sweep_tables(test::small_sweep(n_star)));
    request.sweep_file = "sweep.db";
  }
  return study::make_results({{protocol}, 0}, request).json;
}

study::Json row_of(const study::Json& json, const std::string& method, const std::string& n = "16k",
                   const std::string& scene = "single_dam") {
  for (const auto& row : json.at("costs"))
    if (row.at("method") == method && row.at("n_star") == n && row.at("scene") == scene) return row;
  return {};
}

TEST(Costs, WithoutASourceTheTableSaysSo) {
  const study::Json json = results_of(shown_live());
  EXPECT_FALSE(json.contains("sweep"));
  const study::Json row = row_of(json, "HiRes");
  EXPECT_EQ(row.at("setting"), "usual");
  EXPECT_TRUE(row.at("made_ms").is_null());
  EXPECT_THAT(row.at("made_ms_reason").get<std::string>(), HasSubstr("no session holds it"));
  EXPECT_TRUE(row.at("shown_ms").is_null());
  EXPECT_THAT(row.at("shown_ms_reason").get<std::string>(), HasSubstr("every showing had a schedule"));
  EXPECT_EQ(row.at("error").at("refused"), "no setting file stands in the record");
  EXPECT_FALSE(row.contains("sweep"));
}

TEST(Costs, TimesAreMeansOverTheSessionsThatHoldThem) {
  auto protocol = shown_live();
  const study::StimulusSpec what{made_study::scenes[0], "HiRes", "16k"};
  // P01 and P04 saw the dam at 16k; P02 did not.
  protocol.sessions[0].frame_costs = {{what, 4, 6}, {what, 6, 8}, {{what.scene, "Ours", "16k"}, 90, 90}};
  protocol.sessions[3].frame_costs = {{what, 11, 13}};
  protocol.sessions[1].frame_costs = {{what, 1000, 1000}};
  const study::Json row = row_of(results_of(protocol), "HiRes");
  EXPECT_EQ(row.at("sessions"), 2);
  EXPECT_EQ(row.at("measured_sessions"), 2);
  EXPECT_EQ(row.at("made_ms"), 8);
  EXPECT_EQ(row.at("made_p95_ms"), 10);
}

TEST(Costs, WithoutAScheduleTheIntervalsAreTheCost) {
  auto protocol = shown_live();
  for (auto& session : protocol.sessions)
    for (auto& trial : session.trials) {
      trial.first.nominal = {};
      trial.first.realised.mean = trial.first.what.method == "LoRes" ? 100 : 50;
    }
  const study::Json json = results_of(protocol);
  EXPECT_DOUBLE_EQ(row_of(json, "LoRes").at("shown_ms"), 10);
  EXPECT_DOUBLE_EQ(row_of(json, "Ours").at("shown_ms"), 20);
}

TEST(Costs, TheErrorOfTheRecordsSettingIsOfItsOwnSceneMethodAndSize) {
  auto protocol = shown_live();
  const std::string text = setting_text(sha256_of_dam());
  for (auto& session : protocol.sessions) session.settings = {recorded(text)};
  const study::Json json = results_of(protocol);
  const study::Json row = row_of(json, "HiRes");
  EXPECT_EQ(row.at("setting_sha256"), base::sha256_hex(text));
  EXPECT_EQ(row.at("error").at("error"), "centre_pct");
  EXPECT_EQ(row.at("error").at("mean"), 0.25);
  EXPECT_EQ(row.at("error").at("high"), 0.3);
  EXPECT_EQ(row_of(json, "HiRes", "16k", "faucet").at("error").at("refused"),
            "the setting was measured on another scene file");
  EXPECT_EQ(row_of(json, "HiRes", "32k").at("setting"), "usual");
  EXPECT_EQ(row_of(json, "Ours").at("setting"), "usual");
  const std::string page = study::report::results_page(json);
  EXPECT_THAT(page, AllOf(HasSubstr("ran at these settings of the solver"), HasSubstr(base::sha256_hex(text)),
                          HasSubstr("says of itself")));

  protocol.sessions[0].settings.clear();
  const study::Json mixed = row_of(results_of(protocol), "HiRes");
  EXPECT_EQ(mixed.at("setting"), "several");
  EXPECT_EQ(mixed.at("error").at("refused"), "its sessions ran at different settings");
  for (auto& session : protocol.sessions) session.stimulus = "a bake";
  EXPECT_FALSE(row_of(results_of(protocol), "HiRes").at("error").contains("mean"));
}

TEST(Costs, ASweepTellsOfUsualSettingsAndOfTheRecords) {
  auto protocol = shown_live();
  const study::Json usual = row_of(results_of(protocol, true), "HiRes");
  ASSERT_EQ(usual.at("sweep").size(), 1u);
  EXPECT_EQ(usual.at("sweep")[0].at("times_hires"), 1);
  EXPECT_EQ(usual.at("sweep")[0].at("ms_mean"), 13.5);
  EXPECT_EQ(usual.at("sweep")[0].at("errors").size(), study::sweep_error_count);
  for (auto& session : protocol.sessions) session.settings = {recorded(setting_text("feed"))};
  const study::Json json = results_of(protocol, true);
  const study::Json eight = row_of(json, "HiRes");
  EXPECT_EQ(eight.at("sweep")[0].at("ms_mean"), 17.5);
  EXPECT_EQ(row_of(json, "HiRes", "16k", "faucet").at("sweep").at("refused"),
            "not measured: the sweep has no table of this scene file");
  EXPECT_EQ(row_of(json, "LoRes").at("sweep").at("refused"), "not measured: the sweep has no row of LoRes");
  protocol.content_step_s = 1.0 / 90;
  EXPECT_THAT(row_of(results_of(shown_live(), true), "HiRes").at("sweep").dump(), HasSubstr("ms_mean"));
  for (auto& session : protocol.sessions) session.settings.clear();
  EXPECT_THAT(row_of(results_of(protocol, true), "HiRes").at("sweep").at("refused").get<std::string>(),
              HasSubstr("frames/s (here 90, there 60)"));
  const std::string page = study::report::results_page(json);
  EXPECT_THAT(page, AllOf(HasSubstr("cost and error in the sweep on"), HasSubstr("centre of mass, %"),
                          Not(HasSubstr("No sweep file was given"))));
}

TEST(Costs, WhatPeopleSaidStandsBesideIt) {
  auto protocol = shown_live();
  double sum = 0;
  int n = 0;
  for (const auto& session : protocol.sessions)
    for (const auto& trial : session.trials)
      if (trial.first.what == study::StimulusSpec{made_study::scenes[0], "Ours", "16k"}) {
        sum += *trial.answers[0].score;
        ++n;
      }
  const study::Json row = row_of(results_of(protocol), "Ours");
  EXPECT_EQ(row.at("answers"), n);
  EXPECT_DOUBLE_EQ(row.at("said"), sum / n);
  // One stimulus of each pair was chosen, so over all methods half of the showings were chosen.
  const study::Json pairs = results_of(made_study::task2(6));
  double chosen = 0, showings = 0;
  for (const auto& one : pairs.at("costs")) {
    chosen += one.at("said").get<double>() * one.at("answers").get<double>();
    showings += one.at("answers").get<double>();
  }
  EXPECT_EQ(showings, 6 * 10 * 2);
  EXPECT_NEAR(chosen, showings / 2, 1e-9);
}

}  // namespace
}  // namespace apps
