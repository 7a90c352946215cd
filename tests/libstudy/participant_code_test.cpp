#include "libstudy/store/store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/file/database.hpp"
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

TEST(ParticipantCode, DiffersFromOthersInMoreThanCasePunctuationAndZeros) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01", "q1", "007", "X-10"}));
  for (const char* alike : {"p01", "Q1", "P-01", "P_0-1", "P1", "P001", "Q01", "7", "07", "x10", "X010"}) {
    EXPECT_THAT(
        [&] {
          store.add_run(test::run_plan(test::pilot(), {"P02", alike}));
        },
        ThrowsMessage<base::Error>(
            AllOf(HasSubstr("only in case, punctuation or leading zeros"), HasSubstr("mend: "))))
        << alike;
  }
  EXPECT_THAT(
      [&] {
        store.add_run(test::run_plan(test::pilot(), {"R1", "r1"}));
      },
      ThrowsMessage<base::Error>(HasSubstr("only in case, punctuation or leading zeros")));
  EXPECT_EQ(store.open_runs().at(0).sessions.size(), 4u) << "nothing of a refused run is kept";
  store.add_run(test::run_plan(test::pilot(), {"P10", "P02", "q11", "70", "X-100", "XP01"}));
}

TEST(ParticipantCode, ReadsAsNoMissingValueInOtherPrograms) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  for (const char* missing : {"NA", "n-a", "N_A", "nan", "NaN", "null", "NULL", "none", "None", "nil"}) {
    EXPECT_THAT(
        [&] { store.add_run(test::run_plan(test::pilot(), {missing})); },
        ThrowsMessage<base::Error>(AllOf(HasSubstr("a missing value"), HasSubstr("mend: give another"))))
        << missing;
  }
  store.add_run(test::run_plan(test::pilot(), {"NA1", "Nina"}));
}

TEST(ParticipantCode, OldPairsAndOptionsStillGoOn) {
  const test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01", "P02", "P03", "P04"}));
  }
  sqlite::Connection(folder / "study.db", Open::Write)
      .execute(
          "UPDATE session SET participant = 'p01' WHERE participant = 'P02';"
          "UPDATE session SET participant = 'NA' WHERE participant = 'P04';"
          "UPDATE session SET participant = '-rf' WHERE participant = 'P03'");
  Store store(folder / "study.db", Open::Write);
  const auto runs = store.open_runs();
  ASSERT_EQ(runs.at(0).sessions.size(), 4u);
  for (const OpenSession& session : runs.at(0).sessions) test::finish_pilot(store, session, 5);
  EXPECT_TRUE(store.open_runs().empty());
  // A second visit may keep an earlier code that would be refused for a new person.
  for (const char* code : {"p01", "NA"}) {
    RunPlan again = test::run_plan(test::pilot(), {code});
    again.sessions.at(0).visit = 2;
    store.add_run(again);
  }
}
}  // namespace
}  // namespace study
