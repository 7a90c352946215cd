/// A database after a kill, a full disk or a power cut opens like any other.
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Runs `action` in a child process that ends without closing anything, as a killed process does. Returns the
/// action's result, 99 if it throws.
int in_child(const std::function<int()>& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    int result = 99;
    try {
      result = action();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "child: %s\n", error.what());
    }
    ::_exit(result);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void add_notes(Connection& database, int count) {
  for (int i = 0; i < count; ++i) {
    sqlite::Transaction transaction(database);
    sqlite::Statement(database, "INSERT INTO note (session_id, utc, words) VALUES (1, 'now', ?)")
        .bind_all(std::string(3000, 'n'))
        .run();
    transaction.commit();
  }
}

constexpr int notes = 60;

/// A study whose log holds all its notes, left by a process that died while it copied the log back: the file
/// system accepted only the first `bytes` of the file. Returns false if that was the whole file.
bool left_in_a_checkpoint(const fs::path& path, rlim_t bytes) {
  Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  const int result = in_child([&] {
    const auto database = open_database(path, Open::Write, read_schema_steps());
    database->execute("PRAGMA wal_autocheckpoint = 0");
    add_notes(*database, notes);
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return sqlite3_wal_checkpoint_v2(database->handle(), "main", SQLITE_CHECKPOINT_PASSIVE, nullptr,
                                     nullptr) == SQLITE_OK
               ? 1
               : 0;
  });
  EXPECT_LE(result, 1);
  return result == 0;
}

TEST(Recovery, ADatabaseLeftInACheckpointIsReadAndWritten) {
  const test::TemporaryFolder folder;
  int cut = 0;
  for (rlim_t pages = 1;; pages += 23) {
    SCOPED_TRACE(pages);
    const fs::path path = folder / (std::to_string(pages) + ".db");
    const bool left = left_in_a_checkpoint(path, pages * 4096);
    EXPECT_EQ(read_status(path).sessions.size(), 1u);
    EXPECT_EQ(Store(path, Open::Write).open_runs().size(), 1u);
    EXPECT_EQ(Connection(path, Open::Read).integer("SELECT count(*) FROM note"), notes);
    if (!left) break;
    ++cut;
  }
  EXPECT_GT(cut, 3);
}

TEST(Recovery, StatusIsReadBesideASessionThatCopiesItsLog) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  const pid_t session = ::fork();
  if (session == 0) {
    const auto database = open_database(path, Open::Write, read_schema_steps());
    database->execute("PRAGMA wal_autocheckpoint = 3; PRAGMA synchronous = OFF");
    while (::getppid() != 1) {
      add_notes(*database, 20);
      database->execute("DELETE FROM note");  // keeps the file small, and so fast to read
    }
    ::_exit(0);
  }
  for (int i = 0; i < 60; ++i) EXPECT_EQ(read_status(path).sessions.size(), 1u) << i;
  ::kill(session, SIGKILL);
  ::waitpid(session, nullptr, 0);
  EXPECT_EQ(Store(path, Open::Write).open_runs().size(), 1u);
}

/// Runs `action` as a user who may read the files and write nothing.
int as_reader(const fs::path& path, const std::function<int()>& action) {
  const fs::path folder = path.parent_path();
  for (const auto& entry : fs::directory_iterator(folder)) ::chmod(entry.path().c_str(), 0444);
  ::chmod(folder.c_str(), 0555);
  const int result = in_child([&] {
    constexpr uid_t nobody = 65534;
    if (::geteuid() == 0 && (::setgroups(0, nullptr) != 0 || ::setuid(nobody) != 0)) return 98;
    return action();
  });
  ::chmod(folder.c_str(), 0755);
  return result;
}

TEST(Recovery, WhereNothingMayBeWrittenItIsReadThroughItsLog) {
  const auto steps = read_schema_steps();
  for (const bool shared_memory : {false, true}) {
    const test::TemporaryFolder folder;
    const fs::path path = folder / "study.db";
    ASSERT_TRUE(left_in_a_checkpoint(path, 10 * 4096));
    if (!shared_memory) fs::remove(path.string() + "-shm");
    const std::string file = test::bytes_of(path), log = test::bytes_of(path.string() + "-wal");
    const auto count_notes = [&] {
      return static_cast<int>(open_database(path, Open::Read, steps)->integer("SELECT count(*) FROM note"));
    };
    EXPECT_EQ(as_reader(path, count_notes), notes);
    EXPECT_TRUE(test::bytes_of(path) == file);
    EXPECT_TRUE(test::bytes_of(path.string() + "-wal") == log);
  }
}

