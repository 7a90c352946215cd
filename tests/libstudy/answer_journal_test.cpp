#include "libstudy/store/answer_journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <set>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/libstudy/journal_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Runs `work` in a child process that is then killed, like a program that ends without clean-up.
void killed(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
      ::kill(::getpid(), SIGKILL);
    } catch (...) {
    }
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

fs::path make_study(const test::TemporaryFolder& folder) {
  const fs::path path = folder / "study.db";
  test::write_small_study(path);
  return path;
}

/// answer_by_hand() stores the next answer of P01 and kills its process after the step `until`: the SQL
/// statements, the lines in the journal, the commit, or the journal's line that says that it was committed.
enum class Until { Statements, Journal, Commit, Kept };
void answer_by_hand(const fs::path& path, Until until) {
  const auto database = open_database(path, Open::Write, read_schema_steps());
  AnswerJournal journal(*database);
  Transaction transaction(*database);
  database->execute(
      "INSERT INTO response (unit_id, attempt, question_id, score, response_time_s, answered_utc) "
      "SELECT unit_id, 0, question_id, 1, 1.25, 'by hand' FROM unit JOIN session USING (session_id) "
      "JOIN question USING (protocol_id) WHERE session.participant = 'P01' AND question.code = 'remarks' "
      "ORDER BY position DESC LIMIT 1;"
      "UPDATE unit SET state = 'done', done_utc = 'by hand' WHERE unit_id = (SELECT max(unit_id) FROM "
      "response)");
  if (until == Until::Statements) ::kill(::getpid(), SIGKILL);
  journal.write();
  if (until == Until::Journal) ::kill(::getpid(), SIGKILL);
  transaction.commit();
  if (until == Until::Commit) ::kill(::getpid(), SIGKILL);
  journal.kept();
  ::kill(::getpid(), SIGKILL);
}

std::int64_t answers_by_hand(const fs::path& path) {
  return Connection(path, Open::Read).integer("SELECT count(*) FROM response WHERE answered_utc = 'by hand'");
}

TEST(AnswerJournal, HasALineForEachAnswerThatReadsByItself) {
  const test::TemporaryFolder folder;
  const mode_t before = ::umask(0);
  const fs::path path = make_study(folder);
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::stat(journal_beside(path).c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600u);
  std::ifstream file(journal_beside(path));
  std::set<std::string> uids;
  int answers = 0;
  for (std::string line; std::getline(file, line);) {
    const auto read = base::Json::parse(line);
    if (read.value("table", "") == "session") uids.insert(read.at("uid"));
    if (read.value("table", "") != "response") continue;
    ++answers;
    EXPECT_EQ(uids.count(read.at("of").at("session")), 1u);
    for (const char* field : {"participant", "unit", "block", "question"})
      EXPECT_TRUE(read.at("of").contains(field));
    for (const char* field : {"attempt", "score", "words", "response_time_s", "answered_utc"})
      EXPECT_TRUE(read.contains(field));
  }
  EXPECT_EQ(answers, Connection(path, Open::Read).integer("SELECT count(*) FROM response"));
  EXPECT_EQ(uids.size(), 2u);
}

TEST(AnswerJournal, FollowsEveryTableButThoseItNames) {
  const auto database = make_temporary_database("new");
  Statement row(*database, "SELECT name FROM sqlite_schema WHERE type = 'table'");
  std::set<std::string> left;
  while (row.step()) {
    if (!journal::find_table(row.text(0))) left.insert(row.text(0));
  }
  EXPECT_THAT(left,
              ::testing::ElementsAre("chore", "export", "export_person", "frame", "gaze", "gaze_validation",
                                     "head", "light", "marker", "reserved_slot", "slot", "tracker_clock"));
}

TEST(AnswerJournal, EqualsTheDatabaseAfterAllThatHappensInASession) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  test::expect_journal_equals(path);
  Store store(path, Open::Write);
  store.open_runs();  // marks the unfinished presentation as interrupted
  test::expect_journal_equals(path);
}

