/// Clean-up of the files beside the database after a withdrawal or a merge, and after interruptions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/version_1.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* secret = "zebra-of-the-north";

std::vector<std::string> select(const fs::path& path, const std::string& sql) {
  Connection database(path, Open::Read);
  std::vector<std::string> lines;
  for (Statement row(database, sql); row.step();) {
    std::string line;
    for (int i = 0; i < row.columns(); ++i) line += (i ? "|" : "") + row.text(i);
    lines.push_back(line);
  }
  return lines;
}

/// Files below a folder that contain the text.
std::vector<std::string> files_with(const fs::path& folder, const std::string& text) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && test::bytes_of(entry.path()).find(text) != std::string::npos)
      names.push_back(entry.path().lexically_relative(folder).string());
  }
  return names;
}

/// Writes a station's study with these participants. P02's note is the secret, and all have personal data.
void write_station(const fs::path& path, const std::string& station, const std::vector<std::string>& people) {
  RunPlan run = test::run_plan(test::pairs(), people);
  for (SessionPlan& session : run.sessions) session.station = station;
  {
    Store store(path, Open::Create);
    store.add_run(run);
    const auto runs = store.open_runs();
    for (const OpenSession& session : runs.back().sessions)
      store.note(session.id, {}, session.plan.participant == "P02" ? secret : "calm");
  }
  for (const std::string& code : people)
    PersonalFile(path).keep({{code, "age", "How old?", code == "P02" ? secret : station + ' ' + code}});
}

void back_up(const fs::path& path, const std::string& name) {
  Connection now(path, Open::Write);
  Statement(now, "VACUUM INTO ?").bind_all(path.string() + name).run();
}

std::string age_of(const fs::path& path, const std::string& code) {
  const auto entries = PersonalFile(path).read(code);
  return entries.empty() ? "" : entries.front().answer;
}

/// Commits a withdrawal as withdraw() does, but stops before the clean-up of the files beside the database.
void withdraw_and_stop(const fs::path& path, const std::string& code) {
  const auto database = open_database(path, Open::Write, read_schema_steps());
  const std::string person = database->text("SELECT person FROM session WHERE participant = '" + code + "'");
  prepare_rewrite(*database, {person});
  Transaction transaction(*database);
  bury(*database, person, static_cast<std::int64_t>(read_schema_steps().size()));
  ChorePlan plan(*database);
  plan.forget(person, code);
  plan.rewrite();
  transaction.commit();
}

TEST(CleanUp, WhatAKilledWithdrawalLeftIsDoneByTheNextSession) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_station(path, "north", {"P01", "P02"});
  back_up(path, ".v2-old.bak");
  withdraw_and_stop(path, "P02");
  ASSERT_THAT(files_with(folder.path(), secret), ::testing::SizeIs(::testing::Ge(2u)));
  EXPECT_THAT(Store(path, Open::Write).left_to_clean(), IsEmpty());
  EXPECT_THAT(files_with(folder.path(), secret), IsEmpty());
  EXPECT_THAT(select(path, "SELECT * FROM chore"), IsEmpty());
  EXPECT_EQ(age_of(path, "P01"), "north P01");
  EXPECT_THAT(select(path.string() + ".v2-old.bak", "SELECT participant FROM session"), ElementsAre("P01"));
}

TEST(CleanUp, ARepeatedWithdrawalAndAMergeDoItToo) {
  for (const bool merges : {false, true}) {
    const test::TemporaryFolder folder;
    const fs::path path = folder / "study.db";
    write_station(path, "north", {"P01", "P02"});
    write_station(folder / "south.db", "south", {"P03"});
    withdraw_and_stop(path, "P02");
    if (merges)
      merge({folder / "south.db"}, path);
    else
      withdraw(path, "P02");
    EXPECT_THAT(files_with(folder.path(), secret), IsEmpty()) << merges;
    EXPECT_THAT(select(path, "SELECT * FROM chore"), IsEmpty());
  }
}

// A chore is a step of the clean-up, recorded as a row of the table chore. It may stop after it changed files
// and before that row is deleted. The test puts the database with that row back and runs the chore again.
TEST(CleanUp, DoneTwiceItComesToTheSame) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", before = folder / "before";
  write_station(path, "north", {"P01", "P02", "P03", "P04"});
  back_up(path, ".v2-old.bak");
  withdraw_and_stop(path, "P02");
  {
    const auto database = open_database(path, Open::Write, read_schema_steps());
    const auto person = [&](const std::string& code) {
      return database->text("SELECT person FROM session WHERE participant = '" + code + "'");
    };
    Transaction transaction(*database);
    ChorePlan(*database).rename(
        {{person("P01"), {"P01", "P03"}}, {person("P03"), {"P03", "P04"}}, {person("P04"), {"P04", "P09"}}});
    transaction.commit();
    database->integer("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  fs::copy_file(path, before);
  for (int times = 0; times < 3; ++times) {
    fs::remove(path.string() + "-wal");
    fs::remove(path.string() + "-shm");
    fs::copy_file(before, path, fs::copy_options::overwrite_existing);
    EXPECT_THAT(Store(path, Open::Write).left_to_clean(), IsEmpty());
    EXPECT_EQ(age_of(path, "P01"), "");
    EXPECT_EQ(age_of(path, "P02"), "");
    EXPECT_EQ(age_of(path, "P03"), "north P01");
    EXPECT_EQ(age_of(path, "P04"), "north P03");
    EXPECT_EQ(age_of(path, "P09"), "north P04");
    EXPECT_THAT(select(path.string() + ".v2-old.bak", "SELECT participant FROM session"),
                ElementsAre("P01", "P03", "P04"));
  }
  fs::remove(before);
  EXPECT_THAT(files_with(folder.path(), secret), IsEmpty());
}

TEST(CleanUp, WhatCannotBeDoneStaysAndIsNamedUntilItCan) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", broken = path.string() + ".v1-old.bak";
  write_station(path, "north", {"P01", "P02"});
  back_up(path, ".v2-old.bak");
  base::write_file_atomically(broken, std::string(5000, 'x'));
  EXPECT_THAT(withdraw(path, "P02").beside.left, ElementsAre(HasSubstr(".v1-old.bak")));
  EXPECT_THAT(files_with(folder.path(), secret), IsEmpty());  // all but the broken backup is cleaned
  EXPECT_THAT(Store(path, Open::Write).left_to_clean(), ElementsAre(HasSubstr(".v1-old.bak")));
  write_station(folder / "south.db", "south", {"P03"});
  EXPECT_THAT(merge({folder / "south.db"}, path).beside.left, ElementsAre(HasSubstr(".v1-old.bak")));
  EXPECT_THROW(check_nothing_left(path, {"something"}), base::Error);
  fs::remove(broken);
  EXPECT_THAT(Store(path, Open::Write).left_to_clean(), IsEmpty());
  EXPECT_THAT(select(path, "SELECT * FROM chore"), IsEmpty());
}

