#include "libstudy/store/read/task_answers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "libstudy/store/names.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/version_1.hpp"

namespace study {
namespace {

using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr const char* lab = "protocols/task1_lab.toml";

/// Answers on one page: question and score.
using Page = std::vector<std::pair<std::string, int>>;

void keep(Store& store, const OpenSession& session, const OpenUnit& unit, int attempt, const Page& page,
          bool last) {
  std::vector<KeptAnswer> answers;
  for (const auto& [question, score] : page) answers.push_back({question, {test::score(score), 1}});
  store.answer(session.id, unit, attempt, answers, last, 900);
}

OpenSession open_session(Store& store) { return store.open_runs().at(0).sessions.at(0); }

std::string question_of(const TaskTrial& trial, std::size_t i) { return trial.answers.at(i).question; }

TEST(TaskAnswers, PicturesThatDifferWithinASceneAreNamedAndOthersNot) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pairs();
  Store store(folder / "study.db", Open::Create);
  RunPlan run = test::run_plan(protocol, {"P01", "P02"});
  const SceneFraming drawn{"a.toml", 640, 360, 640, 360, 75, {}, {0, 1}, {}, "R"};
  const SceneFraming copied{"a.toml", 64, 36, 640, 360, 60, {}, {2}, {2}, {}};
  const SceneFraming other{"b.toml", 64, 36, 640, 360, 60, {}, {3}, {3}, "R"};
  run.sessions[0].framing = {drawn, copied, other};
  run.sessions[1].framing = {drawn, other};
  store.add_run(run);
  const TaskStudy study = read_tasks(folder / "study.db");
  const auto& sessions = study.protocols.at(0).sessions;
  EXPECT_EQ(sessions.at(0).mixed_pictures,
            "a.toml: 640x360 px at 75 degrees by R and 64x36 px at 60 degrees by a renderer not known");
  EXPECT_EQ(sessions.at(1).mixed_pictures, "");
}

TEST(TaskAnswers, PairsSayWhichIntervalHeldWhat) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pairs();
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(protocol, {"P01"}));
  const OpenSession session = open_session(store);
  int choice = 1;
  std::map<int, int> given;  // by the trial's position
  for (const OpenUnit& unit : session.units) {
    if (!unit.trial) continue;
    keep(store, session, unit, test::show(store, session, unit), {{"preference", choice}, {"ease", 5}}, true);
    given[*unit.plan.trial] = choice;
    choice = 3 - choice;
  }
  const TaskStudy study = read_tasks(folder / "study.db");
  ASSERT_THAT(study.protocols, SizeIs(1));
  const TaskProtocol& task = study.protocols[0];
  EXPECT_TRUE(task.pairs);
  EXPECT_EQ(task.sha256, protocol.sha256);
  EXPECT_EQ(task.participants, 4);
  EXPECT_THAT(task.methods, ElementsAre("LoRes", "Ours", "HiRes"));
  EXPECT_THAT(task.n_stars, ElementsAre("16k"));
  ASSERT_THAT(task.questions, SizeIs(2));
  ASSERT_THAT(task.sessions, SizeIs(1));
  const TaskSession& read = task.sessions[0];
  EXPECT_EQ(read.participant, "P01");
  EXPECT_EQ(read.observer, "ptpe:a=31,b=0.035");
  EXPECT_EQ(read.station, "north");
  EXPECT_FALSE(read.test_data);
  ASSERT_THAT(read.trials, SizeIs(4));
  const Plan plan = make_plan(protocol, "P01", 7, 0);
  EXPECT_EQ(read.trials[0].kind, "practice");
  for (const TaskTrial& trial : read.trials) {
    const PlannedTrial& planned = plan.trials.at(static_cast<std::size_t>(trial.position));
    EXPECT_EQ(trial.first.what, protocol.design.cells.at(static_cast<std::size_t>(planned.first)).stimulus);
    EXPECT_EQ(trial.second->what,
              protocol.design.cells.at(static_cast<std::size_t>(*planned.second)).stimulus);
    ASSERT_THAT(trial.answers, SizeIs(2));
    EXPECT_EQ(question_of(trial, 0), "preference");
    EXPECT_EQ(trial.answers[0].score, given.at(trial.position));
    EXPECT_TRUE(trial.second->played);
    EXPECT_EQ(trial.first.realised.mean, test::verdict().realised.mean);
  }
}

