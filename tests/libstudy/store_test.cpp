#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/store/database.hpp"
#include "libstudy/store/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

OpenSession only_session(Store& store) { return store.open_runs().at(0).sessions.at(0); }

const OpenUnit& first_trial(const OpenSession& session) {
  for (const OpenUnit& unit : session.units) {
    if (unit.trial) return unit;
  }
  throw std::logic_error("no trial is open");
}

const OpenUnit& unit_of(const OpenSession& session, int position) {
  for (const OpenUnit& unit : session.units) {
    if (unit.plan.position == position) return unit;
  }
  throw std::logic_error("the unit is done");
}

void answer(Store& store, const OpenSession& session, const OpenUnit& unit, int attempt,
            const std::vector<KeptAnswer>& answers, bool last) {
  store.answer(session.id, unit, attempt, answers, last, 900);
}

TEST(Store, WritesTheWholePlanBeforeTheFirstUnit) {
  const test::TemporaryFolder folder;
  for (const Protocol& protocol : {test::pilot(), test::pairs()}) {
    const auto path = folder / (protocol.name + ".db");
    Store(path, Open::Create).add_run(test::run_plan(protocol, {"P01", "P02"}));
    Store store(path, Open::Write);
    const auto runs = store.open_runs();
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].protocol_sha256, protocol.sha256);
    EXPECT_EQ(runs[0].protocol_text, protocol.text);
    ASSERT_EQ(runs[0].sessions.size(), 2u);
    for (const OpenSession& session : runs[0].sessions) {
      const Plan plan = make_plan(protocol, session.plan.participant, 7, 0);
      EXPECT_EQ(session.planned, plan.units.size());
      ASSERT_EQ(session.units.size(), plan.units.size());
      for (std::size_t i = 0; i < plan.units.size(); ++i) {
        const OpenUnit& unit = session.units[i];
        EXPECT_EQ(unit.plan.position, plan.units[i].position);
        EXPECT_EQ(unit.plan.block, plan.units[i].block);
        ASSERT_EQ(unit.plan.trial, plan.units[i].trial);
        if (!unit.trial) continue;
        const PlannedTrial& trial = plan.trials.at(static_cast<std::size_t>(*unit.plan.trial));
        EXPECT_EQ(unit.trial->block, trial.block);
        EXPECT_EQ(unit.trial->first, trial.first);
        EXPECT_EQ(unit.trial->second, trial.second);
        EXPECT_EQ(unit.trial->schedule_seed, trial.schedule_seed);
      }
    }
  }
}

TEST(Store, TakesEveryProtocolThatShips) {
  const test::TemporaryFolder folder;
  int protocols = 0;
  for (const auto& entry : std::filesystem::directory_iterator(base::resource("protocols"))) {
    const Protocol protocol = read_protocol(entry.path());
    SCOPED_TRACE(protocol.name);
    const auto path = folder / (protocol.name + ".db");
    Store(path, Open::Create).add_run(test::run_plan(protocol, {"P01"}));
    sqlite::Connection look(path, Open::Read);
    std::set<std::string> ids;
    for (const auto& [block, question] : all_questions(protocol)) ids.insert(question->id);
    EXPECT_EQ(look.integer("SELECT count(*) FROM question"), static_cast<std::int64_t>(ids.size()));
    // Each page block asks all that stands on it.
    for (const Block& block : protocol.blocks) {
      if (has_trials(block.kind)) continue;
      sqlite::Statement asked(look, "SELECT count(*) FROM ask WHERE block = ?");
      ASSERT_TRUE(asked.bind_all(block.id).step());
      EXPECT_EQ(asked.integer(0), static_cast<std::int64_t>(block.questions.size())) << block.id;
    }
    ++protocols;
  }
  EXPECT_GE(protocols, 7);
}

