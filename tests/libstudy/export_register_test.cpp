/// Exports are registered with the people that they contain, and deleted when one of these withdraws.
#include "libstudy/store/export_register.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/common/killed.hpp"
#include "tests/faults/file_calls.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class Exports : public ::testing::Test {
 protected:
  Exports() { add("P01"); }
  void add(const std::string& code) {
    Store(path, Open::Create).add_run(test::run_plan(test::pairs(), {code}));
  }
  void change(const std::string& sql) { Connection(path, Open::Write).execute(sql); }
  std::int64_t count(const std::string& table) {
    return Connection(path, Open::Read).integer("SELECT count(*) FROM " + table);
  }

  test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", csv = folder / "csv";
};

TEST_F(Exports, OfEveryKindGoWithWhomTheyHold) {
  add("P02");
  const RegisteredFiles files(path);
  export_csv(path, csv);
  export_bids(path, folder / "bids");
  export_psych_ds(path, folder / "psych");
  files.write("vip-stats report", folder / "report.json", "{}");
  base::write_file_atomically(folder / "other.json", "{}");
  const Withdrawal done = withdraw(path, "P02");
  EXPECT_THAT(done.beside.left, IsEmpty());
  EXPECT_THAT(done.beside.cleaned,
              ElementsAre(folder / "bids", csv, folder / "psych", folder / "report.json"));
  for (const fs::path& gone : done.beside.cleaned) EXPECT_FALSE(fs::exists(gone));
  EXPECT_TRUE(fs::exists(folder / "other.json"));
  EXPECT_EQ(count("export"), 0);
  EXPECT_EQ(count("export_person"), 0);
  export_csv(path, csv);  // of the remaining people
  EXPECT_TRUE(fs::exists(csv / "sessions.csv"));
}

TEST_F(Exports, FromBeforeSomebodyCameStayWhateverTheClockSays) {
  export_csv(path, folder / "early");
  add("P02");
  export_csv(path, folder / "late");
  change("UPDATE export SET utc = iif(path LIKE '%late', '1999-01-01T00:00:00Z', '2999-01-01T00:00:00Z')");
  EXPECT_THAT(withdraw(path, "P02").beside.cleaned, ElementsAre(folder / "late"));
  EXPECT_TRUE(fs::exists(folder / "early"));
  EXPECT_THAT(withdraw(path, "P01").beside.cleaned, ElementsAre(folder / "early"));
}

TEST_F(Exports, OfOnePathAreOne) {
  export_csv(path, csv);
  fs::create_directory_symlink(folder.path(), folder / "link");
  add("P02");
  export_csv(path, folder / "link" / "csv");
  EXPECT_EQ(count("export"), 1);
  EXPECT_EQ(count("export_person"), 2);
  export_bids(path, folder / "bids");
  EXPECT_EQ(count("export"), 2);
}

// An export that is killed leaves its draft and a row in the register, but nothing at its target.
TEST_F(Exports, DraftsOfAKilledExportGoToo) {
  const auto people = everybody(*open_database(path, Open::Read, read_schema_steps()));
  fs::path draft, page;
  ::test::killed([&] {
    const RegisteredExport record(path, "csv", csv, people);
    fs::create_directory(record.draft());
    base::write_file_atomically(record.draft() / "sessions.csv", "P01");
    base::NewFile file(folder / "report.json", base::Readers::Owner);
    const RegisteredExport report(path, "vip-stats report", folder / "report.json", people, file.draft());
    file.write("P01");
    base::write_file_atomically(folder / "drafts", record.draft().string() + '\n' + file.draft().string());
    ::test::kill_here();
  });
  std::istringstream drafts(test::bytes_of(folder / "drafts"));
  for (fs::path* one : {&draft, &page}) {
    std::string line;
    std::getline(drafts, line);
    *one = line;
  }
  ASSERT_TRUE(fs::exists(draft) && fs::exists(page));
  for (const char* theirs : {"csv.tmp_mine", "csv.tmp0123456789abcdef", "report.json.tmp4711"})
    fs::create_directory(folder / theirs);
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty());
  for (const fs::path& gone : {csv, draft, page}) EXPECT_FALSE(fs::exists(gone)) << gone;
  for (const char* theirs : {"csv.tmp_mine", "csv.tmp0123456789abcdef", "report.json.tmp4711"})
    EXPECT_TRUE(fs::exists(folder / theirs)) << theirs;
}

