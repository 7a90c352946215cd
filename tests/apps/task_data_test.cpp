/// Selection of the data of Task 1 and Task 2 for the analysis.

#include "libstudy/analysis/task_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/analysis/tasks/data_json.hpp"
#include "libstudy/analysis/tasks/sensitivity.hpp"
#include "libstudy/analysis/tasks/station_timing.hpp"
#include "libstudy/analysis/tasks/task1_results.hpp"
#include "libstudy/report/sections.hpp"
#include "tests/apps/made_task_study.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

study::TaskStudy of(const study::TaskProtocol& protocol) { return {{protocol}, 0}; }

study::TaskData select(const study::TaskStudy& study, study::TaskKind task = study::TaskKind::Task1,
                       const stats::AnalysisPlan& plan = {}) {
  return study::select_task(study, {task, "", plan}).value();
}

TEST(TaskData, EverythingOfAWholeStudy) {
  const auto data = select(of(made_study::task1(12)));
  EXPECT_THAT(data.participants, SizeIs(12));
  EXPECT_THAT(data.reports, SizeIs(120));
  EXPECT_THAT(data.exclusions, IsEmpty());
  EXPECT_THAT(data.scenes, ElementsAre("single_dam", "jet_impact", "faucet"));
  EXPECT_EQ(data.flow.started, 12);
  EXPECT_EQ(data.flow.analysed, 12);
  EXPECT_EQ(data.flow.trials_analysed, 120);
  EXPECT_THAT(data.gaze_problem(), IsEmpty());
  EXPECT_THAT(select(of(made_study::task2(12)), study::TaskKind::Task2).choices, SizeIs(120));
}

TEST(TaskData, WhoIsPlannedAloneHasNotStarted) {
  auto protocol = made_study::task1(12);
  for (std::size_t i = 9; i < 12; ++i) {
    auto& session = protocol.sessions[i];
    session.state = i < 11 ? "planned" : "open";
    for (auto& trial : session.trials) trial.answers.clear();
  }
  const study::Json flow = study::flow_json(select(of(protocol)).flow);
  EXPECT_EQ(flow.at("planned"), 2);
  EXPECT_EQ(flow.at("started"), 10);
  EXPECT_EQ(flow.at("open"), 1);
  EXPECT_EQ(flow.at("done"), 9);
}

TEST(TaskData, WhoAnsweredASideQuestionAloneWasNotLeftOut) {
  auto protocol = made_study::task2(12);
  for (auto& trial : protocol.sessions[0].trials) trial.answers = {{"fms", 3}};
  const auto flow = select(of(protocol), study::TaskKind::Task2).flow;
  EXPECT_EQ(flow.no_answer, 1);
  EXPECT_EQ(flow.excluded_participants, 0);
  EXPECT_EQ(flow.analysed, 11);
}

TEST(TaskData, TestDataStandBehindRealOnes) {
  auto protocol = made_study::task1(12);
  for (int i = 0; i < 3; ++i) protocol.sessions[static_cast<std::size_t>(i)].test_data = true;
  const auto data = select(of(protocol));
  EXPECT_EQ(data.flow.test_left_out, 3);
  EXPECT_EQ(data.flow.analysed, 9);
  EXPECT_FALSE(data.test_data);
  for (auto& session : protocol.sessions) session.test_data = true;
  const auto test = select(of(protocol));
  EXPECT_TRUE(test.test_data);
  EXPECT_EQ(test.flow.analysed, 12);
}

TEST(TaskData, ObserverModelsStandBehindPeople) {
  auto protocol = made_study::task1(12);
  for (int i = 0; i < 4; ++i) protocol.sessions[static_cast<std::size_t>(i)].observer = "random";
  EXPECT_EQ(select(of(protocol)).flow.simulated_left_out, 4);
  EXPECT_EQ(select(of(protocol)).flow.analysed, 8);
  for (auto& session : protocol.sessions) session.observer = "random";
  const auto data = select(of(protocol));
  EXPECT_THAT(data.simulated, SizeIs(12));
  EXPECT_THAT(data.observers, ElementsAre("random"));
}

