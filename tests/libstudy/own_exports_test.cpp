/// A withdrawal deletes only exports that this installation registered and that are unchanged.
#include "libstudy/store/own_exports.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/faults/child.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

/// Sets $VIP_STATE_DIR, where the installation lists the exports that it made, for one test.
class StateAt {
 public:
  explicit StateAt(const fs::path& folder) : before_(std::getenv("VIP_STATE_DIR")) {
    ::setenv("VIP_STATE_DIR", folder.c_str(), 1);
  }
  ~StateAt() { ::setenv("VIP_STATE_DIR", before_.c_str(), 1); }
  StateAt(const StateAt&) = delete;
  StateAt& operator=(const StateAt&) = delete;

 private:
  std::string before_;
};

class OwnExports : public ::testing::Test {
 protected:
  OwnExports() { add(path, {"P01", "P02"}); }
  static void add(const fs::path& database, const std::vector<std::string>& codes) {
    Store(database, Open::Create).add_run(test::run_plan(test::pairs(), codes));
  }
  static void change(const fs::path& database, const std::string& sql) {
    Connection(database, Open::Write).execute(sql);
  }
  static std::int64_t count(const fs::path& database, const std::string& table) {
    return Connection(database, Open::Read).integer("SELECT count(*) FROM " + table);
  }

  /// Runs `work` in a process that is killed before its `at`-th change of a file in the folder. Returns false
  /// if the process ended before that change.
  bool is_killed(long at, const std::function<void()>& work) {
    const auto ended = faults::run_child(
        {.folder = folder.path(), .kind = faults::CallPlan::Kind::Kill, .at = at, .log = &log}, work);
    EXPECT_THAT(ended.how, AnyOf(faults::Ended::How::Done, faults::Ended::How::Killed)) << ended.problem;
    return ended.how == faults::Ended::How::Killed;
  }

  test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", csv = folder / "csv";
  faults::CallLog log;
};

/// A foreign database that names several paths of this computer as exports of a person who withdrew.
class ForeignDatabase : public OwnExports {
 protected:
  ForeignDatabase() {
    add(theirs, {"X01"});
    fs::create_directories(home / "photos");
    fs::create_directory(folder / "empty");
    fs::create_directory(home.string() + ".tmp0123456789abcdef");
    base::write_file_atomically(home / "photos" / "a.jpg", "a");
    base::write_file_atomically(folder / "thesis.txt", "my thesis");
    export_csv(path, csv);
    base::write_file_atomically(home / "export.sha256", list_of_files(home, "csv", std::string(32, '0')));
    claim("csv", home, base::sha256_hex(test::bytes_of(home / "export.sha256")));
    claim("csv", csv, base::sha256_hex(test::bytes_of(csv / "export.sha256")));
    claim("vip-stats report", folder / "thesis.txt", base::sha256_hex("my thesis"));
    claim("folder", folder / "empty", "");
    change(theirs,
           "INSERT INTO export_person SELECT export_id, 'ghost' FROM export;"
           "INSERT INTO tombstone VALUES ('ghost', 'X09', 'X09', 'far', '2026-01-01T00:00:00Z')");
  }
  void claim(const std::string& kind, const fs::path& what, const std::string& sha256) {
    Connection database(theirs, Open::Write);
    sqlite::Statement(database,
                      "INSERT INTO export (kind, path, host, sha256, utc, tackled) VALUES (?,?,?,?,'t',0)")
        .bind_all(kind, what.string(), host(), sha256)
        .run();
  }
  static std::string host() {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    return name;
  }
  void expect_nothing_deleted(const std::string& after) {
    for (const fs::path& mine :
         {home / "photos" / "a.jpg", home / "export.sha256", folder / "thesis.txt", folder / "empty",
          fs::path(home.string() + ".tmp0123456789abcdef"), csv / "sessions.csv"})
      EXPECT_TRUE(fs::exists(mine)) << mine << " is gone after " << after;
  }

  const fs::path home = folder / "home", theirs = folder / "theirs.db";
};

TEST_F(ForeignDatabase, DeletesNothingWhenItIsOpenedOrTakenUp) {
  EXPECT_EQ(Store(theirs, Open::Write).left_to_clean().size(), 3u);
  expect_nothing_deleted("an opening for writing");
  EXPECT_THAT(withdraw(theirs, "X09").beside.left,
              ::testing::Each(HasSubstr("not registered by this installation")));
  expect_nothing_deleted("a withdrawal");
}

