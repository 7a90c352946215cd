/// The journal of answers on a full disk, after its loss during a session, and after a kill between the write
/// of a line and the commit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/journal_fixture.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Transaction;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// While an object of this class lives, no file of the process can grow beyond `bytes`.
class FullDisk {
 public:
  explicit FullDisk(std::uintmax_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

/// A database with its journal, and a function that commits a note to them step by step.
struct Journalled {
  Journalled() {
    test::write_small_study(path);
    database = open_database(path, Open::Write, read_schema_steps());
    journal = std::make_unique<AnswerJournal>(*database);
    journal->tell_with([this](const std::string& line) { told.push_back(line); });
  }
  /// full: no file can grow once the database has committed the note.
  void note(const std::string& words, bool full = false) {
    Transaction transaction(*database);
    database->execute("INSERT INTO note (session_id, utc, words) VALUES (1, 'now', '" + words + "')");
    journal->write();
    transaction.commit();
    std::optional<FullDisk> disk;
    if (full) disk.emplace(0);
    journal->kept();
  }
  std::int64_t notes_kept() const {
    std::int64_t notes = 0;
    for (const std::string& line : test::kept_lines(path))
      notes += line.find("\"utc\":\"now\"") != std::string::npos;
    return notes;
  }

  test::TemporaryFolder folder;
  fs::path path = folder / "study.db";
  std::unique_ptr<Connection> database;
  std::unique_ptr<AnswerJournal> journal;
  std::vector<std::string> told;
};

TEST(JournalTrouble, WhatCouldNotBeMarkedAsKeptIsSaidAndMarkedWithTheNextCommit) {
  Journalled one;
  one.note("first", true);
  EXPECT_THAT(one.told, ElementsAre(HasSubstr("are in the database only")));
  one.note("second");
  EXPECT_EQ(one.notes_kept(), 2) << "the first stands in the database alone";
  one.journal->require_written();
}

TEST(JournalTrouble, ACommandEndsWithAnErrorWhileTheJournalLacksAnswers) {
  Journalled one;
  one.note("only", true);
  {
    const FullDisk full(0);
    EXPECT_THROW(one.journal->require_written(), base::Error);
  }
  one.journal->require_written();
  EXPECT_THAT(one.told, ElementsAre(HasSubstr("are in the database only"), HasSubstr("is complete")));
  EXPECT_EQ(one.notes_kept(), 1);
}

TEST(JournalTrouble, ALostJournalIsNoticedAtTheNextCommitAndWrittenAnew) {
  const auto truncate = [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); };
  const auto replace = [](const fs::path& file) {
    fs::remove(file);
    base::write_file_atomically(file, "somebody's notes\n");
  };
  for (const auto& [how, lose] : std::vector<std::pair<std::string, std::function<void(const fs::path&)>>>{
           {"was deleted", [](const fs::path& file) { fs::remove(file); }},
           {"was replaced", replace},
           {"was changed", truncate}}) {
    Journalled one;
    one.note("before");
    lose(journal_beside(one.path));
    one.note("after");
    EXPECT_THAT(one.told, ElementsAre(HasSubstr(how))) << how;
    one.note("later");
    EXPECT_EQ(one.notes_kept(), 3) << how;
    test::expect_journal_equals(one.path);
    // A journal that was replaced or changed is kept under another name.
    std::vector<std::string> aside;
    for (const auto& entry : fs::directory_iterator(one.folder.path())) {
      if (entry.path().string().find(".replaced-") != std::string::npos)
        aside.push_back(test::bytes_of(entry.path()));
    }
    const auto expected = how == "was replaced" ? std::vector<std::string>{"somebody's notes\n"} : aside;
    EXPECT_EQ(aside, expected) << how;
    EXPECT_EQ(aside.empty(), how == "was deleted") << how;
  }
}

TEST(JournalTrouble, ASessionGoesOnWithoutLossWhenItsJournalIsDeleted) {
  test::OneSession one(test::paced_pairs());
  std::vector<std::string> told;
  one.store.tell_of_journal([&](const std::string& line) { told.push_back(line); });
  SessionHooks hooks;
  hooks.done = [&, done = 0](const UnitDone&) mutable {
    if (++done == 2) fs::remove(journal_beside(one.folder / "study.db"));
  };
  one.run(hooks);
  EXPECT_THAT(told, ElementsAre(HasSubstr("was deleted")));
  EXPECT_EQ(one.row().state, "done");
  test::expect_journal_equals(one.folder / "study.db");
  one.store.require_journal();
}

/// Writes the end of a showing, and is killed after its line is in the journal and before the commit.
void end_showing_by_hand(const fs::path& path, std::int64_t frames) {
  const auto database = open_database(path, Open::Write, read_schema_steps());
  AnswerJournal journal(*database);
  Transaction transaction(*database);
  for (std::int64_t i = 0; i < frames; ++i)
    database->execute(
        "INSERT INTO frame (presentation_id, frame_index, content_step, simulation_time_s, "
        "scheduled_ns, late) SELECT max(presentation_id), " +
        std::to_string(i) + ", 0, 0, 0, 0 FROM presentation");
  database->execute("UPDATE presentation SET state = 'played', end_ns = 99, verdict = 'pass', frames = " +
                    std::to_string(frames) +
                    " WHERE presentation_id = (SELECT max(presentation_id) FROM presentation)");
  journal.write();
  ::kill(::getpid(), SIGKILL);
}

TEST(JournalTrouble, AShowingWhoseFramesWentWithAKilledProgramIsCutAndShownAgain) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_small_study(path);
  {
    Store store(path, Open::Write);
    const OpenSession session = store.open_runs().at(0).sessions.at(0);
    const OpenUnit& trial = session.units.at(0);
    store.begin_presentation(session.id, trial.trial_id, trial.attempts + 1, 0, trial.trial->first, 77);
  }
  const pid_t child = ::fork();
  if (child == 0) {
    end_showing_by_hand(path, 60);
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  Store store(path, Open::Write);
  const OpenUnit again = store.open_runs().at(0).sessions.at(0).units.at(0);
  EXPECT_THAT(
      test::column(path,
                   "SELECT state || ' ' || coalesce(frames, 'none') || ' ' || coalesce(verdict, 'none') FROM "
                   "presentation ORDER BY presentation_id DESC LIMIT 1"),
      ElementsAre("interrupted none none"));
  EXPECT_EQ(Connection(path, Open::Read)
                .integer("SELECT count(*) FROM presentation p WHERE frames > (SELECT count(*) FROM frame f "
                         "WHERE f.presentation_id = p.presentation_id)"),
            0);
  EXPECT_TRUE(again.begun) << "the trial is shown again";
}

// A disk that fills during the first commit of a new database leaves the plan in the journal alone. The next
// run recovers the plan into a new file, and is refused because the plan exists. The refused run must not
// delete that file.
TEST(JournalTrouble, APlanThatStandsInTheJournalAloneOutlivesARefusedRun) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "s.db";
  const RunPlan plan = test::run_plan(test::pairs(), {"P01"});
  { Store(path, Open::Create).add_run(plan); }
  fs::remove(path);
  const std::string journal = test::bytes_of(journal_beside(path));
  base::write_file_atomically(journal_beside(path), journal.substr(0, journal.rfind("{\"kept\"")));
  EXPECT_THROW(Store(path, Open::Create).add_run(plan), base::Error);
  EXPECT_EQ(Store(path, Open::Write).open_runs().size(), 1u);
}

TEST(JournalTrouble, ACopyOfADatabaseIsADatabaseOfItsOwn) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_small_study(path);
  withdraw(path, "P02");
  const auto vacuum = [&](const fs::path& copy) {
    Connection(path, Open::Write).execute("VACUUM INTO '" + copy.string() + "'");
  };
  const auto plain = [&](const fs::path& copy) { fs::copy_file(path, copy); };
  for (const bool with_journal : {false, true}) {
    for (const auto& [name, make] : std::vector<std::pair<std::string, std::function<void(const fs::path&)>>>{
             {"vacuum", vacuum}, {"plain", plain}}) {
      const fs::path copy = folder / (name + (with_journal ? "_and_journal.db" : ".db"));
      make(copy);
      if (with_journal) fs::copy_file(journal_beside(path), journal_beside(copy));
      for (int round = 0; round < 2; ++round) {
        Store store(copy, Open::Write);
        store.note(store.open_runs().at(0).sessions.at(0).id, {}, "round " + std::to_string(round));
      }
      EXPECT_EQ(test::answers_of(copy), test::answers_of(path)) << copy;
      test::expect_journal_equals(copy);
    }
  }
}

}  // namespace
}  // namespace study