TEST(TaskData, SeveralProtocolsAreNeverPooled) {
  auto other = made_study::task1(4);
  other.sha256 = std::string(64, 'f');
  const study::TaskStudy study{{made_study::task1(12), other, made_study::task2(3)}, 0};
  const auto refused = study::select_task(study, {study::TaskKind::Task1, "", {}});
  EXPECT_THAT(refused.reason(), HasSubstr("several protocols are never pooled"));
  EXPECT_EQ(study::select_task(study, {study::TaskKind::Task1, "ff", {}})->flow.analysed, 4);
  EXPECT_EQ(study::select_task(study, {study::TaskKind::Task2, "", {}})->flow.analysed, 3);
  EXPECT_THAT(study::select_task(study, {study::TaskKind::Task1, "aa", {}}).reason(), HasSubstr("aa"));
}

TEST(TaskData, AProtocolOfTestDataStepsBack) {
  auto test = made_study::task1(4);
  test.sha256 = std::string(64, 'f');
  for (auto& session : test.sessions) session.test_data = true;
  EXPECT_EQ(select({{test, made_study::task1(12)}, 0}).flow.analysed, 12);
}

TEST(TaskData, PracticeAndRepeatsAreNoAnswersToTest) {
  auto protocol = made_study::task1(12);
  for (auto& session : protocol.sessions) {
    auto practice = session.trials[2], repeat = session.trials[4];
    practice.kind = "practice";
    practice.position = 10;
    repeat.kind = "repeat";
    repeat.position = 11;
    repeat.repeats = 4;
    session.trials.push_back(practice);
    session.trials.push_back(repeat);
  }
  const auto data = select(of(protocol));
  EXPECT_THAT(data.reports, SizeIs(120));
  EXPECT_EQ(data.flow.practice, 12);
  EXPECT_EQ(data.flow.repeat, 12);
  EXPECT_THAT(data.repeats.at("realism"), SizeIs(12));
}

TEST(TaskData, FailedTimingAndTheExperimenterTakeTrialsOut) {
  auto protocol = made_study::task2(6);
  protocol.sessions[0].trials[3].second->verdict = study::Verdict::Fail;
  protocol.sessions[0].trials[3].second->reason = "40 frames late";
  protocol.sessions[1].trials[7].excluded = "looked away";
  protocol.sessions[2].trials[0].excluded = study::interrupted_reason;
  for (auto& answer : protocol.sessions[2].trials[0].answers) answer.score.reset();
  const auto data = select(of(protocol), study::TaskKind::Task2);
  ASSERT_THAT(data.exclusions, SizeIs(3));
  EXPECT_EQ(data.exclusions[0].reason, "timing verdict fail: 40 frames late");
  EXPECT_EQ(data.exclusions[1].rule, "experimenter");
  EXPECT_EQ(data.exclusions[2].rule, "interruption");
  EXPECT_EQ(data.exclusions[2].answers, 0);
  EXPECT_THAT(data.choices, SizeIs(57));
  EXPECT_EQ(data.flow.trials_excluded, 2) << "of those answered";
}

TEST(TaskData, TimingTellsWhatTheSolverWentByWhereItWasMeasured) {
  auto protocol = made_study::task1(12);
  int measured = 0;
  for (auto& session : protocol.sessions) {
    for (auto& trial : session.trials) {
      if (trial.first.what.method != "Ours-TSp" || measured > 20) continue;
      trial.first.active_fraction = measured % 2 ? 0.5 : 0.75;
      trial.first.tau_fps = measured % 2 ? -8 : -4;
      ++measured;
    }
  }
  bool found = false;
  for (const study::Json& cell : study::timing_json(select(of(protocol)))) {
    if (cell["method"] != "Ours-TSp") {
      EXPECT_TRUE(cell["active_fraction"].is_null() && cell["tau_fps"].is_null()) << cell;
    } else if (!cell["tau_fps"].is_null()) {
      // Means over only the showings that measured them: in this data the active share follows from tau.
      EXPECT_NEAR(cell["active_fraction"].get<double>(), 1 + cell["tau_fps"].get<double>() / 16, 1e-12);
      EXPECT_LT(cell["tau_fps"].get<double>(), -3.9);
      found = true;
    }
  }
  EXPECT_TRUE(found);
}