TEST(AnswerJournal, EqualsTheDatabaseAfterAWholeSessionAndHoldsNothingPersonal) {
  test::OneSession session(test::paced_pairs());
  session.person.says["age"] = test::score(43);
  session.run();
  test::expect_journal_equals(session.folder / "study.db");
  const std::string bytes = test::bytes_of(journal_beside(session.folder / "study.db"));
  EXPECT_EQ(bytes.find("\"question\":\"age\""), std::string::npos);
  EXPECT_NE(bytes.find("\"question\":\"ease\""), std::string::npos);
  EXPECT_EQ(PersonalFile(session.folder / "study.db").read("P01").at(0).answer, "43");
}

TEST(AnswerJournal, EqualsTheDatabaseAfterWithdrawalAndMerge) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), other = folder / "other.db", into = folder / "all.db";
  test::write_small_study(other);
  merge({path, other}, into);
  test::expect_journal_equals(into);
  merge({path}, other);
  test::expect_journal_equals(other);
  EXPECT_NE(test::bytes_of(journal_beside(path)).find("phone rang"), std::string::npos);
  withdraw(path, "P01");
  test::expect_journal_equals(path);
  EXPECT_EQ(test::bytes_of(journal_beside(path)).find("phone rang"), std::string::npos);
  EXPECT_NE(test::bytes_of(journal_beside(path)).find("calm"), std::string::npos);
  Store(path, Open::Write);
  test::expect_journal_equals(path);
}

TEST(AnswerJournal, OverwritesTheBytesOfTheFileThatItReplaces) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), kept = folder / "same_bytes";
  fs::create_hard_link(journal_beside(path), kept);
  withdraw(path, "P01");
  EXPECT_EQ(test::bytes_of(kept).find_first_not_of('\0'), std::string::npos);
}

TEST(AnswerJournal, AKillAnywhereAroundTheCommitLosesAndInventsNothing) {
  for (const Until until : {Until::Statements, Until::Journal, Until::Commit, Until::Kept}) {
    SCOPED_TRACE(static_cast<int>(until));
    const test::TemporaryFolder folder;
    const fs::path path = make_study(folder);
    const auto before = test::answers_of(path);
    killed([&] { answer_by_hand(path, until); });
    const bool given = until != Until::Statements;
    EXPECT_EQ(read_journal(journal_beside(path)).pending.empty(),
              until == Until::Statements || until == Until::Kept);
    Store(path, Open::Write);
    EXPECT_EQ(answers_by_hand(path), given ? 1 : 0);
    EXPECT_EQ(test::answers_of(path).size(), before.size() + (given ? 1 : 0));
    test::expect_journal_equals(path);
  }
}

TEST(AnswerJournal, WhatFailedToBeCommittedStaysOut) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  {
    const auto database = open_database(path, Open::Write, read_schema_steps());
    AnswerJournal journal(*database);
    {
      Transaction undone(*database);
      database->execute("INSERT INTO note (session_id, utc, words) VALUES (1, 'now', 'never kept')");
      journal.write();
    }
    Transaction done(*database);
    database->execute("INSERT INTO note (session_id, utc, words) VALUES (2, 'now', 'kept')");
    journal.write();
    done.commit();
    journal.kept();
  }
  for (const std::string& line : test::kept_lines(path))
    EXPECT_EQ(line.find("never kept"), std::string::npos);
  test::expect_journal_equals(path);
  Store(path, Open::Write);
  EXPECT_EQ(Connection(path, Open::Read).integer("SELECT count(*) FROM note WHERE words = 'never kept'"), 0);
}

TEST(AnswerJournal, IsHealedWhereverItsLastLinesAreTorn) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  const std::string whole = test::bytes_of(journal_beside(path));
  const auto truth = test::lines_of(path);
  const std::size_t last_batch = whole.rfind("\n", whole.rfind("\"table\":\"response\""));
  int step = 1;
  for (std::size_t end = whole.size(); end > last_batch; end -= static_cast<std::size_t>(step)) {
    fs::resize_file(journal_beside(path), end);
    Store(path, Open::Write);
    ASSERT_EQ(test::kept_lines(path), truth) << end;
    base::write_file_atomically(journal_beside(path), whole);
    step = end + 60 > whole.size() ? 1 : 37;
  }
  EXPECT_EQ(test::lines_of(path), truth);
}