TEST(TaskAnswers, NativeTimingHasNoVerdict) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01"}));
  const OpenSession session = open_session(store);
  for (const OpenUnit& unit : session.units) {
    if (!unit.trial) continue;
    const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
    TimingVerdict verdict = test::verdict();
    verdict.nominal = {0, 0, 1};
    store.end_presentation(id, 0, 1, {}, verdict);
    break;
  }
  const auto study = read_tasks(folder / "study.db");
  const TaskTrial& trial = study.protocols.at(0).sessions.at(0).trials.at(0);
  EXPECT_TRUE(trial.first.played);
  EXPECT_FALSE(trial.first.verdict.has_value());
  EXPECT_FALSE(trial.second->played);
}

/// A lab session of Task 1 in which the score of every trial follows from its position.
class LabSession : public ::testing::Test {
 protected:
  LabSession() : protocol_(read_protocol(base::resource(lab))), store_(folder_ / "study.db", Open::Create) {
    store_.add_run(test::run_plan(protocol_, {"P01"}));
    for (const OpenUnit& unit : open_session(store_).units) {
      if (unit.trial) {
        answer(unit, 1 + unit.trial->position % 7);
      } else if (protocol_.blocks.at(static_cast<std::size_t>(unit.plan.block)).kind == BlockKind::Catch) {
        keep(store_, open_session(store_), unit, 0, {{"attention_check", 2 + catches_++}}, true);
      }
    }
  }
  void answer(const OpenUnit& unit, int realism) {
    const OpenSession session = open_session(store_);
    const int attempt = test::show(store_, session, unit, 4);
    keep(store_, session, unit, attempt,
         {{"realism", realism},
          {"disorientation", 0},
          {"unrealism", 1},
          {"dizziness", 2},
          {"confusion", 3},
          {"fms", 0}},
         true);
  }
  TaskSession read() const { return read_tasks(folder_ / "study.db").protocols.at(0).sessions.at(0); }
  std::int64_t trial_id(int position) {
    sqlite::Connection database(folder_ / "study.db", Open::Read);
    return database.integer("SELECT trial_id FROM trial WHERE position = " + std::to_string(position));
  }

  test::TemporaryFolder folder_;
  Protocol protocol_;
  Store store_;
  int catches_ = 0;
};

TEST_F(LabSession, RealismAndSicknessStandUnderTheirQuestions) {
  const TaskSession session = read();
  ASSERT_THAT(session.trials, SizeIs(13));  // one practice trial, ten trials, two repeats
  const TaskTrial& trial = session.trials.at(3);
  EXPECT_EQ(trial.kind, "stimulus");
  EXPECT_FALSE(trial.second.has_value());
  std::map<std::string, std::optional<int>> scores;
  for (const TaskAnswer& answer : trial.answers) scores[answer.question] = answer.score;
  EXPECT_EQ(scores.at("realism"), 4);
  EXPECT_EQ(scores.at("disorientation"), 0);
  EXPECT_EQ(scores.at("confusion"), 3);
}

TEST_F(LabSession, RepeatsNameTheirOriginals) {
  const TaskSession session = read();
  int repeats = 0;
  for (const TaskTrial& trial : session.trials) {
    EXPECT_EQ(trial.repeats.has_value(), trial.kind == "repeat");
    if (!trial.repeats) continue;
    ++repeats;
    const TaskTrial& original = session.trials.at(static_cast<std::size_t>(*trial.repeats));
    EXPECT_EQ(original.kind, "stimulus");
    EXPECT_EQ(original.first.what, trial.first.what);
  }
  EXPECT_EQ(repeats, 2);
}

