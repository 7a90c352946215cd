/// One writer at a time creates, locks and removes a database; only its owner may read its files.
#include "libstudy/store/file/writer_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

enum Outcome { Kept = 0, Busy = 1, Failed = 2, Other = 3 };

/// Waits until the other end of the pipe is closed.
void wait_for(int pipe) {
  char byte = 0;
  while (::read(pipe, &byte, 1) < 0) {
  }
}

/// Plans a session in a new database at the same moment as all other processes of a round, and keeps the
/// database open until `release` is closed. Every third process finds no room on the disk. Writes a byte to
/// `tried` once it has the database or has failed.
Outcome start(const fs::path& path, int number, int go, int tried, int release) {
  wait_for(go);
  bool told = false;
  const auto tell = [&] { return std::exchange(told, true) || ::write(tried, "t", 1) == 1; };
  try {
    const bool no_room = number % 3 == 2;
    Store store(path, Open::Create, no_room ? 2 : 0);
    if (!tell()) return Other;
    store.add_run(test::run_plan(test::pilot(), {"P" + std::to_string(10 + number)}));
    wait_for(release);
    return Kept;
  } catch (const base::Error& error) {
    if (!tell()) return Other;
    const std::string text = error.what();
    if (text.find("another vip-study is running") != std::string::npos) return Busy;
    if (text.find("no room left") != std::string::npos) return Failed;
    std::fprintf(stderr, "%s\n", error.what());
  }
  return Other;
}

TEST(WriterLock, ManyFirstStartsAtOnceLoseNothing) {
  const test::TemporaryFolder folder;
  constexpr int rounds = 15, starts = 6;
  int busy = 0;
  for (int round = 0; round < rounds; ++round) {
    const fs::path path = folder / (std::to_string(round) + ".db");
    int gate[2], tried[2], release[2];
    ASSERT_EQ(::pipe(gate), 0);
    ASSERT_EQ(::pipe(tried), 0);
    ASSERT_EQ(::pipe(release), 0);
    std::array<pid_t, starts> children{};
    for (int i = 0; i < starts; ++i) {
      children[static_cast<std::size_t>(i)] = ::fork();
      if (children[static_cast<std::size_t>(i)] == 0) {
        ::close(gate[1]);
        ::close(release[1]);
        ::_exit(start(path, i, gate[0], tried[1], release[0]));
      }
    }
    const bool overlap =
        round % 2 == 0;  // true: the process that gets the database keeps it until all have tried
    if (!overlap) ::close(release[1]);
    ::close(gate[1]);  // starts all processes
    ::close(tried[1]);
    for (int i = 0; i < starts; ++i) {
      char byte = 0;
      ASSERT_EQ(::read(tried[0], &byte, 1), 1);
    }
    if (overlap) ::close(release[1]);
    for (const int end : {gate[0], tried[0], release[0]}) ::close(end);
    int kept = 0;
    for (const pid_t child : children) {
      int status = 0;
      ::waitpid(child, &status, 0);
      const int outcome = WIFEXITED(status) ? WEXITSTATUS(status) : Other;
      EXPECT_NE(outcome, Other);
      kept += outcome == Kept;
      busy += outcome == Busy;
    }
    if (kept == 0) {
      EXPECT_FALSE(fs::exists(path));
    } else {
      EXPECT_EQ(Connection(path, Open::Read).integer("SELECT count(*) FROM session"), kept);
    }
  }
  EXPECT_GE(busy, rounds / 2 * 3) << "of six, one holds it and two find no room";
}

TEST(WriterLock, IsRefusedWhereTheFileCannotBeOpened) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { WriterLock(folder / "none.db"); },
              ThrowsMessage<base::Error>(HasSubstr("there is no such database")));
  EXPECT_THAT([&] { WriterLock(folder.path(), Open::Create); },
              ThrowsMessage<base::Error>(HasSubstr("is a folder")));
  EXPECT_TRUE(fs::is_empty(folder.path()));
  base::write_file_atomically(folder / "file", "");
  EXPECT_THAT([&] { WriterLock(folder / "file" / "a.db", Open::Create); },
              ThrowsMessage<base::Error>(HasSubstr((folder / "file").string())));
}

TEST(WriterLock, RemovesOnlyWhatItMadeAndWhatIsStillThere) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  { const WriterLock lock(path, Open::Create); }
  EXPECT_FALSE(fs::exists(path));
  {
    const WriterLock lock(path, Open::Create);
    fs::remove(path);
    base::write_file_atomically(path, "of somebody else");
  }
  EXPECT_EQ(test::bytes_of(path), "of somebody else");
  { const WriterLock lock(path, Open::Create); }
  EXPECT_EQ(test::bytes_of(path), "of somebody else");
}

TEST(WriterLock, TakesOverTheEmptyFileOfAStartThatLostTheRace) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  base::write_file_atomically(path, "");
  { const WriterLock lock(path, Open::Write); }
  EXPECT_TRUE(fs::exists(path)) << "whoever makes no database removes none";
  { const WriterLock lock(path, Open::Create); }
  EXPECT_FALSE(fs::exists(path));
}

/// True if another process can lock the database exclusively.
bool free_for_others(const fs::path& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    sqlite::Connection other(path, Open::Write);
    other.wait_with([](const std::string&) { return false; });
    try {
      other.text("PRAGMA locking_mode = EXCLUSIVE");
      other.execute("BEGIN EXCLUSIVE; COMMIT");
      other.text("PRAGMA journal_mode = DELETE");
    } catch (const base::Error&) {
      ::_exit(0);
    }
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status) == 1;
}

TEST(WriterLock, NothingThatThisProcessDoesBesideGivesSqlitesLocksAway) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store store(path, Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  open_database(path, Open::Read, read_schema_steps());
  EXPECT_THROW(Store(path, Open::Write), base::Error);
  EXPECT_THROW(merge({path}, path), base::Error);
  EXPECT_FALSE(free_for_others(path));
  store.log({}, "still", "writable");
}

unsigned rights(const fs::path& path) {
  struct stat file {};
  return ::stat(path.c_str(), &file) == 0 ? file.st_mode & 0777 : 0;
}

TEST(PrivateFiles, ADatabaseAndAllBesideItAreForTheOwnerAlone) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  const mode_t before = ::umask(0);
  {
    Store store(path, Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01"}));
    for (const char* part : {"", "-wal", "-shm"}) EXPECT_EQ(rights(path.string() + part), 0600u) << part;
  }
  ::chmod(path.c_str(), 0644);
  open_database(path, Open::Read, read_schema_steps());
  EXPECT_EQ(rights(path), 0644u);
  auto steps = read_schema_steps();
  steps.push_back("ALTER TABLE session ADD COLUMN weather TEXT;");
  open_database(path, Open::Write, steps);
  Store(folder / "all.db", Open::Create).add_run(test::run_plan(test::pilot(), {"P02"}));
  ::umask(before);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_EQ(rights(entry.path()), 0600u) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 5);  // two databases, their journals, a backup
}

TEST(PrivateFiles, AFileThatIsNotOursKeepsItsRights) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "text.db";
  base::write_file_atomically(path, std::string(5000, 'x'));
  ::chmod(path.c_str(), 0644);
  EXPECT_THROW(Store(path, Open::Write), base::Error);
  EXPECT_EQ(rights(path), 0644u);
}

}  // namespace
}  // namespace study