TEST(Store, GivesASessionBackAsItWasPlanned) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  RunPlan run = test::run_plan(test::pilot(), {"P01"});
  SessionPlan& plan = run.sessions[0];
  plan.visit = 3;
  plan.plan.slot = 5;
  plan.observer.reset();
  plan.gaze_source = "mouse";
  plan.station = "booth 2";
  plan.screen_width_mm = 597.5;
  plan.viewing_distance_mm = 700;
  plan.refresh_hz = 59.94;
  plan.ptpe = "a = 1";
  store.add_run(run);
  const SessionPlan found = only_session(store).plan;
  EXPECT_EQ(found.visit, 3);
  EXPECT_EQ(found.seed, 7u);
  EXPECT_EQ(found.plan.slot, 5);
  EXPECT_FALSE(found.observer);
  EXPECT_TRUE(found.virtual_clock);
  EXPECT_EQ(found.gaze_source, "mouse");
  EXPECT_EQ(found.station, "booth 2");
  EXPECT_EQ(found.screen_width_mm, 597.5);
  EXPECT_EQ(found.viewing_distance_mm, 700);
  EXPECT_EQ(found.refresh_hz, 59.94);
  EXPECT_EQ(found.ptpe, "a = 1");
  EXPECT_EQ(found.time_zone, "UTC");
}

TEST(Store, KeepsHowTheDisplayFramedEachScene) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    RunPlan run = test::run_plan(test::pilot(), {"P01"});
    run.sessions[0].framing = {{"a.toml", 640, 360, 1280, 720, 75, 27.0, {0, 3}, {3}, "R"},
                               {"b.toml", 64, 36, 64, 36, 60, {}, {1}, {}, {}}};
    store.add_run(run);
  }
  sqlite::Connection database(folder / "study.db", Open::Read);
  sqlite::Statement row(
      database,
      "SELECT scene, width_px, height_px, shown_width_px, shown_height_px, camera_angle_deg, "
      "visual_angle_deg, angle_ratio, cells, copied, renderer FROM framing JOIN session USING (session_id) "
      "ORDER BY scene");
  ASSERT_TRUE(row.step());
  EXPECT_EQ(row.text(0), "a.toml");
  EXPECT_EQ(row.integer(1), 640);
  EXPECT_EQ(row.integer(2), 360);
  EXPECT_EQ(row.integer(3), 1280);
  EXPECT_EQ(row.integer(4), 720);
  EXPECT_EQ(row.real(5), 75);
  EXPECT_EQ(row.real(6), 27);
  EXPECT_EQ(row.real(7), 27.0 / 75);
  EXPECT_EQ(row.text(8), "0 3");
  EXPECT_EQ(row.text(9), "3");
  EXPECT_EQ(row.text(10), "R");
  ASSERT_TRUE(row.step());
  EXPECT_EQ(row.real(5), 60);
  EXPECT_TRUE(row.is_null(6)) << "not known";
  EXPECT_TRUE(row.is_null(7));
  EXPECT_TRUE(row.is_null(9) && row.is_null(10));
}

TEST(Store, ASessionResumedOnAnotherDisplayHasItsFramingTooAndEachShowingItsOwn) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const OpenSession session = store.open_runs().at(0).sessions.at(0);
  const auto trials = [&session] {
    std::vector<OpenUnit> out;
    for (const OpenUnit& unit : session.units)
      if (unit.trial) out.push_back(unit);
    return out;
  }();
  const auto count = [&](const std::string& rows) {
    return sqlite::Connection(folder / "study.db", Open::Read).integer("SELECT count(*) FROM " + rows);
  };
  std::vector<SceneFraming> framing = test::session_plan(test::pilot(), "P01").framing;
  test::show(store, session, trials.at(0));
  store.add_framing(session.id, framing);
  EXPECT_EQ(count("framing"), 1) << "the same display";
  framing[0].visual_angle_deg = 20;
  store.add_framing(session.id, framing);
  test::show(store, session, trials.at(1));
  framing[0].visual_angle_deg.reset();
  store.add_framing(session.id, framing);
  test::show(store, session, trials.at(2));
  EXPECT_EQ(count("framing"), 3);
  const std::string shown = "presentation JOIN framing USING (framing_id) WHERE ";
  EXPECT_EQ(count(shown + "visual_angle_deg = 27"), 1);
  EXPECT_EQ(count(shown + "visual_angle_deg = 20"), 1);
  EXPECT_EQ(count(shown + "visual_angle_deg IS NULL"), 1);
}

