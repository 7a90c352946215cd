#include "libstudy/store/salvage/salvage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/journal_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr std::size_t page_bytes = 4096;

/// A small study, its content and its bytes. Tests damage it again and again.
class Salvaging : public ::testing::Test {
 protected:
  Salvaging() {
    test::write_small_study(path);
    truth = test::answers_of(path);
    lines = test::lines_of(path);
    bytes = test::bytes_of(path);
    journal = test::bytes_of(journal_beside(path));
  }

  /// Salvages the file with other bytes, with its journal or without.
  Salvage salvaged(const std::string& damaged, bool with_journal = true) {
    write(path, damaged);
    if (with_journal)
      write(journal_beside(path), journal);
    else
      fs::remove(journal_beside(path));
    for (const fs::path& old : {into, journal_beside(into)}) fs::remove(old);
    const Salvage done = salvage(path, into);
    EXPECT_TRUE(test::bytes_of(path) == damaged) << "the damaged file was changed";
    return done;
  }

  static void write(const fs::path& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
  }

  /// Rows of the result, except those that the salvage adds itself.
  std::vector<std::string> lines_salvaged() {
    auto found = test::lines_of(into);
    std::erase_if(found, [](const std::string& line) {
      return line.find("\"kind\":\"salvaged\"") != std::string::npos;
    });
    return found;
  }

  void expect_no_answer_invented_or_changed() {
    const auto found = test::answers_of(into);
    EXPECT_TRUE(std::includes(truth.begin(), truth.end(), found.begin(), found.end()));
  }

  void expect_sound() {
    const auto made = open_database(into, Open::Read, read_schema_steps());
    EXPECT_EQ(made->text("PRAGMA integrity_check"), "ok");
    EXPECT_EQ(made->integer("SELECT count(*) FROM pragma_foreign_key_check"), 0);
    struct stat status {};
    ASSERT_EQ(::stat(into.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0600u);
  }

  std::size_t pages() const { return bytes.size() / page_bytes; }
  std::string without_page(std::size_t page, char with = '\0') const {
    std::string damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(page * page_bytes), page_bytes, with);
    return damaged;
  }

  void expect_journal_makes_up_for(const std::string& damaged) {
    const Salvage done = salvaged(damaged);
    EXPECT_EQ(test::answers_of(into), truth);
    EXPECT_EQ(lines_salvaged(), lines);
    EXPECT_EQ(done.answers_database + done.answers_journal, static_cast<std::int64_t>(truth.size()));
    EXPECT_THAT(done.different, IsEmpty());
    EXPECT_THAT(done.answers_lost, IsEmpty());
  }
  /// Returns true if every answer was found.
  bool finds_all_and_invents_nothing_without_a_journal(const std::string& damaged) {
    try {
      const Salvage done = salvaged(damaged, false);
      expect_no_answer_invented_or_changed();
      const auto found = test::answers_of(into).size();
      EXPECT_EQ(done.answers_database, static_cast<std::int64_t>(found));
      // A missing answer must be reported as lost, or as a row without an owner.
      EXPECT_TRUE(found == truth.size() || !done.answers_lost.empty() || !done.rows_lost.empty());
      return found == truth.size();
    } catch (const base::Error& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("nothing of a study was found"));  // because the page of sessions is destroyed
      return false;
    }
  }
  /// Destroys every `step`-th page in turn.
  void destroy_pages(std::size_t step) {
    ASSERT_GE(pages(), 20u);
    std::size_t tried = 0, found_all = 0;
    for (std::size_t page = 0; page < pages(); page += step, ++tried) {
      SCOPED_TRACE(page);
      expect_journal_makes_up_for(without_page(page));
      expect_sound();
      found_all += finds_all_and_invents_nothing_without_a_journal(without_page(page, '\x5a'));
    }
    EXPECT_GE(found_all, tried / 2);
  }
  /// Cuts the file at every `step`-th end of a page, with its journal. Without its journal, cuts it also
  /// within pages.
  void cut(std::size_t step) {
    for (std::size_t end = 0; end < bytes.size(); end += step * page_bytes) {
      SCOPED_TRACE(end);
      expect_journal_makes_up_for(bytes.substr(0, end));
      expect_sound();
    }
    for (std::size_t end = page_bytes; end < bytes.size(); end += step * (page_bytes + 700)) {
      SCOPED_TRACE(end);
      finds_all_and_invents_nothing_without_a_journal(bytes.substr(0, end));
    }
  }

  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", into = folder / "new.db";
  std::vector<std::string> truth, lines;
  std::string bytes, journal;
};