TEST(TaskData, TimingOfEachStationWhereSeveralRecorded) {
  auto protocol = made_study::task1(12);
  EXPECT_THAT(study::station_timing_json(select(of(protocol))), IsEmpty()) << "one station";
  for (std::size_t i = 0; i < 12; ++i) protocol.sessions[i].station = i < 9 ? "north" : "south";
  auto& slow = protocol.sessions[10].trials[4].first;
  slow.verdict = study::Verdict::Degraded;
  slow.grade = study::TimingGrade::Photodiode;
  slow.realised = {890, 29.5, 32, 9.5};
  slow.longest_ms = 350;
  slow.late = 7;
  const study::Json stations = study::station_timing_json(select(of(protocol)));
  ASSERT_THAT(stations, SizeIs(2));
  EXPECT_EQ(stations[0].at("station"), "north");
  EXPECT_EQ(stations[0].at("showings"), 90);
  EXPECT_EQ(stations[0].at("pass"), 90);
  EXPECT_NEAR(stations[0].at("mean_error_fps").get<double>(), 0.01, 1e-9);
  EXPECT_NEAR(stations[0].at("sd_error_worst_fps").get<double>(), 0.01, 1e-9);
  EXPECT_EQ(stations[1].at("showings"), 30);
  EXPECT_EQ(stations[1].at("degraded"), 1);
  EXPECT_EQ(stations[1].at("grades"), (study::Json{{"A", 1}, {"D", 29}}));
  EXPECT_NEAR(stations[1].at("mean_error_fps").get<double>(), (29 * 0.01 + 0.5) / 30, 1e-9);
  EXPECT_NEAR(stations[1].at("mean_error_worst_fps").get<double>(), 0.5, 1e-9);
  EXPECT_EQ(stations[1].at("late_frames"), 7);
  EXPECT_EQ(stations[1].at("longest_ms"), 350);
  const study::Json root{{"timing_stations", stations}};
  const std::string table = study::report::station_timing(study::report::Field(root), "task1", "Task 1");
  EXPECT_THAT(table, HasSubstr("south</span></th></tr></thead>")) << "a column for each station";
  EXPECT_THAT(table, HasSubstr("350.0"));
  EXPECT_THAT(study::report::station_timing(study::report::Field(root), "task2", ""), IsEmpty());
}

TEST(TaskData, NoRuleSeesMethodsOrScenes) {
  auto protocol = made_study::task1(12);
  protocol.sessions[0].trials[3].first.verdict = study::Verdict::Fail;
  for (auto& trial : protocol.sessions[1].trials) trial.answers[0].score = 4;
  protocol.sessions[2].catches = {{"attention", 2, 5}};
  const auto list = [](const study::TaskData& data) {
    std::vector<std::string> lines;
    for (const auto& one : data.exclusions)
      lines.push_back(one.participant + " " + std::to_string(one.position) + " " + one.rule + " " +
                      one.reason);
    return lines;
  };
  stats::AnalysisPlan plan;
  plan.exclusions.straight_lining_answers = 8;
  const auto before = list(select(of(protocol), study::TaskKind::Task1, plan));
  ASSERT_THAT(before, SizeIs(3));
  for (auto& session : protocol.sessions) {
    for (auto& trial : session.trials) {
      auto& method = trial.first.what.method;
      const auto at = std::find(made_study::methods.begin(), made_study::methods.end(), method);
      method = made_study::methods[static_cast<std::size_t>((at - made_study::methods.begin() + 2) % 5)];
      trial.first.what.n_star = trial.first.what.n_star == "16k" ? "32k" : "16k";
    }
  }
  EXPECT_EQ(list(select(of(protocol), study::TaskKind::Task1, plan)), before);
}

TEST(TaskData, VisitsOfOnePersonAreOneParticipant) {
  auto protocol = made_study::task1(6);
  auto second = made_study::task1(6, "tracked", 9).sessions[0];
  second.visit = 2;
  protocol.sessions.push_back(second);
  const auto data = select(of(protocol));
  EXPECT_THAT(data.participants, SizeIs(6));
  EXPECT_THAT(data.reports, SizeIs(70));
  const auto tables = study::score_tables(data, {});
  const auto mean =
      0.5 * (*protocol.sessions[0].trials[0].answers[0].score + *second.trials[0].answers[0].score);
  EXPECT_EQ(tables[0].column(0, 0)[0], mean);
}

TEST(TaskData, TwoVisitsOfTask2AreRefusedInTheTestOnly) {
  auto protocol = made_study::task2(6);
  auto second = made_study::task2(6, "tracked", 9).sessions[0];
  second.visit = 2;
  protocol.sessions.push_back(second);
  const auto data = select(of(protocol), study::TaskKind::Task2);
  EXPECT_THAT(data.choices, SizeIs(70));
  EXPECT_FALSE(stats::count_preferences(data.choices, 5, {}).at(0).test);
}