TEST(Store, TrialsHoldWhatWasShownAndAnswered) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(protocol, {"P01"}));
    const auto session = only_session(store);
    test::answer_one(store, session, first_trial(session), "satisfaction", test::score(6));
  }
  EXPECT_EQ(read_tasks(folder / "study.db").protocols.at(0).sha256, protocol.sha256);
  const auto rows = test::trials_of(folder / "study.db");
  ASSERT_EQ(rows.size(), 21u);
  EXPECT_EQ(rows[0].participant, "P01");
  EXPECT_EQ(rows[0].observer, "ptpe:a=31,b=0.035");
  EXPECT_EQ(rows[0].trial.answers.at(0).question, "satisfaction");
  EXPECT_EQ(rows[0].score(), 6);
  const TaskShowing& shown = rows[0].trial.first;
  EXPECT_EQ(shown.verdict, Verdict::Degraded);
  EXPECT_EQ(shown.grade, TimingGrade::DisplayFeedback);
  EXPECT_EQ(shown.realised.frames, 40u);
  EXPECT_EQ(shown.realised.mean, 49.5);
  EXPECT_EQ(shown.realised.mean_arithmetic, 50.5);
  EXPECT_EQ(shown.realised.sd, 3.25);
  EXPECT_EQ(shown.late, 1);
  EXPECT_EQ(shown.reason, "one frame late");
  EXPECT_FALSE(rows[1].score());
  EXPECT_FALSE(rows[1].trial.first.played);
  EXPECT_FALSE(rows[1].trial.first.verdict);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT lag1 FROM presentation"), "-0.125");
}

TEST(Store, FramesComeBackAsTheyWereRecorded) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01"}));
    const auto session = only_session(store);
    const OpenUnit& unit = first_trial(session);
    const std::int64_t start_ns = 1'000'000'000'000;
    const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, start_ns);
    const auto all = test::frames(start_ns, 40);
    store.add_frames(id, start_ns, std::span(all).first(25));
    store.end_presentation(id, start_ns, start_ns + 800'000'000, std::span(all).subspan(25), test::verdict());
  }
  const auto database = open_database(folder / "study.db", Open::Read, read_schema_steps());
  EXPECT_EQ(database->integer("SELECT count(*) FROM frame"), 40);
  sqlite::Statement row(*database,
                        "SELECT p.start_ns + f.scheduled_ns, p.start_ns + f.scheduled_ns + f.submitted_ns, "
                        "f.actual_display_ns, f.late, f.particles, f.content_step, f.active_fraction, "
                        "f.tau_fps, f.simulation_time_s, f.gpu_done_ns, f.beta, f.mu_fps, f.delta_fps, "
                        "f.speed_limited, f.coincident_pairs, f.not_finite, f.neighbours_dropped, "
                        "f.wall_projected, f.nozzle_waited, f.saliency_not_finite, f.gaze_lost "
                        "FROM frame f JOIN presentation p USING (presentation_id) ORDER BY frame_index");
  for (const FrameRecord& frame : test::frames(1'000'000'000'000, 40)) {
    ASSERT_TRUE(row.step());
    EXPECT_EQ(row.integer(0), frame.scheduled_ns);
    EXPECT_EQ(row.integer(1), frame.times.submitted_ns);
    EXPECT_TRUE(row.is_null(2));
    EXPECT_EQ(row.integer(3) != 0, frame.late);
    EXPECT_EQ(row.text(4), "100 800");
    EXPECT_EQ(row.integer(5), frame.content_step);
    EXPECT_EQ(row.real(6), 0.75);
    EXPECT_EQ(row.real(7), -2.5);
    EXPECT_EQ(row.real(8), frame.facts.simulation_time_s);
    EXPECT_EQ(row.integer(9), 2000);
    EXPECT_EQ(row.real(10), 0.875);
    EXPECT_EQ(row.real(11), 18);
    EXPECT_EQ(row.real(12), 4);
    for (int guard = 1; guard <= 8; ++guard) EXPECT_EQ(row.integer(12 + guard), guard);
  }
}