/// The fast tests destroy every fifth page and cut at the end of every fifth page; the slow tests take all
/// pages.
constexpr std::size_t some = 5;
class SalvagingSlow : public Salvaging {};

TEST_F(Salvaging, ADestroyedPageCostsNoAnswerOfTheJournalAndInventsNone) { destroy_pages(some); }
TEST_F(SalvagingSlow, EveryPageDestroyedInTurnCostsNoAnswerOfTheJournalAndInventsNone) { destroy_pages(1); }
TEST_F(Salvaging, ACutCostsNoAnswerOfTheJournalAndInventsNone) { cut(some); }
TEST_F(SalvagingSlow, EveryCutCostsNoAnswerOfTheJournalAndInventsNone) { cut(1); }

TEST_F(Salvaging, TheJournalAloneMakesADatabaseThatIsResumedExportedAndRead) {
  fs::remove(path);
  const Salvage done = salvage(path, into);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(lines_salvaged(), lines);
  EXPECT_EQ(done.answers_journal, static_cast<std::int64_t>(truth.size()));
  EXPECT_EQ(done.answers_database, 0);
  EXPECT_GT(done.frames_lost, 0);
  expect_sound();
  write(path, bytes);
  const auto before = Store(path, Open::Write).open_runs(), after = Store(into, Open::Write).open_runs();
  ASSERT_EQ(after.size(), before.size());
  ASSERT_EQ(after[0].sessions.size(), before[0].sessions.size());
  ASSERT_EQ(after[0].sessions[0].units.size(), before[0].sessions[0].units.size());
  for (std::size_t i = 0; i < after[0].sessions[0].units.size(); ++i) {
    const OpenUnit &one = before[0].sessions[0].units[i], &other = after[0].sessions[0].units[i];
    EXPECT_EQ(one.plan.position, other.plan.position);
    EXPECT_EQ(one.answered, other.answered);
    EXPECT_EQ(one.attempts, other.attempts);
    ASSERT_EQ(one.trial.has_value(), other.trial.has_value());
    if (one.trial) {
      EXPECT_EQ(one.trial->schedule_seed, other.trial->schedule_seed);
    }
  }
  test::expect_journal_equals(into);
  export_csv(into, folder / "out");
  EXPECT_EQ(read_status(into).sessions.size(), 2u);
}

TEST_F(Salvaging, AJournalTornAnywhereGivesWhatWasKeptBefore) {
  fs::remove(path);
  const std::size_t last = journal.rfind("\"table\":\"response\"");
  std::size_t most = 0;
  // Cuts the journal behind the start of its last answer: at every 151st byte, at every third of the last 170
  // bytes, and at each of the last 20.
  const auto step = [&](std::size_t left) { return left < 20 ? 1 : left < 170 ? 3 : 151; };
  for (std::size_t end = last; end <= journal.size(); end += step(journal.size() - end)) {
    SCOPED_TRACE(end);
    write(journal_beside(path), journal.substr(0, end));
    for (const fs::path& old : {into, journal_beside(into)}) fs::remove(old);
    salvage(path, into);
    expect_no_answer_invented_or_changed();
    const std::size_t found = test::answers_of(into).size();
    EXPECT_GE(found, std::max(most, truth.size() - 1));
    most = found;
  }
  EXPECT_EQ(most, truth.size());
}

TEST_F(Salvaging, WhatIsInTheLogIsFoundAndALostLogIsMadeUpForByTheJournal) {
  const fs::path live = folder / "live.db";
  std::vector<std::string> all;
  {
    Store store(live, Open::Create);
    store.add_run(test::run_plan(test::pairs(), {"P01"}));
    const auto session = store.open_runs().at(0).sessions.at(0);
    test::answer_one(store, session, session.units.at(0), "games", test::score(1));
    test::answer_one(store, session, session.units.at(1), "ease", test::score(4));
    all = test::answers_of(live);
    for (const char* end : {"", "-wal"})
      fs::copy_file(live.string() + end, (folder / "kept.db").string() + end);
    fs::copy_file(live, folder / "lost_log.db");
    fs::copy_file(journal_beside(live), journal_beside(folder / "lost_log.db"));
  }
  ASSERT_EQ(all.size(), 2u);
  ASSERT_GT(fs::file_size(folder / "kept.db-wal"), 0u);
  const Salvage sound = salvage(folder / "kept.db", folder / "1.db");
  EXPECT_TRUE(sound.sound);
  EXPECT_EQ(test::answers_of(folder / "1.db"), all);
  // SQLite's write-ahead log is missing, but the journal has the answers.
  const Salvage lost = salvage(folder / "lost_log.db", folder / "2.db");
  EXPECT_EQ(test::answers_of(folder / "2.db"), all);
  EXPECT_EQ(lost.answers_journal, 2);
  // Only the write-ahead log is left, without the database file.
  fs::remove(folder / "kept.db");
  salvage(folder / "kept.db", folder / "3.db");
  EXPECT_EQ(test::answers_of(folder / "3.db"), all);
}

