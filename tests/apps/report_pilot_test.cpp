/// The report about a pilot: exclusions with reasons, where people looked, timing of showings.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "apps/stats/fit_text.hpp"
#include "libstudy/analysis/ptpe/estimates_json.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_walk.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace apps {
namespace {

using made_study::results_of;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing_pilot::simulated_pilot;

/// The page's text without its tags.
std::string words_of(const study::Json& json) {
  std::string out;
  for (const auto& text : html_reader::read(study::report::results_page(json)).texts)
    if (!text.within("style")) out += text.words;
  return out;
}

study::TaskProtocol pilot_of_people(int participants = 8) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", participants, 3);
  for (auto& session : pilot.sessions) session.observer.clear();
  return pilot;
}

// One trial is excluded by hand, and the showing of another trial failed.
TEST(ReportPilot, WhatWasLeftOutByHandAndByRuleIsListed) {
  auto pilot = pilot_of_people();
  EXPECT_THAT(results_of({{pilot}, 0}).at("exclusions"), IsEmpty());
  auto& trials = pilot.sessions[2].trials;
  trials[5].excluded = "the phone rang";
  trials[9].first.verdict = study::Verdict::Fail;
  trials[9].first.reason = "cut after 8 s";
  const study::Json json = results_of({{pilot}, 0});
  EXPECT_EQ(json.at("flow").at("pilot").at("trials_excluded"), 2);
  EXPECT_EQ(json.at("pilot").at("n_ratings"), 8 * 21 - 2);
  EXPECT_EQ(json.at("flow").at("pilot").at("trials_analysed"), 166);
  EXPECT_EQ(json.at("flow").at("pilot").at("trials_planned"), 168);
  EXPECT_THAT(words_of(json), AllOf(HasSubstr("the phone rang"), HasSubstr("cut after 8 s")));
}

TEST(ReportPilot, GazeDisplayFlowAndTimingArePrintedAsForTheTasks) {
  auto pilot = pilot_of_people();
  pilot.sessions[1].gaze_source = "tracked";
  pilot.sessions[1].tracker = pilot.sessions[2].tracker = "XR-9";  // the gaze of session 2 was not tracked
  pilot.sessions[2].trials[9].first.verdict = study::Verdict::Fail;
  pilot.sessions[3].state = "stopped";
  const study::Json json = results_of({{pilot, made_study::task1(6)}, 0});
  const auto html = study::report::results_page(json);
  EXPECT_THAT(words_of(json), AllOf(HasSubstr("mouse: 7, tracked: 1"), HasSubstr("window: 8"),
                                    HasSubstr("an eye tracker outside OpenXR in: XR-9: 1.")));
  EXPECT_EQ(json.at("flow").at("pilot").at("started"), 8);
  EXPECT_EQ(json.at("flow").at("pilot").at("done"), 7);
  EXPECT_NE(html.find("id=\"flow-pilot-title\""), std::string::npos);
  EXPECT_NE(html.find("id=\"timing-pilot-title\""), std::string::npos);
  int showings = 0, failed = 0;
  for (const auto& cell : json.at("timing")) {
    if (cell.at("task") != "pilot") continue;
    showings += cell.at("showings").get<int>();
    failed += cell.at("fail").get<int>();
  }
  EXPECT_EQ(showings, 8 * 21);
  EXPECT_EQ(failed, 1) << "a showing that was left out is still part of the certificate";
  // The pilot's only method does not use gaze.
  EXPECT_EQ(json.at("study").at("tracked_gaze"), true);
}

TEST(ReportPilot, ThePapersTwoLevelsStandOnThePapersScaleAlone) {
  const auto levels = [](const study::TaskProtocol& pilot) {
    std::set<double> out;
    const study::Json json = results_of({{pilot}, 0});
    for (const auto& one : json.at("pilot").at("estimators")) out.insert(one.at("level").get<double>());
    return out;
  };
  auto pilot = pilot_of_people();
  EXPECT_EQ(levels(pilot), (std::set<double>{4, 5}));
  pilot.questions[0].scale_min = 0;
  pilot.questions[0].scale_max = 10;
  EXPECT_EQ(levels(pilot), (std::set<double>{5}));
}

