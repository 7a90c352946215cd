#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/database.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/open_session.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

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
