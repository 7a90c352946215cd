/// Databases, logs and journals from strangers: each command refuses them with the reason before it changes
/// any byte.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/hostile_files.hpp"
#include "tests/libstudy/journal_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using test::everything_in;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// Limit of processor time for a refusal.
constexpr int most_seconds = 10;

class HostileDatabases : public ::testing::Test {
 protected:
  HostileDatabases() {
    fs::create_directory(folder / "made");
    test::write_small_study(folder / "made" / "sound.db");
    Store(folder / "made" / "other.db", Open::Create).add_run(test::run_plan(test::pilot(), {"Q01"}));
    fs::create_directory(folder / "box");
  }

  void SetUp() override { begin(); }

  /// Refills the folder: a study to be damaged, a sound copy of it, an unrelated study, and a file that is no
  /// study.
  void begin() {
    for (const auto& entry : fs::directory_iterator(folder / "box")) fs::remove_all(entry.path());
    for (const fs::path& to : {study, sound}) {
      fs::copy_file(folder / "made" / "sound.db", to);
      fs::copy_file(folder / "made" / "sound.db.answers.jsonl", journal_beside(to));
    }
    fs::copy_file(folder / "made" / "other.db", other);
    base::write_file_atomically(box("letter.txt"), "not a study");
  }

  fs::path box(const std::string& name) const { return folder / "box" / name; }

  /// Each command of vip-study and vip-stats, as the calls with which it opens a database.
  std::map<std::string, std::function<void()>> commands() const {
    return {{"status", [this] { read_status(study); }},
            {"report", [this] { read_tasks(study); }},
            {"sickness", [this] { read_sickness(study); }},
            {"merge, as a source", [this] { merge({study}, sound); }},
            {"merge, as the target", [this] { merge({sound}, study); }},
            {"export to CSV", [this] { export_csv(study, box("csv")); }},
            {"export to BIDS", [this] { export_bids(study, box("bids"), true); }},
            {"resume", [this] { Store(study, Open::Write).open_runs(); }},
            {"run", [this] { Store(study, Open::Create).open_runs(); }},
            {"consent", [this] { change_permissions(study, "P01", {.gaze = false, .sharing = {}}); }},
            {"withdraw", [this] { withdraw(study, "P01"); }}};
  }

  const test::TemporaryFolder folder;
  const fs::path study = box("study.db"), sound = box("sound.db"), other = box("other.db");
};

std::string message_of(const std::function<void()>& command) {
  try {
    command();
  } catch (const base::Error& error) {
    return error.what();
  }
  return "it was taken";
}

TEST_F(HostileDatabases, AreRefusedByEachCommandAndNothingIsTouched) {
  std::set<std::string> kinds;
  for (const test::HostileFile& file : test::hostile_files()) {
    SCOPED_TRACE(file.name);
    kinds.insert(file.kind);
    begin();
    file.spoil(study, other);
    const auto before = everything_in(folder.path());
    for (const auto& [name, command] : commands()) {
      SCOPED_TRACE(name);
      const test::ProcessorTime limit(most_seconds);
      const std::string message = message_of(command);
      EXPECT_THAT(message, HasSubstr(file.reason));
      EXPECT_THAT(message, HasSubstr("mend: "));
      EXPECT_THAT(message, Not(HasSubstr("\x1b")));
      EXPECT_TRUE(everything_in(folder.path()) == before) << message;
    }
  }
  EXPECT_GE(test::hostile_files().size(), 20u);
  EXPECT_GE(kinds.size(), 8u);
}

/// The error messages name salvage as the remedy. Salvage recovers all answers, from most of these files even
/// without their journal.
TEST_F(HostileDatabases, SalvageMakesASoundStudyOfThem) {
  const auto truth = test::answers_of(sound);
  for (const test::HostileFile& file : test::hostile_files()) {
    SCOPED_TRACE(file.name);
    begin();
    file.spoil(study, other);
    if (file.salvaged) fs::remove(journal_beside(study));
    const test::ProcessorTime limit(most_seconds);
    salvage(study, box("new.db"));
    EXPECT_EQ(test::answers_of(box("new.db")), truth);
    EXPECT_NO_THROW(Store(box("new.db"), Open::Write).open_runs());
  }
}

TEST_F(HostileDatabases, SalvageNamesWhatItLeavesOut) {
  test::spoil_with(study,
                   "CREATE TABLE kept AS SELECT * FROM response; CREATE VIEW seen AS SELECT 1; "
                   "ALTER TABLE session ADD COLUMN name TEXT");
  const Salvage done = salvage(study, box("new.db"));
  EXPECT_THAT(done.left_out, ::testing::UnorderedElementsAre("table 'kept'", "view 'seen'",
                                                             "changes of the table 'session'"));
}

/// For a table that no study has, the message also names the command that drops it.
TEST_F(HostileDatabases, WhatTheMessageSaysToDropIsDropped) {
  test::spoil_with(study, "CREATE TABLE kept AS SELECT * FROM response");
  const std::string message = message_of([&] { read_status(study); });
  EXPECT_THAT(message, HasSubstr("sqlite3 " + study.string() + " 'DROP TABLE kept; VACUUM'"));
  test::spoil_with(study, "DROP TABLE kept; VACUUM");
  EXPECT_NO_THROW(read_status(study));
}