TEST(Store, WhatNobodyMeasuredOfAFrameIsEmpty) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = only_session(store);
  const OpenUnit& unit = first_trial(session);
  const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
  auto frames = test::frames(0, 2);
  frames[0].facts = {};
  frames[1].facts.tolerance->mu_fps.reset();  // tau was given
  frames[1].facts.tolerance->delta_fps.reset();
  store.add_frames(id, 0, frames);
  sqlite::Connection look(folder / "study.db", Open::Read);
  sqlite::Statement empty(look, "SELECT * FROM frame WHERE frame_index = 0");
  ASSERT_TRUE(empty.step());
  ASSERT_EQ(empty.columns(), 24);
  for (int column = 10; column < empty.columns(); ++column)
    EXPECT_TRUE(empty.is_null(column)) << empty.column_name(column);
  EXPECT_EQ(look.text("SELECT tau_fps || ' ' || active_fraction || ' ' || coalesce(mu_fps, delta_fps, '-') "
                      "FROM frame WHERE frame_index = 1"),
            "-2.5 0.75 -");
}

TEST(Store, WithoutAScheduleNoVerdictIsKept) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01"}));
  const auto session = only_session(store);
  const OpenUnit& unit = first_trial(session);
  const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
  TimingVerdict native = test::verdict();
  native.nominal = {0, 0, 1};
  store.end_presentation(id, 0, 1, test::frames(0, 5), native);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT verdict IS NULL AND reason IS NULL FROM presentation"), 1);
  EXPECT_EQ(look.text("SELECT mean_fps FROM presentation"), "49.5");
}

TEST(Store, AnswersOfOnePageStandTogetherOrNotAtAll) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01"}));
  const auto session = only_session(store);
  const OpenUnit& unit = first_trial(session);
  const int attempt = test::show(store, session, unit);
  EXPECT_THROW(answer(store, session, unit, attempt,
                      {{"preference", {test::score(2), 1}}, {"unknown", {test::score(2), 1}}}, true),
               base::Error);
  EXPECT_THAT(unit_of(only_session(store), unit.plan.position).answered, IsEmpty());
  answer(store, session, unit, attempt, {{"preference", {test::score(2), 1}}}, false);
  EXPECT_THAT(unit_of(only_session(store), unit.plan.position).answered, ElementsAre("preference"));
  answer(store, session, unit, attempt, {{"ease", {test::score(5), 1}}}, true);
  EXPECT_EQ(only_session(store).done, 1u);
}

TEST(Store, NothingIsAnsweredTwice) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01"}));
  const auto session = only_session(store);
  OpenUnit unit = first_trial(session);
  const int attempt = test::show(store, session, unit);
  answer(store, session, unit, attempt, {{"preference", {test::score(2), 1}}}, false);
  unit.attempts = attempt;  // shown again after an interruption: what was answered stands
  const int again = test::show(store, session, unit);
  EXPECT_THROW(answer(store, session, unit, again, {{"preference", {test::score(1), 1}}}, false),
               base::Error);
  answer(store, session, unit, again, {{"ease", {test::score(5), 1}}}, true);
  EXPECT_THROW(answer(store, session, unit, again + 1, {{"ease", {test::score(1), 1}}}, true), base::Error);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response"), 2);
  EXPECT_EQ(look.integer("SELECT sum(score) FROM response"), 7);
}

