/// vip-study merge, withdraw and export, from their command lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/file.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(StoreCommandsE2e, StationsAreMergedExportedAndWithdrawnFrom) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", all = folder / "all.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  const auto call = [](const std::vector<std::string>& arguments) { return Process(arguments).wait(); };
  for (const char* station : {"north", "south"}) {
    const std::string database = folder / (std::string(station) + ".db");
    EXPECT_EQ(call(run_arguments(protocol, database,
                                 {"--clock", "virtual", "--participant", "P01", "--station", station}))
                  .exit_code,
              0);
  }
  const Ended merged = call({vip_study, "merge", folder / "north.db", folder / "south.db", "--into", all});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, HasSubstr("2 sessions"));
  const Ended exported = call({vip_study, "export", "--db", all, "--csv", folder / "csv", "--bids",
                               folder / "bids", "--psych-ds", folder / "psych"});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_TRUE(fs::exists(folder / "bids" / "participants.tsv"));
  const auto no_input = [] { ::close(STDIN_FILENO); };
  const Ended unconfirmed = Process({vip_study, "withdraw", "P01-north", "--db", all}, no_input).wait();
  EXPECT_NE(unconfirmed.exit_code, 0);
  EXPECT_THAT(unconfirmed.err, HasSubstr("nothing was deleted"));
  EXPECT_EQ(count_in(all, "SELECT count(*) FROM session"), 2);
  const Ended withdrawn = call({vip_study, "withdraw", "P01-north", "--db", all, "--yes"});
  EXPECT_EQ(withdrawn.exit_code, 0) << withdrawn.err;
  for (const char* format : {"csv", "bids", "psych"}) {
    EXPECT_THAT(withdrawn.out, HasSubstr("deleted, make it again: " + (folder / format).string()));
    EXPECT_FALSE(fs::exists(folder / format));
  }
  EXPECT_EQ(call({vip_study, "merge", folder / "north.db", "--into", all}).exit_code, 0);
  EXPECT_EQ(count_in(all, "SELECT count(*) FROM session"), 1);
}

/// Columns of one row of a database, joined by spaces.
std::string row_of(const std::string& database, const std::string& sql) {
  study::sqlite::Connection connection(database, study::sqlite::Open::Read);
  study::sqlite::Statement row(connection, sql);
  std::string out;
  if (row.step())
    for (int i = 0; i < row.columns(); ++i) out += (i ? " " : "") + row.text(i);
  return out;
}

TEST(StoreCommandsE2e, NumberedStationsShareTheAssignmentAndMergePrintsTheBalance) {
  const TemporaryFolder folder;
  const auto record = [&](const std::string& database, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        vip_study,    "run",    "protocols/task1.toml", "--db", folder / database,
        "--observer", "random", "--trial-seconds",      "0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  };
  for (const char* number : {"1", "2"}) {
    const Ended ended =
        record(std::string(number) + ".db", {"--participants", "6", "--station", std::string(number) + "/2"});
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
  }
  const Ended merged =
      run_program({vip_study, "merge", folder / "1.db", folder / "2.db", "--into", folder / "all.db"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.err, "");
  EXPECT_THAT(merged.out, HasSubstr("task1 1.0, 12 sessions: 12 sequences, each used once"));
  const std::string first_order =
      "SELECT group_concat(first_cell, ' ') FROM (SELECT first_cell FROM trial JOIN session USING "
      "(session_id) "
      "WHERE participant = 'P01' ORDER BY position)";
  EXPECT_NE(row_of(folder / "1.db", first_order), row_of(folder / "2.db", first_order));

  // A forgotten station number is an error, and following its advice works.
  const Ended forgotten = record("1.db", {"--participant", "P07"});
  EXPECT_EQ(forgotten.exit_code, 1);
  EXPECT_THAT(forgotten.err, HasSubstr("mend: add --station 1/2"));
  EXPECT_EQ(record("1.db", {"--participant", "P07", "--station", "1/2"}).exit_code, 0);
  EXPECT_EQ(record("3.db", {"--participant", "P01", "--station", "3/2"}).exit_code, 1);

  ASSERT_EQ(record("north.db", {"--participants", "6", "--station", "north"}).exit_code, 0);
  ASSERT_EQ(record("south.db", {"--participants", "6"}).exit_code, 0);
  const Ended off = run_program(
      {vip_study, "merge", folder / "north.db", folder / "south.db", "--into", folder / "off.db"});
  EXPECT_EQ(off.exit_code, 0) << off.err;
  EXPECT_THAT(off.out, HasSubstr("6 used twice, 6 never"));
  EXPECT_THAT(
      off.err,
      AllOf(HasSubstr("is not balanced: some orders are used by at least two sessions more than others"),
            HasSubstr("without a station number"), HasSubstr("mend: give each station a number of its own")));
}

/// Files below a folder, except the database and its journal, whose bytes contain the text.
std::vector<std::string> files_with(const fs::path& folder, const std::string& text) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || name.starts_with("s.db")) continue;
    if (base::read_file(entry.path(), 1u << 30).find(text) != std::string::npos) names.push_back(name);
  }
  return names;
}