TEST_F(Exports, AnExportThatNeverCameToItsPlaceIsNotAskedFor) {
  const auto people = everybody(*open_database(path, Open::Read, read_schema_steps()));
  { const RegisteredExport failed(path, "csv", csv, people); }
  EXPECT_EQ(count("export"), 0);
  export_csv(path, csv);
  { const RegisteredExport failed(path, "csv", csv, people); }
  EXPECT_EQ(count("export"), 1);            // the earlier export still exists
  change("UPDATE export SET sha256 = ''");  // as if its first export was killed
  fs::remove_all(csv);
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty());
  EXPECT_EQ(count("export"), 0);
}

TEST_F(Exports, WithFilesOfOthersAreNamedAndLeft) {
  export_csv(path, csv);
  std::ofstream(csv / "my notes.txt") << "mine";
  const fs::path report = folder / "report.json";
  RegisteredFiles(path).write("vip-stats report", report, "{}");
  std::ofstream(report) << "changed";
  EXPECT_THAT(withdraw(path, "P01").beside.left,
              ElementsAre(HasSubstr(csv.string()), HasSubstr(report.string())));
  EXPECT_TRUE(fs::exists(csv / "sessions.csv"));
  EXPECT_TRUE(fs::exists(report));
  EXPECT_EQ(Store(path, Open::Write).left_to_clean().size(), 2u);
  fs::remove_all(csv);
  fs::remove(report);
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty());
  EXPECT_EQ(count("export"), 0);
}

TEST_F(Exports, OnAnotherComputerAreNamed) {
  export_csv(path, csv);
  change("UPDATE export SET host = 'elsewhere'");
  EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr("'elsewhere'")));
  EXPECT_TRUE(fs::exists(csv));
  EXPECT_THAT(Store(path, Open::Write).left_to_clean(), IsEmpty());  // nothing to do on this computer
  EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr("'elsewhere'")));
}

TEST_F(Exports, ThatWereMovedAreNamedOnce) {
  export_csv(path, csv);
  fs::rename(csv, folder / "moved");
  EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr("no longer there")));
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty());
}

// The deletion of an export is interrupted at one of three steps: after its row in the register was marked,
// after its folder got the name of the draft, and after one of its files was deleted.
TEST_F(Exports, ADeletionThatWasCutIsFinished) {
  for (const int step : {0, 1, 2}) {
    const std::string code = "Q" + std::to_string(step);
    add(code);
    export_csv(path, csv);
    change("UPDATE export SET tackled = 1");
    const fs::path draft = own_exports_at(csv).at(0).draft;
    if (step > 0) fs::rename(csv, draft);
    if (step > 1) fs::remove(draft / "sessions.csv");
    EXPECT_THAT(withdraw(path, code).beside.left, IsEmpty()) << step;
    EXPECT_FALSE(fs::exists(csv) || fs::exists(draft)) << step;
    EXPECT_EQ(count("export"), 0);
  }
}

TEST_F(Exports, DoNotOutliveAWithdrawalWhileTheyAreWritten) {
  const auto people = everybody(*open_database(path, Open::Read, read_schema_steps()));
  RegisteredExport record(path, "csv", csv, people);
  record.will_be("0");
  withdraw(path, "P01");
  fs::create_directory(csv);
  EXPECT_THAT([&] { record.is_in_place(); }, ThrowsMessage<base::Error>(HasSubstr("withdrew while")));
  EXPECT_FALSE(fs::exists(csv));
}

TEST_F(Exports, OfADatabaseWithoutALogAreMade) {
  const auto without_log = [&] {
    ASSERT_EQ(Connection(path, Open::Write).text("PRAGMA journal_mode = DELETE"), "delete");
  };
  without_log();
  export_csv(path, csv);
  without_log();
  export_bids(path, folder / "bids");
  without_log();
  export_psych_ds(path, folder / "psych");
  EXPECT_EQ(count("export"), 3);
}

TEST_F(Exports, OfASourceAreKnownAfterAMerge) {
  export_csv(path, csv);
  merge({path}, folder / "all.db");
  EXPECT_THAT(withdraw(folder / "all.db", "P01").beside.cleaned, ElementsAre(csv));
  // In the other direction: a merge that brings a withdrawal to a station deletes the station's own export.
  add("P02");
  export_csv(path, csv);
  EXPECT_THAT(merge({folder / "all.db"}, path).beside.cleaned, ElementsAre(csv));
}