// A new P02 is added after the withdrawn P02's personal data were deleted, while the clean-up of a backup has
// still to be repeated.
TEST(CleanUp, AFailedChoreTakesNothingFromALaterPersonOfTheSameCode) {
  const test::TemporaryFolder folder;
  const fs::path north = folder / "north.db";
  write_station(north, "north", {"P02"});
  write_station(folder / "south.db", "south", {"P02"});
  fs::copy_file(north, folder / "copy.db");
  base::write_file_atomically(north.string() + ".v1-old.bak", std::string(5000, 'x'));
  withdraw(folder / "copy.db", "P02");
  EXPECT_EQ(merge({folder / "copy.db", folder / "south.db"}, north).beside.left.size(), 1u);
  Store(north, Open::Write).add_run(test::run_plan(test::pairs(), {"P02"}));
  PersonalFile(north).keep({{"P02", "age", "How old?", "the new one"}});
  EXPECT_EQ(Store(north, Open::Write).left_to_clean().size(), 1u);
  EXPECT_EQ(age_of(north, "P02"), "the new one");
}

class Backups : public ::testing::TestWithParam<std::size_t> {};

/// A database that was upgraded, so that a backup of the earlier schema with P01 and P02 lies beside it, and
/// that was merged with another station that has a P02 too.
TEST_P(Backups, LoseTheRightPersonAndNobodyElse) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "old.db",
                 backup = path.string() + ".v" + std::to_string(GetParam()) + "-then.bak";
  test::write_version_1(path);
  SchemaSteps steps = read_schema_steps();
  steps.resize(GetParam());
  open_database(path, Open::Write, steps);
  for (const fs::path& made : backups_of(path)) fs::remove(made);
  back_up(path, ".v" + std::to_string(GetParam()) + "-then.bak");
  write_station(folder / "north.db", "north", {"P02"});
  merge({folder / "north.db"}, path);

  const auto ours = select(path, "SELECT participant FROM session WHERE code = 'P02' AND station = ''");
  const std::string before = test::bytes_of(backup);
  EXPECT_THAT(withdraw(path, "P02-north").beside.left, IsEmpty());
  EXPECT_THAT(select(backup, "SELECT participant FROM session ORDER BY 1"), ElementsAre("P01", "P02"));
  EXPECT_THAT(select(backup, "SELECT count(*) FROM frame"), ElementsAre("10"));
  if (GetParam() > 1) {
    EXPECT_THAT(select(backup, "SELECT * FROM tombstone"), IsEmpty());
  }
  EXPECT_THAT(withdraw(path, ours.at(0)).beside.left, IsEmpty());
  for (const fs::path& file : backups_of(path)) {
    EXPECT_THAT(select(file, "SELECT participant FROM session ORDER BY 1"), ElementsAre("P01")) << file;
    EXPECT_THAT(select(file, "SELECT count(*) FROM frame"), ElementsAre("6"));
    EXPECT_THAT(select(file, "SELECT * FROM pragma_foreign_key_check"), IsEmpty());
  }
  if (GetParam() > 1) {
    EXPECT_THAT(select(backup, "SELECT code FROM tombstone"), ElementsAre("P02"));
  }
}

INSTANTIATE_TEST_SUITE_P(OfEachSchema, Backups, ::testing::Values(1u, 2u, 3u));

TEST(CleanUp, ThroughALinkItReachesWhatStandsBesideTheFile) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "data");
  fs::create_directories(folder / "home");
  const fs::path real = folder / "data" / "study.db", link = folder / "home" / "mine.db";
  fs::create_symlink(real, link);
  write_station(link, "north", {"P01", "P02"});
  EXPECT_TRUE(fs::exists(real.string() + ".personal"));
  back_up(real, ".v2-old.bak");
  EXPECT_EQ(withdraw(link, "P02").beside.cleaned.size(), 2u);
  EXPECT_THAT(files_with(folder.path(), secret), IsEmpty());
  write_station(folder / "south.db", "south", {"P01"});
  merge({folder / "south.db"}, link);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(age_of(link, "P01-north"), "north P01");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "home"), {}), 1);
}

}  // namespace
}  // namespace study