TEST_F(ForeignDatabase, DeletesNothingWhenItIsMerged) {
  const Merge done = merge({theirs}, path);
  EXPECT_THAT(done.beside.cleaned, IsEmpty());
  expect_nothing_deleted("a merge");
}

// A copy of the study from before P03, with a withdrawal, replaces the database. The journal has rows that
// the copy lacks.
TEST_F(OwnExports, StayWhenTheDatabaseIsNotTheOneThatWasWritten) {
  fs::copy_file(path, folder / "before.db");
  add(path, {"P03"});
  export_csv(path, csv);
  {
    const fs::path other = folder / "before.db";
    change(other, "PRAGMA journal_mode = DELETE");
    withdraw(other, "P01");
  }
  Connection(folder / "before.db", Open::Write)
      .execute("ATTACH '" + path.string() +
               "' AS now; INSERT INTO export SELECT * FROM now.export; "
               "INSERT INTO export_person SELECT * FROM now.export_person; DETACH now; "
               "PRAGMA wal_checkpoint(TRUNCATE)");
  for (const char* log : {"-wal", "-shm"}) fs::remove(path.string() + log);
  fs::copy_file(folder / "before.db", path, fs::copy_options::overwrite_existing);
  EXPECT_THAT([&] { Store(path, Open::Write); },
              ThrowsMessage<base::Error>(HasSubstr("are in the journal only")));
  EXPECT_THAT([&] { withdraw(path, "X99"); },
              ThrowsMessage<base::Error>(HasSubstr("are in the journal only")));
  EXPECT_TRUE(fs::exists(csv / "sessions.csv"));
}

TEST_F(OwnExports, OfAnotherStudyInTheSamePlaceStay) {
  const fs::path other = folder / "other.db";
  add(other, {"Q01"});
  const RegisteredFiles report(path), theirs(other);
  export_csv(path, csv);
  export_csv(other, csv);
  report.write("vip-stats report", folder / "r.json", "{\"of\": \"P01\"}");
  theirs.write("vip-stats report", folder / "r.json", "{\"of\": \"Q01\"}");
  EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr("another export is now at its path"),
                                                             HasSubstr("another export is now at its path")));
  EXPECT_THAT(test::bytes_of(csv / "sessions.csv"), HasSubstr("Q01"));
  EXPECT_THAT(test::bytes_of(folder / "r.json"), HasSubstr("Q01"));
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty()) << "it is said once";
  EXPECT_THAT(withdraw(other, "Q01").beside.cleaned, ElementsAre(csv, folder / "r.json"));
}

TEST_F(OwnExports, ThatAreDeletedAlreadyRaiseNoAlarmInDatabasesOfBefore) {
  export_csv(path, csv);
  const fs::path all = folder / "all.db";
  merge({path}, all);
  EXPECT_THAT(withdraw(path, "P01").beside.cleaned, ElementsAre(csv));
  EXPECT_THAT(test::bytes_of(own_exports_file()), ::testing::Not(HasSubstr(csv.string())));
  EXPECT_THAT(merge({path}, all).beside.left, IsEmpty());
  // An export that was moved away is still named.
  export_csv(path, csv);
  fs::rename(csv, folder / "moved");
  EXPECT_THAT(withdraw(path, "P02").beside.left, ElementsAre(HasSubstr("no longer there")));
}

TEST_F(OwnExports, ThatWereEditedByHandAreNamedAndStay) {
  export_csv(path, csv);
  export_bids(path, folder / "bids");
  std::ofstream(csv / "ratings.csv", std::ios::app) << "my note\r\n";
  fs::remove(folder / "bids" / "README.md");
  EXPECT_THAT(withdraw(path, "P01").beside.left,
              ElementsAre(HasSubstr("is not as it was written"), HasSubstr("is not as it was written")));
  EXPECT_THAT(test::bytes_of(csv / "ratings.csv"), HasSubstr("my note"));
  EXPECT_TRUE(fs::exists(folder / "bids" / "participants.tsv"));
}

