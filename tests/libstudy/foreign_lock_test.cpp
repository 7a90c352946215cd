/// Another program keeps the database locked: a session waits, and loses nothing if it is asked to give up.
/// And the program's own lock stays while it opens the database once more.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/page_file.hpp"
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

/// A process that keeps a write transaction open, as a database browser may do.
class Browser {
 public:
  explicit Browser(const fs::path& path) {
    int ready[2];
    if (::pipe(ready) != 0) throw std::runtime_error("no pipe; raise ulimit -n");
    process_ = ::fork();
    if (process_ == 0) {
      Connection database(path, Open::Write);
      database.execute("BEGIN IMMEDIATE");
      [[maybe_unused]] const auto told = ::write(ready[1], "x", 1);
      for (;;) ::pause();
    }
    ::close(ready[1]);
    char byte = 0;
    [[maybe_unused]] const auto heard = ::read(ready[0], &byte, 1);
    ::close(ready[0]);
  }
  ~Browser() { close(); }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void close() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  std::string name() const { return "(process " + std::to_string(process_) + ")"; }

 private:
  pid_t process_ = -1;
};

class ForeignLock : public ::testing::Test {
 protected:
  ForeignLock() { Store(path_, Open::Create).add_run(test::run_plan(test::pilot(), {"P01"})); }

  static void give_consent(Store& store, const OpenSession& session) {
    for (const OpenUnit& unit : session.units) {
      if (unit.trial_id != 0) continue;
      KeptAnswer answer{"take_part", {}};
      answer.answer.answer.score = 1;
      store.answer(session.id, unit, 0, std::vector{answer}, true, 0);
      return;
    }
  }
  std::int64_t answers() const {
    return Connection(path_, Open::Read).integer("SELECT count(*) FROM response");
  }

  const test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "study.db";
};

TEST_F(ForeignLock, IsWaitedForAndNamed) {
  Browser browser(path_);
  std::vector<std::string> told;
  const std::string name = browser.name();
  {
    Store store(path_, Open::Write, 0, [&](const std::string& holder) {
      told.push_back(holder);
      if (told.size() == 2) browser.close();
      return true;
    });
    store.log({}, "test", "");
  }
  ASSERT_GE(told.size(), 2u);
  EXPECT_THAT(told[0], HasSubstr(name));
  EXPECT_EQ(Connection(path_, Open::Read).integer("SELECT count(*) FROM event WHERE kind = 'test'"), 1);
}

TEST_F(ForeignLock, AnAnswerThatCannotBeCommittedIsKeptForTheNextOpening) {
  std::string name;
  {
    bool stop = false;
    Store store(path_, Open::Write, 0, [&](const std::string&) { return !stop; });
    const OpenSession session = store.open_runs().at(0).sessions.at(0);
    Browser browser(path_);
    stop = true;
    name = browser.name();
    EXPECT_THAT([&] { give_consent(store, session); },
                ThrowsMessage<base::Error>(AllOf(HasSubstr("is locked by"), HasSubstr(name),
                                                 HasSubstr("vip-study resume --db " + path_.string()))));
    // The same answer, given again, is refused. This must not drop the first one, which is still kept.
    EXPECT_THAT([&] { give_consent(store, session); },
                ThrowsMessage<base::Error>(HasSubstr("takes no answer")));
    EXPECT_THROW(store.note(1, {}, "said while it waited"), sqlite::LockedOut);
    browser.close();
    EXPECT_THROW(store.log({}, "test", ""), sqlite::LockedOut);
  }
  EXPECT_EQ(answers(), 0);
  Store again(path_, Open::Write);
  EXPECT_EQ(answers(), 1);
  EXPECT_EQ(again.open_runs().at(0).sessions.at(0).done, 1u);
  EXPECT_EQ(Connection(path_, Open::Read).text("SELECT words FROM note"), "said while it waited");
}

/// True if another process sees a lock of this process on the file.
bool is_locked(const fs::path& path) {
  const pid_t process = ::fork();
  if (process == 0) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    const int file = ::open(path.c_str(), O_RDWR);
    ::_exit(::fcntl(file, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK ? 0 : 1);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  return status == 0;
}

// Beside a database of schema 1 lies a rollback journal that says that the file was empty, so the database
// holds nothing.
TEST(OwnLock, StaysWhenADatabaseThatHoldsNothingIsRefused) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "young.db";
  Connection young(path, Open::Create);
  young.execute("PRAGMA application_id = " + std::to_string(database_application_id) +
                "; PRAGMA user_version = 1; CREATE TABLE trial (a); BEGIN IMMEDIATE");
  std::string journal(salvaging::rollback_magic);
  journal.resize(512, '\0');
  base::write_file_atomically(path.string() + "-journal", journal);
  ASSERT_TRUE(is_locked(path));
  EXPECT_THAT([&] { open_database(path, Open::Read, read_schema_steps()); },
              ThrowsMessage<base::Error>(HasSubstr("holds nothing")));
  EXPECT_TRUE(is_locked(path));
}

}  // namespace
}  // namespace study