TEST(StoreCommandsE2e, AWithdrawalReachesEveryReport) {
  const TemporaryFolder folder;
  const std::string database = folder / "s.db", stats = VIP_BIN_DIR "/vip-stats";
  const auto call = [](const std::vector<std::string>& arguments) {
    const Ended ended = Process(arguments).wait();
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return ended;
  };
  for (const char* protocol : {"protocols/task2.toml", "protocols/ptpe_pilot.toml"}) {
    std::vector<std::string> run{vip_study, "run", protocol, "--db", database, "--observer", "random"};
    for (const char* code : {"QZ7", "P02", "P03"}) run.insert(run.end(), {"--participant", code});
    call(run);
  }
  call({stats, "report", database, "--html", folder / "r.html", "--json", folder / "r.json", "--csv",
        folder / "csv"});
  call({stats, "task2", database, "--json", folder / "t.json", "--csv", folder / "t"});
  Process({stats, "fit-ptpe", database, "--json", folder / "fit.json"}).wait();  // a fit of random answers
  EXPECT_THAT(files_with(folder.path(), "QZ7"), ::testing::Not(::testing::Contains("fit.json")));
  // These files contain codes; the fit contains none.
  for (const char* made : {"r.html", "r.json", "t.json", "csv", "t", "csv/task2_choices.csv", "t/timing.csv"})
    EXPECT_EQ(fs::status(folder / made).permissions() & fs::perms(0077), fs::perms::none) << made;
  ASSERT_THAT(files_with(folder.path(), "QZ7"), ::testing::Contains("task2_choices.csv"));
  ASSERT_THAT(files_with(folder.path(), "QZ7"), ::testing::Contains("t.json"));
  call({vip_study, "withdraw", "QZ7", "--db", database, "--yes"});
  EXPECT_THAT(files_with(folder.path(), "QZ7"), ::testing::IsEmpty());
  EXPECT_TRUE(fs::exists(folder / "fit.json"));  // it covers all people and names none
  EXPECT_FALSE(fs::exists(folder / "csv") || fs::exists(folder / "t"));
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM export"), 0);
  call({stats, "report", database, "--html", folder / "r.html"});
}

TEST(StoreCommandsE2e, WhatIsLeftOfAWithdrawalIsNamedByEveryCommandUntilItIsDone) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "s.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  const auto run = [&](const std::string& code) {
    return Process(run_arguments(protocol, database, {"--clock", "virtual", "--participant", code})).wait();
  };
  EXPECT_EQ(run("P01").exit_code, 0);
  EXPECT_EQ(Process({vip_study, "export", "--db", database, "--csv", folder / "csv"}).wait().exit_code, 0);
  base::write_file_atomically(folder / "csv" / "mine.txt", "mine");
  const Ended withdrawn = Process({vip_study, "withdraw", "P01", "--db", database, "--yes"}).wait();
  EXPECT_EQ(withdrawn.exit_code, 1);
  EXPECT_THAT(withdrawn.out, HasSubstr("export " + (folder / "csv").string()));
  EXPECT_THAT(withdrawn.err, HasSubstr("one clean-up named above is left"));
  const Ended next = run("P02");  // the session is played; the exit status reports the problem
  EXPECT_EQ(next.exit_code, 1);
  EXPECT_THAT(next.out, HasSubstr("export " + (folder / "csv").string()));
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM session WHERE state = 'done'"), 1);
  fs::remove_all(folder / "csv");
  EXPECT_EQ(Process({vip_study, "resume", "--db", database}).wait().exit_code, 0);
}

TEST(StoreCommandsE2e, WhoCannotWriteTheDatabaseCannotExport) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "s.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  EXPECT_EQ(Process(run_arguments(protocol, database, {"--clock", "virtual", "--participant", "P01"}))
                .wait()
                .exit_code,
            0);
  fs::permissions(folder.path(), fs::perms(0755));
  for (const auto& entry : fs::directory_iterator(folder.path()))
    fs::permissions(entry.path(), fs::perms(0644));
  fs::create_directory(folder / "theirs");
  fs::permissions(folder / "theirs", fs::perms(0777));
  const auto as_nobody = [] {
    if (::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(125);
  };
  const Ended refused =
      Process({vip_study, "export", "--db", database, "--csv", folder / "theirs" / "csv"}, as_nobody).wait();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("export is registered in it"));
  EXPECT_TRUE(fs::is_empty(folder / "theirs"));
}

}  // namespace
}  // namespace apps::test