TEST(Store, PersonalAnswersAreRefused) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01"}));
  const auto session = only_session(store);
  EXPECT_THAT(
      [&] {
        answer(store, session, session.units[0], 0, {{"age", {test::score(33), 1}}}, true);
      },
      ThrowsMessage<base::Error>(HasSubstr("personal")));
  answer(store, session, session.units[0], 0, {{"games", {test::score(1), 1}}}, true);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response"), 1);
  EXPECT_EQ(look.text("SELECT state FROM unit WHERE position = 0"), "done");
}

TEST(Store, WordsAndWhatWasLeftEmptyAreAnswers) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pairs(), {"P01", "P02"}));
  const auto sessions = store.open_runs().at(0).sessions;
  answer(store, sessions[0], sessions[0].units.back(), 0, {{"remarks", {test::words("none at all"), 1}}},
         true);
  answer(store, sessions[1], sessions[1].units.back(), 0, {{"remarks", {{}, 1}}}, true);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT words FROM response WHERE response_id = 1"), "none at all");
  EXPECT_EQ(look.integer("SELECT words IS NULL AND score IS NULL FROM response WHERE response_id = 2"), 1);
}

TEST(Store, ARepeatedTrialIsAskedAgainAndItsLastAnswerCounts) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  Store store(path, Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = only_session(store);
  test::finish_pilot(store, session, 3);
  EXPECT_TRUE(store.open_runs().empty());
  const OpenUnit& unit = first_trial(session);
  store.repeat_trial(session.id, unit.trial_id, "a door slammed");
  const auto open = only_session(store);
  ASSERT_EQ(open.units.size(), 1u);
  EXPECT_EQ(open.units[0].id, unit.id);
  EXPECT_EQ(open.units[0].attempts, 1);
  EXPECT_THAT(open.units[0].answered, IsEmpty());
  EXPECT_FALSE(test::trials_of(path)[0].score()) << "set aside, and not answered anew";
  test::answer_one(store, open, open.units[0], "satisfaction", test::score(7));
  EXPECT_EQ(test::trials_of(path)[0].score(), 7);
  EXPECT_TRUE(store.open_runs().empty());
  sqlite::Connection look(path, Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response"), 22);
  EXPECT_EQ(look.text("SELECT words FROM note"), "a door slammed");
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE detail LIKE '%door%'"), 0);
  EXPECT_EQ(look.text("SELECT state FROM session"), "done");
}

TEST(Store, ExcludedTrialsAreMarkedWithTheReason) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = only_session(store);
  const auto trial = first_trial(session).trial_id;
  EXPECT_THROW(store.exclude_trial(session.id, trial, ""), base::Error);
  EXPECT_THROW(store.exclude_trial(session.id + 1, trial, "x"), base::Error);
  store.exclude_trial(session.id, trial, "the phone rang");
  const auto rows = test::trials_of(folder / "study.db");
  EXPECT_EQ(rows[0].trial.excluded, "the phone rang");
  EXPECT_FALSE(rows[1].trial.excluded);
  EXPECT_EQ(read_status(folder / "study.db").sessions.at(0).excluded, 1);
}

TEST(Store, ASessionThatEndedEarlyIsNotResumed) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01", "P02", "P03", "P04"}));
  const auto sessions = store.open_runs().at(0).sessions;
  store.end_session(sessions[0].id, {EarlyEnd::NotEligible, ""}, 1);
  store.end_session(sessions[1].id, {EarlyEnd::Stopped, "felt unwell"}, 1);
  store.end_session(sessions[2].id, {EarlyEnd::DroppedOut, ""}, 1);
  const auto left = store.open_runs().at(0).sessions;
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].plan.participant, "P04");
  const auto status = read_status(folder / "study.db").sessions;
  EXPECT_EQ(status[0].state, "not eligible");
  EXPECT_EQ(status[1].state, "stopped");
  EXPECT_EQ(status[2].state, "dropped out");
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT words FROM note"), "felt unwell");
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE detail LIKE '%unwell%'"), 0);
}

