#include "libstudy/store/withdraw.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/personal.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"
#include "tests/libstudy/version_1.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* leaver = "QXJ7withdraws";
constexpr const char* secret = "zebra-of-the-north";
// SQLite stores this eight-byte integer as telling_bytes.
constexpr std::int64_t telling_start_ns = 0x1122334455667788;
const std::string telling_bytes = "\x11\x22\x33\x44\x55\x66\x77\x88";

/// Number of occurrences of `needle` in the files directly in a folder.
int occurrences(const fs::path& folder, const std::string& needle) {
  int found = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string bytes = test::bytes_of(entry.path());
    for (auto at = bytes.find(needle); at != std::string::npos; at = bytes.find(needle, at + 1)) ++found;
  }
  return found;
}

/// Two participants of the pairs study. All words of the participant `leaver` are the secret.
void write_study(const fs::path& path) {
  Store store(path, Open::Create);
  store.add_run(test::run_plan(test::pairs(), {leaver, "P02"}));
  const auto sessions = store.open_runs().back().sessions;
  for (const OpenSession& session : sessions) {
    const bool leaves = session.plan.participant == leaver;
    const OpenUnit& trial = session.units.at(1);
    const std::int64_t start_ns = leaves ? telling_start_ns : 77;
    const auto id = store.begin_presentation(session.id, trial.trial_id, 1, 0, trial.trial->first, start_ns);
    store.end_presentation(id, start_ns, start_ns + 5, test::frames(start_ns, 300), test::verdict());
    const KeptAnswer ease{"ease", {test::score(5), 1}};
    store.answer(session.id, trial, 1, {&ease, 1}, true, 1);
    const KeptAnswer words{"remarks", {test::words(leaves ? secret : "all well"), 1}};
    store.answer(session.id, session.units.back(), 0, {&words, 1}, true, 1);
    store.note(session.id, {}, leaves ? secret : "calm");
    store.exclude_trial(session.id, trial.trial_id, leaves ? secret : "noise");
    PersonalFile(path).keep({{session.plan.participant, "age", "How old?", leaves ? secret : "33"}});
  }
}

TEST(Withdraw, LeavesNoTraceOfTheAnswers) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  ASSERT_GE(occurrences(folder.path(), secret), 4);
  ASSERT_GE(occurrences(folder.path(), telling_bytes), 1);
  ASSERT_GE(occurrences(folder.path(), leaver), 4);
  const Withdrawal done = withdraw(path, leaver);
  EXPECT_EQ(done.deleted.sessions, 1);
  EXPECT_EQ(done.deleted.answers, 2);
  EXPECT_EQ(done.deleted.frames, 300);
  EXPECT_EQ(occurrences(folder.path(), secret), 0);
  EXPECT_EQ(occurrences(folder.path(), telling_bytes), 0);
  Connection look(path, Open::Read);
  EXPECT_EQ(look.text("SELECT participant FROM tombstone"), leaver);
  look.execute("PRAGMA foreign_keys = ON");
  EXPECT_EQ(look.integer("SELECT count(*) FROM pragma_foreign_key_check"), 0);
  // The code occurs twice in the tombstone's row, once in an index and twice in the journal's tombstone, and
  // nowhere else.
  EXPECT_EQ(occurrences(folder.path(), leaver), 5);
}

TEST(Withdraw, LeavesTheOthersAsTheyWere) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  const auto ratings_of = [&] {
    std::vector<std::string> all;
    Connection look(path, Open::Read);
    sqlite::Statement row(look,
                          "SELECT s.participant || ' ' || q.code || ' ' || coalesce(r.score, r.words) "
                          "FROM response r JOIN unit USING (unit_id) JOIN session s USING (session_id) "
                          "JOIN question q USING (question_id) WHERE s.participant = 'P02' ORDER BY 1");
    while (row.step()) all.push_back(row.text(0));
    return all;
  };
  const auto before = ratings_of();
  ASSERT_EQ(before.size(), 2u);
  withdraw(path, leaver);
  EXPECT_EQ(ratings_of(), before);
  EXPECT_EQ(PersonalFile(path).read("P02").at(0).answer, "33");
  EXPECT_TRUE(PersonalFile(path).read(leaver).empty());
  Connection look(path, Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM frame"), 300);
  EXPECT_EQ(look.text("SELECT words FROM note"), "calm");
  EXPECT_EQ(look.integer("SELECT count(*) FROM event WHERE session_id IS NOT NULL"), 8);
}

TEST(Withdraw, CleansTheLogWhileAnotherProgramHasTheDatabaseOpen) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  Connection other(path, Open::Write);
  other.integer("SELECT count(*) FROM frame");  // the log stays while this connection is open
  withdraw(path, leaver);
  EXPECT_EQ(occurrences(folder.path(), secret), 0);
  EXPECT_EQ(occurrences(folder.path(), telling_bytes), 0);
}