TEST(ReportPilot, WhoIsSimulatedHasNoTimes) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 8, 3);
  for (auto& session : pilot.sessions)
    for (auto& trial : session.trials) trial.answers[0].response_time_s = 0;
  const std::string why = "simulated participants take no time to answer";
  const study::Json json = results_of({{pilot}, 0});
  const study::Json& times = json.at("response_times").at(0);
  EXPECT_EQ(times.at("n"), 8 * 21);
  for (const char* figure : {"mean", "sd", "median", "q1", "q3", "min", "max"})
    EXPECT_TRUE(times.at(figure).is_null()) << figure;
  EXPECT_EQ(times.at("reason"), why);
  EXPECT_THAT(words_of(json), HasSubstr("Not given: " + why + "."));
  for (auto& session : pilot.sessions) session.observer.clear();
  EXPECT_EQ(results_of({{pilot}, 0}).at("response_times").at(0).at("mean"), 0) << "of a person as measured";
}

TEST(ReportPilot, TheRulesOfTheTasksAreAppliedAndNamed) {
  auto pilot = pilot_of_people();
  for (auto& trial : pilot.sessions[0].trials) trial.answers[0].score = 4;
  pilot.sessions[1].catches = {{"attention", 2, 5}};
  auto plan = made_study::quick_plan();
  plan.plan.exclusions.straight_lining_answers = 8;
  const study::Json json = results_of({{pilot, made_study::task2(6)}, 0}, plan);
  EXPECT_EQ(json.at("pilot").at("n_participants"), 6);
  EXPECT_EQ(json.at("exclusions").at(0).at("rule"), "straight_lining");
  EXPECT_EQ(json.at("exclusions").at(1).at("rule"), "catch");
  EXPECT_EQ(json.at("flow").at("pilot").at("excluded_participants"), 2);
  EXPECT_THAT(words_of(json), AllOf(HasSubstr("exclusion for Pilot: "), HasSubstr("exclusion for Task 2: ")));
}

// Earlier versions printed only "nothing was left out" about a part of which no answer counts.
TEST(ReportPilot, APartOfWhichNothingIsLeftStillSaysWhy) {
  auto pilot = pilot_of_people(3);
  for (auto& session : pilot.sessions)
    for (auto& trial : session.trials) trial.excluded = "the screen was off";
  auto task = made_study::task1(4);
  for (auto& session : task.sessions) session.catches = {{"attention", 2, 5}};
  const study::Json json = results_of({{pilot, task}, 0});
  EXPECT_EQ(json.at("exclusions").size(), 3 * 21 + 4u);
  EXPECT_EQ(json.at("flow").at("task1").at("excluded_participants"), 4);
  EXPECT_EQ(json.at("flow").at("pilot").at("excluded_participants"), 3);
  EXPECT_THAT(words_of(json),
              AllOf(HasSubstr("No fit: no answer counts"), HasSubstr("Not given: no answer counts"),
                    HasSubstr("the screen was off"), Not(HasSubstr("Nothing of"))));
}

TEST(ReportPilot, TheBannerNamesEveryObserverAndCountsEachPersonOnce) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 8, 3);
  pilot.sessions[7].observer = "random";
  auto task = made_study::task1(6);
  for (std::size_t i = 0; i < 6; ++i) {
    task.sessions[i].participant = "p" + std::to_string(i + 4);  // p4 to p7 took part in the pilot
    task.sessions[i].observer = "frames:grain=4";
  }
  const study::Json json = results_of({{pilot, task}, 0});
  EXPECT_EQ(json.at("study").at("simulated"), 10);
  EXPECT_THAT(
      words_of(json),
      HasSubstr("10 (frames:grain=4, ptpe:a=24,b=0.02, random). All answers of Pilot (pilot, version 1.0) "
                "and Task 1 (task1, version 1.0) come"));
  for (auto& session : task.sessions) session.observer.clear();
  EXPECT_THAT(words_of(results_of({{pilot, task}, 0})),
              HasSubstr("8 (ptpe:a=24,b=0.02, random). All answers of Pilot (pilot, version 1.0) come"));
}