TEST(Store, SlotsOfThoseWhoCountAreTaken) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  const Protocol protocol = test::pilot();
  RunPlan run{protocol, "{}", {}};
  for (int slot = 0; slot < 5; ++slot)
    run.sessions.push_back(test::session_plan(protocol, "P" + std::to_string(slot), 7, slot));
  run.sessions[4].test_data = true;
  store.add_run(run);
  const auto sessions = store.open_runs().at(0).sessions;
  store.end_session(sessions[1].id, {EarlyEnd::NotEligible, ""}, 1);
  store.end_session(sessions[2].id, {EarlyEnd::DroppedOut, ""}, 1);
  store.end_session(sessions[3].id, {EarlyEnd::Stopped, ""}, 1);
  EXPECT_THAT(store.taken_slots(protocol.sha256), ElementsAre(0, 3));
  EXPECT_THAT(store.taken_slots(test::pairs().sha256), IsEmpty());
}

TEST(Store, TestRunsAreBalancedAmongThemselves) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  Protocol protocol = test::pilot();
  override_trial_seconds(protocol, 1);
  RunPlan run{protocol, "{}", {test::session_plan(protocol, "P01", 7, 4)}};
  store.add_run(run);
  EXPECT_THAT(store.taken_slots(protocol.sha256), ElementsAre(4));
}

TEST(Store, NotesStandApartFromTheLog) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = only_session(store);
  store.note(session.id, session.units[2].id, "yawned twice");
  store.note(session.id, {}, "left early");
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM note"), 2);
  EXPECT_EQ(look.text("SELECT words FROM note WHERE unit_id IS NOT NULL"), "yawned twice");
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE kind = 'note' AND detail = ''"), 2);
}

TEST(Store, ACutPresentationIsMarkedAndKeepsItsFrames) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01"}));
    const auto session = only_session(store);
    const OpenUnit& unit = first_trial(session);
    const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
    store.add_frames(id, 0, test::frames(0, 12));
  }
  Store store(folder / "study.db", Open::Write);
  EXPECT_EQ(first_trial(only_session(store)).attempts, 1);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT state FROM presentation"), "interrupted");
  EXPECT_EQ(look.integer("SELECT count(*) FROM frame"), 12);
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE kind = 'trial interrupted'"), 1);
}

TEST(Store, SessionEndsWithItsLastUnit) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  OpenSession session = only_session(store);
  const OpenUnit last = session.units.back();
  session.units.pop_back();
  test::finish_pilot(store, session, 4);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT state || (ended_utc IS NULL) FROM session"), "open1");
  store.finish_unit(session.id, last.id, 5);
  EXPECT_EQ(look.text("SELECT state || (ended_utc IS NULL) FROM session"), "done0");
  EXPECT_TRUE(store.open_runs().empty());
}

TEST(Store, RefusesTheSameParticipantTwiceAndKeepsNothingOfTheRun) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P02"}));
  EXPECT_THAT(
      [&] {
        store.add_run(test::run_plan(test::pilot(), {"P01", "P02"}));
      },
      ThrowsMessage<base::Error>(HasSubstr("resume")));
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM session"), 1);
  EXPECT_EQ(look.integer("SELECT count(*) FROM run"), 1);
  RunPlan second = test::run_plan(test::pilot(), {"P02"});
  second.sessions[0].visit = 2;
  store.add_run(second);
  EXPECT_EQ(look.integer("SELECT count(*) FROM session"), 2);
  EXPECT_EQ(look.integer("SELECT count(DISTINCT person) FROM session"), 1);
  EXPECT_EQ(look.integer("SELECT count(DISTINCT uid) FROM session"), 2);
}

