#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/open_session.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using test::first_trial;
using test::only_session;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

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

TEST(Store, OnlyASessionOfWhichSomethingWasShownIsBegun) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01", "P02", "P03", "P04"}));
    const auto sessions = store.open_runs().at(0).sessions;
    store.finish_unit(sessions[0].id, sessions[0].units.at(0).id, 1);
    const OpenUnit& trial = first_trial(sessions[1]);
    store.begin_presentation(sessions[1].id, trial.trial_id, 1, 0, trial.trial->first, 1);
    store.end_session(sessions[2].id, {EarlyEnd::Stopped, ""}, 1);
  }
  std::vector<std::string> states;
  const auto tasks = read_tasks({folder / "study.db"});
  for (const TaskSession& session : tasks.protocols.at(0).sessions)
    states.push_back(session.participant + " " + session.state);
  EXPECT_THAT(states, ElementsAre("P01 open", "P02 open", "P03 stopped", "P04 planned"));
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
}  // namespace
}  // namespace study