TEST(Recovery, WhereNothingMayBeWrittenAClosedFileAndABackupAreRead) {
  const auto steps = read_schema_steps();
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", backup = folder / "study.db.v3.bak";
  Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  Connection(path, Open::Write).execute("VACUUM INTO '" + backup.string() + "'");
  const auto files = std::distance(fs::directory_iterator(folder.path()), {});
  const auto count_trials = [&](const fs::path& which) {
    return as_reader(path, [&] {
      return static_cast<int>(open_database(which, Open::Read, steps)->integer("SELECT count(*) FROM trial"));
    });
  };
  EXPECT_EQ(count_trials(path), 21);
  EXPECT_EQ(count_trials(backup), 21);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), files);
}

/// Ends in a transaction of a database without a log. The file has changed pages, and the rollback journal
/// beside it has their earlier content.
void die_with_a_journal(const fs::path& path, const std::string& sql) {
  EXPECT_EQ(in_child([&] {
              Connection database(path, Open::Create);
              database.text("PRAGMA journal_mode = DELETE");
              database.execute("PRAGMA cache_size = 1; PRAGMA cache_spill = 1; BEGIN");
              database.execute(sql);
              sqlite3_db_cacheflush(database.handle());
              ::_exit(0);
              return 0;
            }),
            0);
  ASSERT_TRUE(fs::file_size(path.string() + "-journal") > 0);
}

TEST(Recovery, AJournalIsUndoneWhereverItIsRead) {
  const auto steps = read_schema_steps();
  for (const bool reader : {false, true}) {
    const test::TemporaryFolder folder;
    const fs::path path = folder / "study.db";
    Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
    die_with_a_journal(path, "DELETE FROM unit; DELETE FROM trial");
    const auto count_trials = [&] {
      return static_cast<int>(open_database(path, Open::Read, steps)->integer("SELECT count(*) FROM trial"));
    };
    EXPECT_EQ(reader ? as_reader(path, count_trials) : count_trials(), 21);
  }
}

TEST(Recovery, AFileCutInItsFirstTransactionIsMadeAnew) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  die_with_a_journal(path, read_schema_steps().front());
  Store store(path, Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  EXPECT_EQ(store.open_runs().size(), 1u);
}

TEST(Recovery, AFileCutAfterItsFirstCommitIsFinished) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Connection(path, Open::Create)
      .execute("PRAGMA application_id = " + std::to_string(database_application_id));
  EXPECT_EQ(open_database(path, Open::Read, read_schema_steps())->integer("SELECT count(*) FROM session"), 0);
  Store store(path, Open::Write);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  EXPECT_EQ(store.open_runs().size(), 1u);
}

TEST(Recovery, ForeignFilesKeepTheirLogAndTheirJournal) {
  const test::TemporaryFolder folder;
  const fs::path logged = folder / "logged.db", journalled = folder / "journalled.db";
  EXPECT_EQ(in_child([&] {
              Connection database(logged, Open::Create);
              database.text("PRAGMA journal_mode = WAL");
              database.execute("CREATE TABLE trial (a); INSERT INTO trial VALUES (1)");
              ::_exit(0);
              return 0;
            }),
            0);
  Connection(journalled, Open::Create).execute("CREATE TABLE trial (a); INSERT INTO trial VALUES (1)");
  die_with_a_journal(journalled, "INSERT INTO trial VALUES (2)");
  const auto expect_refused = [](const fs::path& path, const std::string& beside) {
    const std::string file = test::bytes_of(path), other = test::bytes_of(path.string() + beside);
    for (const Open how : {Open::Create, Open::Write, Open::Read}) {
      EXPECT_THAT([&] { open_database(path, how, read_schema_steps()); },
                  ThrowsMessage<base::Error>(HasSubstr("is not a database of vip-study")));
      EXPECT_TRUE(test::bytes_of(path) == file);
      EXPECT_TRUE(test::bytes_of(path.string() + beside) == other);
    }
  };
  expect_refused(logged, "-wal");
  expect_refused(journalled, "-journal");
}

TEST(Recovery, ANewerVersionThatStandsInTheLogAloneIsRefusedUntouched) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  EXPECT_EQ(in_child([&] {
              Connection database(path, Open::Write);
              database.execute("PRAGMA user_version = 99");
              ::_exit(0);
              return 0;
            }),
            0);
  const std::string file = test::bytes_of(path), log = test::bytes_of(path.string() + "-wal");
  ASSERT_FALSE(log.empty());
  for (const Open how : {Open::Create, Open::Write, Open::Read}) {
    EXPECT_THAT([&] { open_database(path, how, read_schema_steps()); },
                ThrowsMessage<base::Error>(HasSubstr("newer program (schema 99")));
    EXPECT_TRUE(test::bytes_of(path) == file);
    EXPECT_TRUE(test::bytes_of(path.string() + "-wal") == log);
  }
}

TEST(Recovery, WhatSqliteCannotMakeWholeNamesSalvage) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store(path, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THAT(
      [&] { Store(path, Open::Write); },
      ThrowsMessage<base::Error>(HasSubstr("vip-study salvage --db " + path.string() + " --into NEW")));
}

}  // namespace
}  // namespace study