TEST(Store, AChangedProtocolDoesNotContinueADatasetInSilence) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  const Protocol protocol = test::pilot();
  store.add_run(test::run_plan(protocol, {"P01"}));
  const Protocol changed = parse_protocol(protocol.text + "\n", "changed.toml");
  EXPECT_THAT([&] { store.add_run(test::run_plan(changed, {"P02"})); },
              ThrowsMessage<base::Error>(HasSubstr("a changed protocol begins a new dataset")));
  Protocol shortened = protocol;
  override_trial_seconds(shortened, 2);
  store.add_run(test::run_plan(shortened, {"P01"}));
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(DISTINCT protocol_id) FROM session"), 2);
  EXPECT_EQ(look.integer("SELECT count(*) FROM session WHERE test_data = 1"), 1);
}

TEST(Store, IsTheOnlyWriter) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  EXPECT_THAT([&] { Store second(folder / "study.db", Open::Write); },
              ThrowsMessage<base::Error>(HasSubstr("another vip-study")));
}

TEST(Store, EventLogIsAppendOnly) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  store.log({}, "note", "here");
  sqlite::Connection other(folder / "study.db", Open::Write);
  for (const char* of : {"session_id IS NULL", "session_id = 1"}) {
    EXPECT_THROW(other.execute(std::string("DELETE FROM event WHERE ") + of), base::Error);
    EXPECT_THROW(other.execute(std::string("UPDATE event SET detail = '' WHERE ") + of), base::Error);
  }
  EXPECT_EQ(other.integer("SELECT count(*) FROM event"), 2);
}

TEST(ParticipantCode, AreCodesNotNames) {
  for (const char* good : {"P01", "a", "x_Y-9", "12345678901234567890123456789012"})
    check_participant_code(good);
  for (const char* bad : {"", "Anna Berg", "P01;", "Ü", "../P", "123456789012345678901234567890123", "P01\n",
                          "-1-2", "--yes", "-rf", "_", "-"}) {
    EXPECT_THROW(check_participant_code(bad), base::Error) << bad;
  }
}

TEST(ParticipantCode, DiffersFromOthersInMoreThanCase) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01", "q1"}));
  for (const char* alike : {"p01", "Q1"}) {
    EXPECT_THAT(
        [&] {
          store.add_run(test::run_plan(test::pilot(), {"P02", alike}));
        },
        ThrowsMessage<base::Error>(AllOf(HasSubstr("in upper and lower case alone"), HasSubstr("mend: "))));
  }
  EXPECT_THAT(
      [&] {
        store.add_run(test::run_plan(test::pilot(), {"R1", "r1"}));
      },
      ThrowsMessage<base::Error>(HasSubstr("in upper and lower case alone")));
  EXPECT_EQ(store.open_runs().at(0).sessions.size(), 2u) << "nothing of a refused run is kept";
}

TEST(ParticipantCode, OldPairsAndOptionsStillGoOn) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01", "P02", "P03"}));
  }
  sqlite::Connection(folder / "study.db", Open::Write)
      .execute(
          "UPDATE session SET participant = 'p01' WHERE participant = 'P02';"
          "UPDATE session SET participant = '-rf' WHERE participant = 'P03'");
  Store store(folder / "study.db", Open::Write);
  const auto runs = store.open_runs();
  ASSERT_EQ(runs.at(0).sessions.size(), 3u);
  for (const OpenSession& session : runs.at(0).sessions) test::finish_pilot(store, session, 5);
  EXPECT_TRUE(store.open_runs().empty());
  // A second visit of one who was there before is no newcomer.
  RunPlan again = test::run_plan(test::pilot(), {"p01"});
  again.sessions.at(0).visit = 2;
  store.add_run(again);
}

}  // namespace
}  // namespace study