TEST(Withdraw, CleansBackupsOfBothSchemas) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_version_1(path, leaver);
  Store(path, Open::Write);  // upgrades and leaves a backup
  {
    Connection now(path, Open::Write);
    sqlite::Statement(now, "VACUUM INTO ?").bind_all(path.string() + ".v2-later.bak").run();
  }
  ASSERT_GE(occurrences(folder.path(), telling_bytes), 6);
  const Withdrawal done = withdraw(path, leaver);
  EXPECT_EQ(done.beside.cleaned.size(), 2u);
  EXPECT_TRUE(done.beside.left.empty());
  EXPECT_EQ(occurrences(folder.path(), telling_bytes), 0);
  for (const fs::path& backup : done.beside.cleaned) {
    const auto rows = test::trials_of(backup);
    ASSERT_EQ(rows.size(), 2u) << backup;
    EXPECT_EQ(rows[0].participant, "P01");
    EXPECT_EQ(rows[1].score(), 2);
    Connection look(backup, Open::Write);
    EXPECT_EQ(look.integer("SELECT count(*) FROM session"), 1);
    EXPECT_THROW(look.execute("DELETE FROM event WHERE event_id = 1"), base::Error);
  }
}

TEST(Withdraw, NamesBackupsThatItCannotClean) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  base::write_file_atomically(path.string() + ".v1-old.bak", std::string(5000, 'x'));
  const Withdrawal done = withdraw(path, leaver);
  ASSERT_EQ(done.beside.left.size(), 1u);
  EXPECT_THAT(done.beside.left[0], HasSubstr(".v1-old.bak"));
}

TEST(Withdraw, NamesTheStationsWhoseDatabasesItDoesNotReach) {
  const test::TemporaryFolder folder;
  write_study(folder / "study.db");
  EXPECT_THAT(withdraw(folder / "study.db", leaver).deleted.stations, ElementsAre("north"));
}

TEST(Withdraw, FreesTheSlotButNotTheCode) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  const Protocol protocol = test::pairs();
  {
    Store store(path, Open::Create);
    RunPlan run{protocol, "{}", {}};
    for (int slot = 0; slot < 3; ++slot)
      run.sessions.push_back(test::session_plan(protocol, "P0" + std::to_string(slot), 7, slot));
    store.add_run(run);
  }
  withdraw(path, "P01");
  Store store(path, Open::Write);
  const auto taken = store.taken_slots(protocol.sha256);
  EXPECT_THAT(taken, ElementsAre(0, 2));
  EXPECT_EQ(next_slot(protocol, taken), 1);
  EXPECT_THAT([&] { store.add_run(test::run_plan(protocol, {"P01"})); },
              ThrowsMessage<base::Error>(HasSubstr("withdrew")));
  EXPECT_THAT(read_status(path).withdrawn, ElementsAre("P01"));
}

TEST(Withdraw, TakesEveryVisitUnderEveryProtocol) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    store.add_run(test::run_plan(test::pilot(), {"P01", "P02"}));
    store.add_run(test::run_plan(test::pairs(), {"P01"}));
  }
  EXPECT_EQ(withdraw(path, "P01").deleted.sessions, 2);
  Connection look(path, Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM session"), 1);
  EXPECT_EQ(look.integer("SELECT count(*) FROM run"), 1);
}

TEST(Withdraw, MayBeRepeatedAndRefusesStrangers) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  withdraw(path, leaver);
  EXPECT_EQ(withdraw(path, leaver).deleted.sessions, 0);
  EXPECT_THAT([&] { withdraw(path, "P99"); },
              ThrowsMessage<base::Error>(HasSubstr("knows no participant P99")));
  const Store running(path, Open::Write);
  EXPECT_THAT([&] { withdraw(path, "P02"); }, ThrowsMessage<base::Error>(HasSubstr("another vip-study")));
}

TEST(Withdraw, TheLogIsStillKeptForAllOthers) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  write_study(path);
  withdraw(path, leaver);
  Connection other(path, Open::Write);
  EXPECT_THROW(other.execute("DELETE FROM event"), base::Error);
  EXPECT_THROW(other.execute("UPDATE event SET detail = ''"), base::Error);
}

TEST(Personal, IsReadableByItsOwnerOnlyAndStandsApart) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  base::write_file_atomically(PersonalFile::beside(path), "");  // made by another program, readable by all
  PersonalFile file(path);
  EXPECT_EQ(fs::status(PersonalFile::beside(path)).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  file.keep(
      {{"P01", "age", "How old?", "33"}, {"P01", "gender", "Gender?", secret}, {"P02", "age", "?", "44"}});
  file.keep({{"P01", "age", "How old are you?", "34"}});
  const auto entries = file.read("P01");
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].question, "gender");
  EXPECT_EQ(entries[1].wording, "How old are you?");
  EXPECT_EQ(entries[1].answer, "34");
  ASSERT_GE(occurrences(folder.path(), secret), 1);
  file.forget("P01");
  EXPECT_EQ(occurrences(folder.path(), secret), 0);
  EXPECT_TRUE(file.read("P01").empty());
  EXPECT_EQ(file.read("P02").at(0).answer, "44");
}

}  // namespace
}  // namespace study