TEST_F(OwnExports, AreReplacedAsTheyWereWrittenAlone) {
  export_bids(path, folder / "bids");
  fs::create_directories(folder / "bids" / "derivatives");
  std::ofstream(folder / "bids" / "derivatives" / "mine.tsv") << "mine";
  EXPECT_THAT([&] { export_bids(path, folder / "bids"); },
              ThrowsMessage<base::Error>(HasSubstr("'derivatives/mine.tsv' was added")));
  EXPECT_TRUE(fs::exists(folder / "bids" / "derivatives" / "mine.tsv"));
  fs::remove_all(folder / "bids" / "derivatives");
  export_bids(path, folder / "bids");
  export_csv(path, csv);
  std::ofstream(csv / "ratings.csv", std::ios::app) << "my note\r\n";
  EXPECT_THAT([&] { export_csv(path, csv); },
              ThrowsMessage<base::Error>(HasSubstr("'ratings.csv' was changed")));
  EXPECT_THAT(test::bytes_of(csv / "ratings.csv"), HasSubstr("my note"));
}

TEST_F(OwnExports, WithoutARegisterAreMadeAndOnlyNamed) {
  base::write_file_atomically(folder / "file", "no folder");
  for (const fs::path& nowhere : {folder / "file", fs::path()}) {
    const StateAt state(nowhere);
    EXPECT_TRUE(why_not_registered().has_value());
    export_csv(path, csv);
    EXPECT_THAT(withdraw(path, nowhere.empty() ? "P02" : "P01").beside.left,
                ElementsAre(HasSubstr("not registered by this installation")));
    EXPECT_TRUE(fs::exists(csv / "sessions.csv"));
  }
  EXPECT_FALSE(why_not_registered().has_value());
}

TEST_F(OwnExports, OfARegisterThatOthersMayWriteAreOnlyNamed) {
  const StateAt state(folder / "state");
  export_csv(path, csv);
  EXPECT_EQ(fs::status(own_exports_file()).permissions(), fs::perms(0600));
  EXPECT_EQ(fs::status(folder / "state").permissions(), fs::perms(0700));
  fs::permissions(own_exports_file(), fs::perms(0622));
  EXPECT_THAT(withdraw(path, "P01").beside.left, ElementsAre(HasSubstr("that only you may write to")));
  EXPECT_TRUE(fs::exists(csv / "sessions.csv"));
  fs::permissions(own_exports_file(), fs::perms(0600));
  EXPECT_THAT(withdraw(path, "P01").beside.left, IsEmpty()) << "the mend that it names";
  EXPECT_FALSE(fs::exists(csv));
}

/// Files below a folder that contain the text, without study.db, the files beside it that begin with its
/// name, and the folder "state".
std::vector<std::string> files_with(const fs::path& folder, const std::string& text) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (!entry.is_regular_file() || name.starts_with("study.db") || name.starts_with("state")) continue;
    if (test::bytes_of(entry.path()).find(text) != std::string::npos) names.push_back(name);
  }
  return names;
}

// An export that replaces an earlier one is killed, first before its first change of a file and then
// 61 changes later each time. A withdrawal afterwards must leave no file with the person's code.
TEST_F(OwnExports, StoppedAnywhereHoldNobodyWhoWithdrewThen) {
  const StateAt state(folder / "state");
  int stops = 0;
  for (long at = 1;; at += 61) {
    const std::string code = "QXJ" + std::to_string(at);
    add(path, {code});
    export_csv(path, csv);
    const bool killed = is_killed(at, [&] { export_csv(path, csv, {.words = true}); });
    EXPECT_THAT(withdraw(path, code).beside.left, IsEmpty()) << at;
    EXPECT_THAT(files_with(folder.path(), code), IsEmpty()) << at;
    if (!killed) break;
    ++stops;
  }
  EXPECT_GT(stops, 10);
}

// The withdrawal is killed, first before its first change of a file and then 37 changes later each time. It
// is then repeated.
TEST_F(OwnExports, AreDeletedWhereverTheWithdrawalWasStopped) {
  const StateAt state(folder / "state");
  int stops = 0;
  for (long at = 1;; at += 37) {
    const std::string code = "QXJ" + std::to_string(at);
    add(path, {code});
    export_csv(path, csv);
    RegisteredFiles(path).write("vip-stats report", folder / "r.json", code);
    const bool killed = is_killed(at, [&] { withdraw(path, code); });
    EXPECT_THAT(withdraw(path, code).beside.left, IsEmpty()) << at;
    EXPECT_THAT(files_with(folder.path(), code), IsEmpty()) << at;
    EXPECT_FALSE(fs::exists(csv)) << at;
    if (!killed) break;
    ++stops;
  }
  EXPECT_GT(stops, 10);
}

}  // namespace
}  // namespace study
