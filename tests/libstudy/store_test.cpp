#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/database.hpp"
#include "libstudy/store/ratings.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TimingVerdict verdict() {
  TimingVerdict verdict;
  verdict.verdict = Verdict::Degraded;
  verdict.grade = TimingGrade::DisplayFeedback;
  verdict.realised = {40, 49.5, 50.5, 3.25};
  verdict.longest_ms = 41;
  verdict.shortest_ms = 11;
  verdict.p95_ms = 31;
  verdict.lag1 = -0.125;
  verdict.late = 1;
  verdict.worst_late_ms = 2.5;
  verdict.reason = "one frame late";
  return verdict;
}

/// Shows the first open trial and answers it with `score`.
void play_one(Store& store, const OpenSession& session, const OpenTrial& trial, int score) {
  const std::int64_t start_ns = 1'000'000'000'000;
  const auto id = store.begin_presentation(session.id, trial.id, trial.attempts + 1, start_ns);
  const auto all = test::frames(start_ns, 40);
  store.add_frames(id, start_ns, std::span(all).first(25));
  store.end_presentation(id, start_ns, start_ns + 800'000'000, std::span(all).subspan(25), verdict());
  store.answer(session.id, trial.id, id, "satisfaction", score, 1.5, start_ns + 900'000'000);
}

TEST(Store, WritesTheWholePlanBeforeTheFirstTrial) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(protocol, {"P01", "P02"}));
  }
  Store store(folder / "study.db", Open::Write);
  const auto runs = store.open_runs();
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].protocol_sha256, protocol.sha256);
  EXPECT_EQ(runs[0].protocol_text, protocol.text);
  ASSERT_EQ(runs[0].sessions.size(), 2u);
  for (const OpenSession& session : runs[0].sessions) {
    const auto plan = make_plan(protocol, session.plan.participant, 7);
    ASSERT_EQ(session.trials.size(), plan.size());
    for (std::size_t i = 0; i < plan.size(); ++i) {
      EXPECT_EQ(session.trials[i].plan.position, plan[i].position);
      EXPECT_EQ(session.trials[i].plan.setting, plan[i].setting);
      EXPECT_EQ(session.trials[i].plan.schedule_seed, plan[i].schedule_seed);
    }
  }
}

TEST(Store, RatingsHoldWhatWasShownAndAnswered) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(protocol, {"P01"}));
    const auto session = store.open_runs().at(0).sessions.at(0);
    play_one(store, session, session.trials[0], 6);
  }
  const auto rows = read_ratings(folder / "study.db");
  ASSERT_EQ(rows.size(), 21u);
  const RatingRow& row = rows[0];
  EXPECT_EQ(row.participant, "P01");
  EXPECT_EQ(row.observer, "ptpe:a=31,b=0.035");
  EXPECT_EQ(row.protocol_sha256, protocol.sha256);
  EXPECT_FALSE(row.test_data);
  EXPECT_EQ(row.rating, 6);
  EXPECT_EQ(row.scale_max, 7);
  ASSERT_TRUE(row.timing);
  const TimingVerdict& timing = *row.timing;
  EXPECT_EQ(timing.verdict, Verdict::Degraded);
  EXPECT_EQ(timing.grade, TimingGrade::DisplayFeedback);
  EXPECT_EQ(timing.realised.frames, 40u);
  EXPECT_EQ(timing.realised.mean, 49.5);
  EXPECT_EQ(timing.realised.mean_arithmetic, 50.5);
  EXPECT_EQ(timing.realised.sd, 3.25);
  EXPECT_EQ(timing.lag1, -0.125);
  EXPECT_EQ(timing.late, 1);
  EXPECT_EQ(timing.reason, "one frame late");
  EXPECT_FALSE(rows[1].rating);
  EXPECT_FALSE(rows[1].timing);
}

TEST(Store, FramesComeBackAsTheyWereRecorded) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01"}));
    const auto session = store.open_runs().at(0).sessions.at(0);
    play_one(store, session, session.trials[0], 6);
  }
  const auto database = open_database(folder / "study.db", Open::Read, read_schema_steps());
  EXPECT_EQ(database->integer("SELECT count(*) FROM frame"), 40);
  sqlite::Statement row(*database,
                        "SELECT p.start_ns + f.scheduled_ns, p.start_ns + f.scheduled_ns + f.submitted_ns, "
                        "f.actual_display_ns, f.late, f.particles, f.content_step, f.active_fraction, "
                        "f.tolerance_fps, f.simulation_time_s, f.gpu_done_ns "
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
  }
}

TEST(Store, ATrialIsAnsweredOnce) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  play_one(store, session, session.trials[0], 6);
  OpenTrial again = session.trials[0];
  again.attempts = 1;
  EXPECT_THROW(play_one(store, session, again, 2), base::Error);
  const auto left = store.open_runs().at(0).sessions.at(0);
  EXPECT_EQ(left.trials.size(), 20u);
  EXPECT_EQ(left.answered, 1u);
}

TEST(Store, ACutPresentationIsMarkedAndKeepsItsFrames) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01"}));
    const auto session = store.open_runs().at(0).sessions.at(0);
    const auto id = store.begin_presentation(session.id, session.trials[0].id, 1, 0);
    store.add_frames(id, 0, test::frames(0, 12));
  }
  Store store(folder / "study.db", Open::Write);
  const auto session = store.open_runs().at(0).sessions.at(0);
  EXPECT_EQ(session.trials.size(), 21u);
  EXPECT_EQ(session.trials[0].attempts, 1);
  sqlite::Connection look(folder / "study.db", Open::Read);
  EXPECT_EQ(look.text("SELECT state FROM presentation"), "interrupted");
  EXPECT_EQ(look.integer("SELECT count(*) FROM frame"), 12);
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE kind = 'trial interrupted'"), 1);
}

TEST(Store, SessionEndsWithItsLastAnswer) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  sqlite::Connection look(folder / "study.db", Open::Read);
  for (const OpenTrial& trial : session.trials) {
    EXPECT_EQ(look.integer("SELECT ended_utc IS NULL FROM session"), 1);
    play_one(store, session, trial, 4);
  }
  EXPECT_EQ(look.integer("SELECT ended_utc IS NULL FROM session"), 0);
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
  store.log({}, "note", "here");
  sqlite::Connection other(folder / "study.db", Open::Write);
  EXPECT_THROW(other.execute("DELETE FROM event"), base::Error);
  EXPECT_THROW(other.execute("UPDATE event SET detail = ''"), base::Error);
}

TEST(ParticipantCode, AreCodesNotNames) {
  for (const char* good : {"P01", "a", "x_Y-9", "12345678901234567890123456789012"})
    check_participant_code(good);
  for (const char* bad :
       {"", "Anna Berg", "P01;", "Ü", "../P", "123456789012345678901234567890123", "P01\n"}) {
    EXPECT_THROW(check_participant_code(bad), base::Error) << bad;
  }
}

}  // namespace
}  // namespace study
