#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/open_session.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using test::answer;
using test::first_trial;
using test::only_session;
using test::unit_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

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
  unit.attempts = attempt;  // shown again after an interruption: earlier answers stay
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
}  // namespace
}  // namespace study