TEST_F(Salvaging, SaysSoWhenNothingIsLeftAndMakesNothing) {
  fs::remove(path);
  fs::remove(journal_beside(path));
  const auto nothing = [&] {
    EXPECT_THAT(
        [&] { salvage(path, into); },
        ThrowsMessage<base::Error>(HasSubstr("nothing of a study was found in it, and there is no journal")));
    EXPECT_FALSE(fs::exists(into));
  };
  nothing();
  write(path, "");
  nothing();
  write(path, std::string(3 * page_bytes, 'x'));
  nothing();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST_F(Salvaging, NeverWritesOverAFile) {
  write(into, "something else");
  EXPECT_THAT([&] { salvage(path, into); }, ThrowsMessage<base::Error>(HasSubstr("exists")));
  EXPECT_EQ(test::bytes_of(into), "something else");
}

TEST_F(Salvaging, TheDatabaseWinsWhereTheTwoDifferAndTheAnswerIsNamed) {
  const std::string from = "\"score\":7,", to = "\"score\":2,";
  const std::size_t at = journal.rfind(from);
  ASSERT_NE(at, std::string::npos);
  journal.replace(at, from.size(), to);
  const Salvage done = salvaged(bytes);
  EXPECT_EQ(test::answers_of(into), truth);
  ASSERT_EQ(done.different.size(), 1u);
  EXPECT_THAT(done.different[0], HasSubstr("\"question\":\"ease\""));
}

TEST_F(Salvaging, TheJournalOfAnotherStudyIsRefused) {
  test::write_small_study(folder / "other.db");
  journal = test::bytes_of(journal_beside(folder / "other.db"));
  EXPECT_THAT([&] { salvaged(bytes); }, ThrowsMessage<base::Error>(HasSubstr("belongs to another study")));
  EXPECT_FALSE(fs::exists(into));
}

TEST_F(Salvaging, WhoWithdrewStaysOut) {
  withdraw(path, "P01");
  const std::string after = test::bytes_of(journal_beside(path));
  // Salvage from the journal alone, and from a file that still holds everything.
  fs::remove(path);
  Salvage done = salvage(path, into);
  EXPECT_THAT(done.withdrawn, ::testing::ElementsAre("P01"));
  EXPECT_EQ(done.sessions, 1);
  journal = after;
  done = salvaged(bytes);
  EXPECT_EQ(done.sessions, 1);
  EXPECT_THAT(done.rows_lost, IsEmpty());
  EXPECT_EQ(test::bytes_of(into).find("phone rang"), std::string::npos);
}

TEST_F(Salvaging, WhoWasAboutToBeForgottenStaysOut) {
  {
    const auto database = open_database(path, Open::Write, read_schema_steps());
    prepare_rewrite(*database, {database->text("SELECT person FROM session WHERE participant = 'P01'")});
  }
  fs::remove(path);
  const Salvage done = salvage(path, into);
  EXPECT_EQ(done.sessions, 1);
  EXPECT_THAT(done.withdrawn, ::testing::ElementsAre("P01"));
  EXPECT_EQ(read_status(into).withdrawn.size(), 1u);
}

TEST_F(Salvaging, AnUndamagedDatabaseComesOutAsItWas) {
  const Salvage done = salvaged(bytes, false);
  EXPECT_TRUE(done.sound);
  EXPECT_EQ(lines_salvaged(), lines);
  EXPECT_EQ(done.frames_lost, 0);
  EXPECT_EQ(done.frames, Connection(path, Open::Read).integer("SELECT count(*) FROM frame"));
  EXPECT_THAT(done.answers_lost, IsEmpty());
}

}  // namespace
}  // namespace study