// Registering an export takes no writer lock, so it can happen at any moment of a merge. Here it happens
// before every 20th read of the merge; if it happened more often, SQLite could give up reading.
TEST_F(Exports, EnteredAtAnyMomentOfAMergeAreKnownAfterIt) {
  Store(folder / "south.db", Open::Create).add_run(test::run_plan(test::pairs(), {"P02"}));
  const pid_t merging = ::fork();
  if (merging == 0) {
    faults::arm_calls(
        {.folder = folder.path(), .kind = faults::CallPlan::Kind::Pause, .at = 20, .reads = true});
    merge({folder / "south.db"}, path);
    ::_exit(0);
  }
  std::vector<std::string> entered;
  int refused = 0, status = 0;
  while (::waitpid(merging, &status, WUNTRACED) == merging && WIFSTOPPED(status)) {
    const std::string name = "'/e" + std::to_string(entered.size()) + "'";
    try {
      Connection now(path, Open::Write);
      now.mark_commits();  // as every program of the project does
      now.execute("PRAGMA busy_timeout = 0");
      sqlite::Transaction transaction(now);
      now.execute("INSERT INTO export (kind, path, host, sha256, utc, tackled) VALUES ('csv', " + name +
                  ", 'here', '', '2026-01-01T00:00:00Z', 0)");
      transaction.commit();
      entered.push_back(name);
    } catch (const sqlite::LockedOut&) {
      ++refused;
    }
    ::kill(merging, SIGCONT);
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_GT(refused, 0);  // some are, while the merge commits
  ASSERT_GT(entered.size(), 10u);
  for (const std::string& name : entered) EXPECT_EQ(count("export WHERE path = " + name), 1) << name;
}

TEST_F(Exports, OfSingleFilesAreForTheOwnerAloneWithTheFoldersMadeForThem) {
  const auto rights = [](const fs::path& file) {
    return static_cast<unsigned>(fs::status(file).permissions());
  };
  const fs::path tables = folder / "a" / "tables";
  base::write_file_atomically(folder / "report.json", "");
  fs::permissions(folder / "report.json", fs::perms(0644));
  const mode_t before = ::umask(0);
  const RegisteredFiles files(path);
  files.make_folder(tables / "");
  files.write("vip-stats report", tables / "cells.csv", "P01");
  files.write("vip-stats report", folder / "report.json", "{}");
  ::umask(before);
  for (const fs::path& made : {tables, folder / "a"}) EXPECT_EQ(rights(made), 0700u) << made;
  for (const fs::path& made : {tables / "cells.csv", folder / "report.json"})
    EXPECT_EQ(rights(made), 0600u) << made;
}

TEST_F(Exports, FoldersMadeForFilesGoWhenNothingIsLeftInThem) {
  fs::create_directory(folder / "theirs");
  const RegisteredFiles files(path);
  for (const fs::path& made : {folder / "a" / "b", folder / "c", folder / "theirs"}) {
    files.make_folder(made);
    files.write("vip-stats report", made / "cells.csv", "P01");
  }
  std::ofstream(folder / "c" / "my notes.txt") << "mine";
  add("P02");
  RegisteredFiles(path).make_folder(folder / "c");  // the folder exists already
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty());
  EXPECT_FALSE(fs::exists(folder / "a"));
  EXPECT_TRUE(fs::is_empty(folder / "theirs"));
  EXPECT_TRUE(fs::exists(folder / "c" / "my notes.txt"));
  EXPECT_EQ(count("export"), 1);  // "c" is left for a later withdrawal
}

TEST_F(Exports, ThatFailWriteNothingIntoTheRegister) {
  EXPECT_THAT([&] { RegisteredFiles(path).write("vip-stats report", "/dev/full", "{}"); },
              ThrowsMessage<base::Error>(HasSubstr("/dev/full")));
  base::write_file_atomically(folder / "file", "");
  EXPECT_THROW(RegisteredFiles(path).write("vip-stats report", folder / "file" / "a.json", "{}"),
               base::Error);
  EXPECT_EQ(count("export"), 0);
}

TEST_F(Exports, OfEarlierVersionsAreNamedUntilTheyAreGone) {
  change(
      "DELETE FROM export_person; DELETE FROM export;"
      "INSERT INTO export VALUES (1, 'unknown', '" +
      csv.string() +
      "', '', '', 't', 0);"
      "INSERT INTO export_person SELECT 1, person FROM session");
  fs::create_directory(csv);
  for (int times = 0; times < 2; ++times)
    EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr(csv.string())));
}

}  // namespace
}  // namespace study