/// Databases of earlier versions, whose schema comments differ, are accepted before and after their upgrade.
TEST_F(HostileDatabases, WhatEarlierVersionsWroteIsNoneOfThem) {
  for (const auto& entry : fs::directory_iterator(fs::path(VIP_TEST_DIR) / "libstudy" / "fixtures")) {
    if (entry.path().extension() != ".db") continue;
    fs::copy_file(entry.path(), study, fs::copy_options::overwrite_existing);
    fs::remove(journal_beside(study));
    EXPECT_NO_THROW(read_status(study)) << entry.path();
    EXPECT_NO_THROW(Store(study, Open::Write)) << entry.path();
    EXPECT_NO_THROW(read_status(study)) << entry.path();
  }
}

/// The log of a killed session has its last commits, so readers must leave it in place.
TEST_F(HostileDatabases, ReadersLeaveTheLogOfAKilledSessionAlone) {
  const fs::path killed = box("killed.db");
  {
    Store store(study, Open::Write);
    store.log({}, "note", "the last commit");
    for (const char* part : {"", "-wal", ".answers.jsonl"})
      fs::copy_file(study.string() + part, killed.string() + part);
  }
  const auto state = [&] {
    std::string all;
    for (const char* part : {"", "-wal", ".answers.jsonl"}) all += test::bytes_of(killed.string() + part);
    return all;
  };
  const std::string before = state();
  read_status(killed);
  read_tasks(killed);
  EXPECT_TRUE(state() == before);
  EXPECT_NO_THROW(Store(killed, Open::Write));
  EXPECT_EQ(open_database(killed, Open::Read, read_schema_steps())
                ->integer("SELECT count(*) FROM event WHERE detail = 'the last commit'"),
            1);
}

/// A log holds commits, so no new database may be made over it.
TEST_F(HostileDatabases, ALogWithoutItsDatabaseIsKept) {
  {
    const Store store(study, Open::Write);
    const_cast<Store&>(store).log({}, "note", "the last commit");
    fs::copy_file(study.string() + "-wal", box("gone.db-wal"));
  }
  const std::string before = test::bytes_of(box("gone.db-wal"));
  for (const bool empty : {false, true}) {
    if (empty) base::write_file_atomically(box("gone.db"), "");
    EXPECT_THAT([&] { Store(box("gone.db"), Open::Create); },
                ThrowsMessage<base::Error>(HasSubstr("is there without its database")));
    EXPECT_TRUE(test::bytes_of(box("gone.db-wal")) == before);
  }
}

/// A backup beside a study has participants' data too, so a withdrawal names a backup with a table that no
/// study has.
TEST_F(HostileDatabases, ABackupWithForeignPartsIsNamedByAWithdrawal) {
  fs::copy_file(sound, study.string() + ".v7-2026-01-01T00:00:00Z.bak");
  test::spoil_with(study.string() + ".v7-2026-01-01T00:00:00Z.bak",
                   "CREATE TABLE kept AS SELECT * FROM session");
  EXPECT_THAT(withdraw(study, "P01").beside.left, ::testing::Contains(HasSubstr("has a table 'kept'")));
}

/// Every cell of every leaf page points to the same chain of overflow pages, so that the rows add up to far
/// more bytes than the file has.
TEST_F(HostileDatabases, RowsThatAllStandOnTheSamePagesEndASalvage) {
  constexpr std::size_t page_bytes = 4096, chain = 2000, leaves = 40, cells = 1400;
  const auto number = [](std::size_t value, int bytes) {
    std::string out;
    for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i));
    return out;
  };
  std::string file = test::bytes_of(study).substr(0, page_bytes);
  file.replace(32, 8, std::string(8, '\0'));  // no free pages
  for (std::size_t page = 2; page < chain + 2; ++page) {
    file += number(page < chain + 1 ? page + 1 : 0, 4);
    file.resize(page * page_bytes, '\0');
  }
  // A cell has 489 bytes on its own page, and 4092 on each overflow page.
  constexpr std::size_t cell_at = 3000, local = 489, size = local + chain * (page_bytes - 4);
  for (std::size_t page = 0; page < leaves; ++page) {
    std::string leaf = std::string("\x0d") + number(0, 2) + number(cells, 2) + number(cell_at, 2) + '\0';
    for (std::size_t cell = 0; cell < cells; ++cell) leaf += number(cell_at, 2);
    leaf.resize(cell_at, '\0');
    for (const int shift : {21, 14, 7, 0})
      leaf += static_cast<char>((size >> shift & 0x7f) | (shift > 0 ? 0x80 : 0));
    leaf += '\1';  // number of the row
    leaf.append(local, '\0').append(number(2, 4));
    leaf.resize(page_bytes, '\0');
    file += leaf;
  }
  base::write_file_atomically(study, file);
  fs::remove(journal_beside(study));
  const test::ProcessorTime limit(most_seconds);
  EXPECT_THROW(salvage(study, box("new.db")), base::Error);
}

TEST_F(HostileDatabases, DeepJsonInAJournalIsNoLineOfIt) {
  const std::string deep(200'000, '[');
  for (const std::string& line :
       {R"({"table":"event","event_id":)" + deep, R"({"ready":)" + deep,
        R"({"table":"event","event_id":)" + deep + std::string(deep.size(), ']') + "}",
        R"({"table":"response","response_id":1,"of":)" + deep + std::string(deep.size(), ']') + "}",
        std::string(R"({"table":"event","event_id":"no number"})"),
        std::string(R"({"table":"event","event_id":1e999})")}) {
    begin();
    std::string journal = test::bytes_of(journal_beside(study));
    journal.insert(journal.find('\n') + 1, line + "\n");
    base::write_file_atomically(journal_beside(study), journal);
    EXPECT_EQ(salvage(study, box("new.db")).answers_lost.size(), 0u);
    message_of([&] { Store(study, Open::Write).open_runs(); });  // accepted or refused
  }
}

}  // namespace
}  // namespace study