TEST(TaskData, AScoreThatLacksAnItemIsMissing) {
  auto protocol = made_study::task1(3);
  protocol.sessions[0].trials[0].answers[2].score.reset();  // the answer about unrealism
  const auto data = select(of(protocol));
  const auto tables = study::score_tables(data, {});
  ASSERT_THAT(tables, SizeIs(3));
  EXPECT_TRUE(std::isnan(tables[1].column(0, 0)[0]));
  EXPECT_FALSE(std::isnan(tables[2].column(0, 0)[0])) << "the score without unrealism does not need it";
  EXPECT_FALSE(std::isnan(tables[0].column(0, 0)[0]));
  const auto& answers = protocol.sessions[1].trials[0].answers;
  EXPECT_EQ(tables[1].column(0, 0)[1],
            (*answers[1].score + *answers[2].score + *answers[3].score + *answers[4].score) / 4.0);
}

TEST(TaskData, GazeThatWasNotTrackedIsNamed) {
  EXPECT_THAT(select(of(made_study::task1(4, "mouse"))).gaze_problem(), HasSubstr("mouse in 4 of 4"));
  auto mixed = made_study::task1(4);
  mixed.sessions[1].gaze_source = "none";
  const auto data = select(of(mixed));
  EXPECT_THAT(data.gaze_problem(), HasSubstr("none in 1 of 4"));
}

TEST(TaskData, NothingToAnalyseIsAReason) {
  EXPECT_THAT(study::select_task({}, {study::TaskKind::Task1, "", {}}).reason(), HasSubstr("no protocol"));
  auto silent = made_study::task1(2);
  for (auto& session : silent.sessions) {
    session.state = "not eligible";
    for (auto& trial : session.trials) {
      for (auto& answer : trial.answers) answer.score.reset();
    }
  }
  EXPECT_THAT(study::select_task(of(silent), {study::TaskKind::Task1, "", {}}).reason(),
              HasSubstr("no answer counts"));
  auto other = made_study::task1(2);
  other.questions.erase(other.questions.begin());
  EXPECT_THAT(study::select_task(of(other), {study::TaskKind::Task1, "", {}}).reason(), HasSubstr("realism"));
}

/// Entry of a sensitivity analysis by its id; null when there is none.
study::Json variant(const study::Json& list, const std::string& id) {
  for (const auto& one : list) {
    if (one.at("id") == id) return one;
  }
  return {};
}

TEST(Sensitivity, TellsWhichVerdictsAnExclusionMakes) {
  auto protocol = made_study::task1(26);
  protocol.sessions[3].gaze_source = "none";
  for (auto& trial : protocol.sessions[0].trials) trial.answers[0].score = 1;
  const auto study = of(protocol);
  study::TaskSelection selection{study::TaskKind::Task1, "", {}};
  selection.plan.exclusions.straight_lining_answers = 8;
  const auto data = study::select_task(study, selection).value();
  const auto list = study::sensitivity_json(study, selection, data, study::task1_verdicts(data, {}));
  EXPECT_EQ(variant(list, "planned").at("participants"), 25);
  EXPECT_THAT(variant(list, "planned").at("changed"), IsEmpty());
  EXPECT_EQ(variant(list, "no_exclusions").at("participants"), 26);
  EXPECT_EQ(variant(list, "tracked_gaze_only").at("participants"), 24);
  EXPECT_EQ(variant(list, "tracked_gaze_only").at("hypotheses")[0].at("status"),
            variant(list, "planned").at("hypotheses")[0].at("status_if_testable"));
  EXPECT_TRUE(variant(list, "blocks_pooled").is_null()) << "nobody has two blocks at one n_*";
}

TEST(Sensitivity, PoolsBlocksWhereAveragingMatters) {
  auto protocol = made_study::task1(12);
  for (auto& trial : protocol.sessions[0].trials) trial.first.what.n_star = "16k";
  const auto study = of(protocol);
  const study::TaskSelection selection{study::TaskKind::Task1, "", {}};
  const auto data = study::select_task(study, selection).value();
  const auto list = study::sensitivity_json(study, selection, data, study::task1_verdicts(data, {}));
  const auto pooled = variant(list, "blocks_pooled");
  EXPECT_EQ(pooled.at("participants"), 24);
  EXPECT_EQ(pooled.at("hypotheses")[0].at("tests")[0].at("n"), 13);
  EXPECT_EQ(variant(list, "planned").at("hypotheses")[0].at("tests")[0].at("n"), 12);
}

}  // namespace
}  // namespace apps
