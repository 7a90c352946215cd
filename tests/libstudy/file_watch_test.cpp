/// A database that is deleted, replaced or overwritten while a session writes it.
#include "libstudy/store/file/file_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <functional>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Copies as `cp` does: the target remains the same file and gets new bytes.
void copy_over(const fs::path& from, const fs::path& to) {
  const std::string bytes = test::bytes_of(from);
  std::FILE* file = std::fopen(to.c_str(), "wb");
  std::fwrite(bytes.data(), 1, bytes.size(), file);
  std::fclose(file);
}

/// Two studies. A session of the first one is open.
class Replaced : public ::testing::Test {
 protected:
  Replaced() {
    Store(other_, Open::Create).add_run(test::run_plan(test::pilot(), {"P11", "P12"}));
    store_ = std::make_unique<Store>(path_, Open::Create);
    store_->add_run(test::run_plan(test::pilot(), {"P01"}));
    session_ = store_->open_runs().at(0).sessions.at(0);
    write("before");
  }

  void write(const std::string& words) { store_->note(session_.id, {}, words); }

  fs::path rescued(const std::string& extension) const {
    for (const auto& entry : fs::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("study.db.rescued-") && name.ends_with(extension)) return entry.path();
    }
    return {};
  }

  /// Expects that each write throws `problem`, and that SQLite's log and shared memory are gone after the
  /// session.
  void expect_stop(const std::string& problem) {
    EXPECT_THAT([&] { write("after"); },
                ThrowsMessage<base::Error>(AllOf(HasSubstr(path_.string()), HasSubstr(problem))));
    EXPECT_THAT([&] { write("later"); }, ThrowsMessage<base::Error>(HasSubstr(problem)));
    store_.reset();
    EXPECT_FALSE(fs::exists(path_.string() + "-wal"));
    EXPECT_FALSE(fs::exists(path_.string() + "-shm"));
  }

  /// Expects a copy of the study beside the database's path that only its owner may read. The copy has all
  /// notes, also the one whose write met the problem.
  void expect_rescued() {
    const fs::path saved = rescued(".db");
    ASSERT_FALSE(saved.empty());
    struct stat file {};
    ::stat(saved.c_str(), &file);
    EXPECT_EQ(file.st_mode & 0777, 0600u);
    EXPECT_EQ(Connection(saved, Open::Read).text("SELECT group_concat(words) FROM note"), "before,after");
    fs::rename(saved, path_);
    Store again(path_, Open::Write);
    EXPECT_EQ(again.open_runs().at(0).sessions.at(0).plan.participant, "P01");
  }

  const test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "study.db", other_ = folder_ / "other.db";
  std::unique_ptr<Store> store_;
  OpenSession session_;
};

TEST_F(Replaced, ADeletedDatabaseIsSavedBesideItsPath) {
  fs::remove(path_);
  expect_stop("was deleted or moved away");
  EXPECT_FALSE(fs::exists(path_));
  expect_rescued();
}

TEST_F(Replaced, AnotherDatabaseMovedThereStaysAsItIs) {
  const std::string before = test::bytes_of(other_);
  fs::rename(other_, path_);
  expect_stop("was replaced by another file");
  EXPECT_TRUE(test::bytes_of(path_) == before);
  EXPECT_EQ(read_status({path_, true}).sessions.size(), 2u);  // true: despite the first study's journal
  fs::remove(path_);
  expect_rescued();
}

TEST_F(Replaced, ALogThatWasDeletedIsSavedWithTheRest) {
  fs::remove(path_.string() + "-wal");
  expect_stop("lost its log");
  expect_rescued();
}

TEST_F(Replaced, AnotherDatabaseCopiedOverItStaysAsItIs) {
  copy_over(other_, path_);
  expect_stop("was written over by another program");
  EXPECT_TRUE(test::bytes_of(path_) == test::bytes_of(other_));
  EXPECT_EQ(read_status({path_, true}).sessions.size(), 2u);  // true: despite the first study's journal
  // If SQLite's cached pages make a complete database, it is saved; otherwise the log is saved.
  EXPECT_FALSE(rescued(".db").empty() && rescued(".wal").empty());
}

TEST_F(Replaced, ItIsNoticedAtTheEndToo) {
  const std::string before = test::bytes_of(other_);
  fs::rename(other_, path_);
  store_.reset();
  EXPECT_TRUE(test::bytes_of(path_) == before);
  EXPECT_FALSE(fs::exists(path_.string() + "-wal"));
  EXPECT_EQ(Connection(rescued(".db"), Open::Read).text("SELECT words FROM note"), "before");
}

TEST_F(Replaced, WhatOtherProgramsMayDoWithADatabaseStopsNothing) {
  for (int i = 0; i < 4; ++i) {
    {
      Connection other(path_, Open::Write);
      other.execute("PRAGMA wal_autocheckpoint = 1");
      other.execute("INSERT INTO event (utc, kind, detail) VALUES ('now', 'elsewhere', 'x')");
      if (i == 2) sqlite3_wal_checkpoint_v2(other.handle(), "main", SQLITE_CHECKPOINT_FULL, nullptr, nullptr);
    }
    read_status(path_);
    write("note " + std::to_string(i));
  }
  store_.reset();
  EXPECT_EQ(Connection(path_, Open::Read).integer("SELECT count(*) FROM note"), 5);
  EXPECT_TRUE(rescued("").empty());
}

TEST_F(Replaced, ItsOwnLogMayBeCopiedBackAsOftenAsItLikes) {
  const OpenUnit& unit = session_.units.at(2);
  for (int attempt = 1; attempt <= 6; ++attempt) {
    const auto id = store_->begin_presentation(session_.id, unit.trial_id, attempt, 0, unit.trial->first, 0);
    store_->add_frames(id, 0, test::frames(0, 30000));
  }
  store_.reset();
  EXPECT_EQ(Connection(path_, Open::Read).integer("SELECT count(*) FROM frame"), 180000);
}

/// If the database has no write-ahead log, the watch must not open SQLite's shared-memory file, because
/// SQLite would never close it.
TEST(FileWatch, OpensNoSharedMemoryWhereThereIsNoLog) {
  const test::TemporaryFolder folder;
  Connection database(folder / "s.db", Open::Create);
  database.execute("PRAGMA journal_mode = DELETE; CREATE TABLE t (a)");
  database.watch();
  database.execute("INSERT INTO t VALUES (1)");
  EXPECT_FALSE(fs::exists(folder / "s.db-shm"));
}

}  // namespace
}  // namespace study