TEST_F(LabSession, CatchPagesTellWhatAttentionGives) {
  const TaskSession session = read();
  ASSERT_THAT(session.catches, SizeIs(2));
  EXPECT_EQ(session.catches[0].expected, 2);
  EXPECT_EQ(session.catches[0].score, 2);
  EXPECT_EQ(session.catches[1].score, 3);
}

TEST_F(LabSession, AnAnswerThatWasSetAsideDoesNotCount) {
  const std::int64_t id = trial_id(3);
  store_.repeat_trial(open_session(store_).id, id, "the phone rang");
  EXPECT_FALSE(read().trials.at(3).answers.at(0).score.has_value());
  EXPECT_FALSE(read().trials.at(3).first.played);
  for (const OpenUnit& unit : open_session(store_).units) {
    if (unit.trial && unit.trial_id == id) answer(unit, 7);
  }
  EXPECT_EQ(read().trials.at(3).answers.at(0).score, 7);
  EXPECT_TRUE(read().trials.at(3).first.played);
}

TEST_F(LabSession, AnInterruptionBetweenTwoPagesLosesNoAnswer) {
  const std::int64_t id = trial_id(3);
  store_.repeat_trial(open_session(store_).id, id, "");
  const auto unit = [&] {
    for (const OpenUnit& one : open_session(store_).units) {
      if (one.trial && one.trial_id == id) return one;
    }
    throw std::logic_error("the trial is done");
  };
  const OpenSession session = open_session(store_);
  const int judged = test::show(store_, session, unit(), 4);
  keep(store_, session, unit(), judged,
       {{"realism", 6}, {"disorientation", 0}, {"unrealism", 1}, {"dizziness", 2}, {"confusion", 3}}, false);
  const int again = test::show(store_, session, unit(), 4);
  ASSERT_GT(again, judged);
  keep(store_, session, unit(), again, {{"fms", 2}}, true);
  const TaskTrial trial = read().trials.at(3);
  EXPECT_EQ(trial.answers.at(0).score, 6);
  EXPECT_EQ(trial.answers.at(5).score, 2);
  EXPECT_TRUE(trial.first.played);
}

TEST_F(LabSession, ExclusionsCarryTheExperimentersReason) {
  store_.exclude_trial(open_session(store_).id, trial_id(5), "looked away");
  const TaskSession session = read();
  EXPECT_EQ(session.trials.at(5).excluded, "looked away");
  EXPECT_FALSE(session.trials.at(4).excluded.has_value());
}

TEST(TaskAnswers, WhatUnblindedTheExperimenterStandsWithTheSession) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01", "P02", "P03"}));
  const auto sessions = store.open_runs().at(0).sessions;
  store.log(sessions.at(0).id, "resumed", "");
  store.log(sessions.at(1).id, mirror_event, "");
  store.log(sessions.at(2).id, revealed_event, "");
  store.log(sessions.at(2).id, revealed_event, "");
  store.log(sessions.at(2).id, mirror_event, "");
  const auto read = read_tasks(folder / "study.db").protocols.at(0).sessions;
  EXPECT_EQ(read.at(0).unblinded, "");
  EXPECT_EQ(read.at(1).unblinded, "mirror opened");
  EXPECT_EQ(read.at(2).unblinded, "mirror opened and setting revealed");
}

TEST(TaskAnswers, TheNameOfAnOutsideEyeTrackerStandsWithTheSession) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01", "P02"}));
  const auto sessions = store.open_runs().at(0).sessions;
  for (const char* device : {"B", "A", "A"}) {
    const TrackerClock clock{"tcp:7", device, {}, 1, 2, 3};
    store.add_tracker_clocks(sessions.at(1).id, {&clock, 1});
  }
  const auto read = read_tasks(folder / "study.db").protocols.at(0).sessions;
  EXPECT_EQ(read.at(0).tracker, "");
  EXPECT_EQ(read.at(1).tracker, "A and B");
}