// A power cut may lose one unsynced sector of the journal and keep a later one, so one of the last lines may
// be lost.
TEST(AnswerJournal, LastRowsOfWhichALineIsLostAreNotTakenOver) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), file = journal_beside(path);
  const auto truth = test::lines_of(path);
  const std::string row =
      R"({"table":"event","event_id":9999,"session_id":1,"presentation_id":9999,"utc":"now",)"
      R"("clock_ns":1,"kind":"trial shown","detail":""})";
  base::write_file_atomically(file, test::bytes_of(file) + std::string(40, '\0') + '\n' + row + '\n' +
                                        ready_line(read_journal(file).last_number + 1));
  Store(path, Open::Write);
  EXPECT_EQ(test::kept_lines(path), truth);
  EXPECT_EQ(test::lines_of(path), truth);
}

TEST(AnswerJournal, IsMadeForADatabaseThatHasNone) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  fs::remove(journal_beside(path));
  Store(path, Open::Write);
  test::expect_journal_equals(path);
  const fs::path blank = folder / "blank.db";
  { Store store(blank, Open::Create); }
  EXPECT_FALSE(fs::exists(journal_beside(blank)));
}

TEST(AnswerJournal, ThatKnowsMoreThanTheDatabaseIsAnErrorThatNamesSalvage) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), early = folder / "early.db";
  const auto refused = [&](Open how) {
    EXPECT_THAT([&] { Store(path, how); }, ThrowsMessage<base::Error>(::testing::AllOf(
                                               HasSubstr("vip-study salvage"), HasSubstr("answers"))));
  };
  fs::copy_file(path, early);
  {
    Store store(path, Open::Write);
    const auto session = store.open_runs().at(0).sessions.at(0);
    const KeptAnswer words{"remarks", {test::words("late"), 1}};
    store.answer(session.id, session.units.back(), 0, {&words, 1}, true, 1);
  }
  const std::string journal = test::bytes_of(journal_beside(path));
  fs::rename(early, path);
  refused(Open::Write);
  fs::remove(path);
  refused(Open::Create);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(test::bytes_of(journal_beside(path)), journal);
}

TEST(AnswerJournal, ThatCannotBeWrittenIsToldBeforeTheAnswerIsKept) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  // The long line makes the journal larger than the database. The limit on the size of all files is then the
  // journal's size, so only the journal reaches it.
  constexpr std::size_t full = 4 << 20;
  std::ofstream(journal_beside(path), std::ios::app)
      << R"({"kept":0,"more":")" << std::string(full, 'x') << "\"}\n";
  const auto before = test::answers_of(path);
  killed([&] {
    Store store(path, Open::Write);
    ::signal(SIGXFSZ, SIG_IGN);
    const auto session = store.open_runs().at(0).sessions.at(0);
    const rlim_t bytes = fs::file_size(journal_beside(path));
    const rlimit limit{bytes, bytes};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(2);
    const KeptAnswer words{"remarks", {test::words("late"), 1}};
    try {
      store.answer(session.id, session.units.back(), 0, {&words, 1}, true, 1);
      ::_exit(3);
    } catch (const base::Error& error) {
      if (!std::string(error.what()).find("answers.jsonl")) ::_exit(4);
    }
  });
  EXPECT_EQ(test::answers_of(path), before);
  Store(path, Open::Write);
  test::expect_journal_equals(path);
}

TEST(AnswerJournal, FollowsNoLink) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db", elsewhere = folder / "elsewhere";
  base::write_file_atomically(elsewhere, "");
  fs::create_symlink(elsewhere, journal_beside(path));
  EXPECT_THROW(test::write_small_study(path), base::Error);
  EXPECT_EQ(fs::file_size(elsewhere), 0u);
}

TEST(AnswerJournal, StandsBesideTheDatabaseItself) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), link = folder / "link.db";
  fs::create_symlink(path, link);
  EXPECT_EQ(journal_beside(link), fs::weakly_canonical(path).string() + ".answers.jsonl");
}

}  // namespace
}  // namespace study
