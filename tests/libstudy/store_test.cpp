#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/store/file/database.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/open_session.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using test::first_trial;
using test::only_session;

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
    if (!entry.is_regular_file()) continue;
    const Protocol protocol = read_protocol(entry.path());
    SCOPED_TRACE(protocol.name);
    const auto path = folder / (protocol.name + ".db");
    Store(path, Open::Create).add_run(test::run_plan(protocol, {"P01"}));
    sqlite::Connection look(path, Open::Read);
    std::set<std::string> ids;
    for (const auto& [block, question] : all_questions(protocol)) ids.insert(question->id);
    EXPECT_EQ(look.integer("SELECT count(*) FROM question"), static_cast<std::int64_t>(ids.size()));
    // Each page block asks all its questions.
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
  frames[1].facts.tolerance->mu_fps.reset();  // as if the tolerance tau was set, not computed
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
}  // namespace
}  // namespace study