TEST(TaskAnswers, AnglesAreThoseOfWhatWasShown) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  RunPlan run = test::run_plan(test::pilot(), {"P01", "P02", "P03"});
  for (auto& session : run.sessions) session.display = "window";
  run.sessions[1].framing.clear();
  run.sessions[2].display = "none";
  store.add_run(run);
  const auto sessions = store.open_runs().at(0).sessions;
  const auto is_trial = [](const OpenUnit& unit) { return unit.trial.has_value(); };
  for (const OpenSession& session : sessions) {
    const auto unit = std::find_if(session.units.begin(), session.units.end(), is_trial);
    test::show(store, session, *unit);
  }
  const auto angles = [&](std::size_t session) {
    return read_tasks(folder / "study.db").protocols.at(0).sessions.at(session).angles;
  };
  const std::string first = "camera 75 degrees, eye 27 degrees, ratio 0.36";
  EXPECT_EQ(angles(0), first);
  EXPECT_EQ(angles(1), "not known") << "as an earlier version wrote it";
  EXPECT_EQ(angles(2), "") << "nothing was drawn";
  auto framing = run.sessions[0].framing;
  framing[0].visual_angle_deg = 20;
  store.add_framing(sessions[0].id, framing);
  EXPECT_EQ(angles(0), first) << "nothing was shown on it yet";
  const auto& units = sessions[0].units;
  test::show(store, sessions[0], *std::find_if(units.rbegin(), units.rend(), is_trial));
  EXPECT_EQ(angles(0), "camera 75 degrees, eye 20 degrees, ratio 0.27; " + first);
}

TEST(TaskAnswers, APilotShowsOneMethodAtManySettings) {
  const test::TemporaryFolder folder;
  Store(folder / "study.db", Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto study = read_tasks(folder / "study.db");
  ASSERT_THAT(study.protocols, SizeIs(1));
  EXPECT_TRUE(study.protocols[0].pilot());
  std::set<std::pair<double, double>> settings;
  for (const auto& trial : study.protocols[0].sessions.at(0).trials)
    settings.emplace(trial.first.nominal.mean, trial.first.nominal.sd);
  EXPECT_THAT(settings, SizeIs(21));
  EXPECT_THROW(read_tasks(folder / "none.db"), base::Error);
}

TEST(TaskAnswers, ADatabaseOfTheFirstVersionHoldsItsPilot) {
  const test::TemporaryFolder folder;
  test::write_version_1(folder / "old.db");
  const auto study = read_tasks(folder / "old.db");
  ASSERT_THAT(study.protocols, SizeIs(1));
  EXPECT_TRUE(study.protocols[0].pilot());
  EXPECT_EQ(study.protocols[0].name, "pilot");
  ASSERT_THAT(study.protocols[0].questions, SizeIs(1));
  EXPECT_EQ(study.protocols[0].questions[0].id, "satisfaction");
  const auto& trials = study.protocols[0].sessions.at(0).trials;
  ASSERT_THAT(trials, SizeIs(2));
  EXPECT_EQ(trials[0].first.nominal.mean, 20);
  EXPECT_EQ(trials[0].first.nominal.sd, 5);
  EXPECT_EQ(trials[0].answers.at(0).score, 5);
  EXPECT_EQ(trials[1].first.verdict, Verdict::Fail);
}

// The camera's angle and the visual angle of a session of an earlier version are not known, neither before
// nor after the upgrade.
TEST(TaskAnswers, AnEarlierVersionsAnglesAreNotKnown) {
  const test::TemporaryFolder folder;
  test::write_version_1(folder / "old.db");
  sqlite::Connection(folder / "old.db", Open::Write).execute("UPDATE session SET display = 'headless'");
  const auto angles = [&] { return read_tasks(folder / "old.db").protocols.at(0).sessions.at(0).angles; };
  EXPECT_EQ(angles(), "not known");
  Store(folder / "old.db", Open::Write);
  EXPECT_EQ(angles(), "not known");
}

}  // namespace
}  // namespace study