TEST(ReportPilot, AProtocolOfTestDataThatStepsBackIsNamed) {
  auto test = pilot_of_people();
  test.sha256 = std::string(64, 'f');
  test.name = "rehearsal";
  for (auto& session : test.sessions) session.test_data = true;
  const study::Json json = results_of({{test, pilot_of_people()}, 0});
  EXPECT_EQ(json.at("pilot").at("n_participants"), 8);
  EXPECT_THAT(words_of(json), HasSubstr("rehearsal 1.0, SHA-256 ffffffffffff, 8 sessions, left out"));
}

/// The text that vip-stats fit-ptpe prints for the pilot of these results.
std::string terminal_of(const study::TaskProtocol& pilot) {
  const auto data = study::collect_task({{pilot}, 0}, {study::TaskKind::Pilot, {}, {}});
  ::testing::internal::CaptureStdout();
  print_fit(study::fit_pilot(*data, 4, {200, 1, 0.95}));
  return ::testing::internal::GetCapturedStdout();
}

int count_of(const std::string& text, const std::string& words) {
  int n = 0;
  for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++n;
  return n;
}

// No protocol shows more than 1000 frames/s, so an interval that reaches beyond has no upper bound.
TEST(ReportPilot, AnIntervalWithoutUpperBoundSaysSoOnPageAndTerminal) {
  const auto pilot = simulated_pilot("ptpe:a=30,b=0.03,slope=0.04,noise=2", 6, 2);
  study::Json json = results_of({{pilot}, 0});
  const auto page = html_reader::read(study::report::results_page(json));
  std::set<std::string> printed;
  for (const auto& text : page.texts) printed.insert(text.attribute("data-field"));
  int unbounded = 0, bounded = 0, on_terminal = 0;
  const study::Json& bands = json.at("pilot").at("bands");
  for (std::size_t i = 0; i < bands.size(); ++i) {
    for (const char* key : {"ci", "simultaneous_ci", "solver_ci"}) {
      if (!bands[i].at(key).is_array()) continue;
      const auto place = "/pilot/bands/" + std::to_string(i) + "/" + key + "/";
      const bool open = bands[i].at(key).at(1) > 1000;
      EXPECT_TRUE(printed.contains(place + "0"));
      EXPECT_EQ(printed.contains(place + "1"), !open) << place;
      ++(open ? unbounded : bounded);
      const bool shown = bands[i].at("level") == 4 && bands[i].at("delta").get<int>() % 5 == 0;
      on_terminal += open && shown && key == std::string("ci");
    }
  }
  EXPECT_GT(bounded, 5);
  EXPECT_GT(on_terminal, 2);
  EXPECT_EQ(count_of(words_of(json), ", no upper bound]"), unbounded);
  EXPECT_EQ(count_of(terminal_of(pilot), ", no upper bound]"), on_terminal);
}

// JSON has no infinite number, so an infinite end of an interval is a word in the results.
TEST(ReportPilot, AnInfiniteEndIsAWordInTheResultsAndSaidOnThePage) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  study::Json estimate;
  study::add_estimate(
      estimate, {study::MainFit{24, 0.02}, study::MainSpread{{20, infinite}, {-infinite, 0.5}, 1, 1, false}});
  EXPECT_EQ(estimate.at("a_ci"), study::Json({20, "Inf"}));
  EXPECT_EQ(estimate.at("b_ci"), study::Json({"-Inf", 0.5}));
  study::Json json = results_of({{pilot_of_people()}, 0});
  json.at("pilot").update(estimate);
  const auto page = words_of(json);
  EXPECT_EQ(count_of(page, "[20.00, no upper bound]"), 3) << "sentence, table and figure";
  EXPECT_EQ(count_of(page, "[\u2212\u221e, 0.5000]"), 3);
  EXPECT_THAT(report_walk::wrong_fields(html_reader::read(study::report::results_page(json)), json),
              IsEmpty());
}

}  // namespace
}  // namespace apps
