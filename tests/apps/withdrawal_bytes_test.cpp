/// After a withdrawal no byte of the person remains in anything that a study left on the disk, and no byte of
/// anyone else is lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/personal.hpp"
#include "stats/base/new_file.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/killed.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/version_1.hpp"

namespace apps::test {
namespace {

using study::sqlite::Connection;
using study::sqlite::Open;
using study::sqlite::Statement;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Two people have this code: one in the study of the first version, one at the station "north".
constexpr const char* code = "QXJ7";
constexpr const char* leaver = "QXJ7-north";
constexpr const char* secret = "zebra-of-the-north";
constexpr std::int64_t telling_ns = 0x0102a3b4c5d6e7f8;
constexpr double telling_x = 0.123456789012345, telling_place = 0.234567890123456,
                 telling_ipd = 61.2345678901234;

/// The eight bytes that SQLite stores for a number.
template <class Number>
std::string stored(Number number) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  std::string bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 0xff);
  return bytes;
}

std::string bytes_of(const fs::path& path) { return base::read_file(path, 1u << 30); }

std::vector<std::string> rows_of(const fs::path& path, const std::string& sql) {
  Connection database(path, Open::Read);
  std::vector<std::string> rows;
  for (Statement row(database, sql); row.step();) {
    std::string line;
    for (int i = 0; i < row.columns(); ++i) line += row.text(i) + "|";
    rows.push_back(line);
  }
  return rows;
}

/// Every row of every table.
std::vector<std::string> content_of(const fs::path& path) {
  std::vector<std::string> all;
  for (std::string table : rows_of(path, "SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY 1")) {
    table.pop_back();
    for (const std::string& row : rows_of(path, "SELECT * FROM " + table)) all.push_back(table + ": " + row);
  }
  return all;
}

/// All answers, showings and gaze of everyone except the leaver.
std::vector<std::string> kept_of_others(const fs::path& path) {
  const std::string who = " FROM session s JOIN unit u USING (session_id) ";
  const std::string others = " WHERE s.participant <> '" + std::string(leaver) + "' ";
  std::vector<std::string> all;
  for (const std::string& sql :
       {"SELECT s.uid, s.participant, u.position, q.code, r.score, r.words" + who +
            "JOIN response r USING (unit_id) JOIN question q USING (question_id)" + others +
            "ORDER BY 1, 3, 4",
        "SELECT s.uid, u.position, p.start_ns, count(*)" + who +
            "JOIN presentation p USING (trial_id) JOIN frame f USING (presentation_id)" + others +
            "GROUP BY p.presentation_id ORDER BY 1, 2, p.attempt, p.interval",
        "SELECT s.uid, u.position, g.sampled_ns, g.x" + who +
            "JOIN presentation p USING (trial_id) JOIN gaze g USING (presentation_id)" + others +
            "ORDER BY 1, 2, 3",
        "SELECT s.uid, n.words FROM session s JOIN note n USING (session_id)" + others + "ORDER BY 1, 2",
        "SELECT s.uid, e.kind, e.detail FROM session s JOIN event e USING (session_id)" + others +
            "ORDER BY 1, e.event_id"}) {
    const auto rows = rows_of(path, sql);
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

/// The file's bytes without tombstones, the records of withdrawals. For a database: the bytes of a copy in
/// which the tombstones are deleted and overwritten; for a journal: the lines except tombstones; for any
/// other file: all bytes.
std::string without_tombstones(const fs::path& path) {
  if (path.string().ends_with(".answers.jsonl")) {
    std::istringstream lines(bytes_of(path));
    std::string rest;
    for (std::string line; std::getline(lines, line);)
      if (line.find("\"table\":\"tombstone\"") == std::string::npos) rest += line + "\n";
    return rest;
  }
  if (!bytes_of(path).starts_with("SQLite format 3")) return bytes_of(path);
  const TemporaryFolder apart;
  const fs::path copy = apart / "copy.db";
  fs::copy_file(path, copy);
  {
    Connection database(copy, Open::Write);
    if (database.integer("SELECT count(*) FROM sqlite_schema WHERE name = 'tombstone'") != 0)
      database.execute("PRAGMA secure_delete = ON; DELETE FROM tombstone");
    database.integer("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  return bytes_of(copy);
}

/// Files and folders below a folder with the text in their name or, outside tombstones, in their content.
std::vector<std::string> files_with(const fs::path& folder, const std::string& text) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    const bool told = name.find(text) != std::string::npos;
    if (told || (entry.is_regular_file() && without_tombstones(entry.path()).find(text) != std::string::npos))
      names.push_back(name);
  }
  return names;
}

/// Pairs of methods, with a consent page that asks for gaze and sharing, free words and a personal question.
study::Protocol asking_pairs() { return study::parse_protocol(protocol_text("pairs"), "asking_pairs.toml"); }

/// One person's session of asking_pairs(): words, gaze, a note and an exclusion, all of which identify the
/// person.
void take_part(study::Store& store, const study::OpenSession& session) {
  const bool leaves = session.plan.participant == code;
  const std::string words = leaves ? secret : "calm water, says " + session.plan.participant;
  const std::int64_t start_ns = leaves ? telling_ns : 77;
  study::test::answer_consent(store, session, {session.plan.participant, 1, 1});
  const study::OpenUnit* trial = nullptr;
  for (const study::OpenUnit& unit : session.units)
    if (!trial && unit.trial) trial = &unit;
  const auto id = store.begin_presentation(session.id, trial->trial_id, 1, 0, trial->trial->first, start_ns);
  const study::GazePoint point{leaves ? telling_x : 0.5, 0.75};
  const study::GazeSample sample{start_ns + 1, {}, true, point};
  store.add_gaze(id, start_ns, study::GazeOrigin::Tracker, {&sample, 1});
  if (leaves) {
    const study::HeadPose head{{telling_place, 0, 0}, {0, 0, 0, 1}, true, true, true, true};
    const study::ShownSlot slot{{start_ns + 2, 11, true, head, telling_ipd}, 0};
    const study::ValidatedPoint validated{start_ns, 0, 0, 9, 9, telling_place, {}, {}};
    store.add_slots(id, start_ns, {&slot, 1});
    store.add_ipd(session.id, start_ns, telling_ipd);
    store.add_validation(session.id, {&validated, 1}, true);
  }
  store.end_presentation(id, start_ns, start_ns + 5, study::test::frames(start_ns, 50),
                         study::test::verdict());
  store.exclude_trial(session.id, trial->trial_id, words);
  const study::KeptAnswer said{"remarks", {study::test::words(words), 1}};
  store.answer(session.id, session.units.back(), 0, {&said, 1}, true, 1);
  store.note(session.id, {}, words);
}

Ended call(const std::vector<std::string>& arguments) { return Process(arguments).wait(); }

void succeeds(const std::vector<std::string>& arguments) {
  const Ended ended = call(arguments);
  EXPECT_EQ(ended.exit_code, 0) << arguments[1] << ": " << ended.out << ended.err;
}

/// The station's people take part in Task 2 and in asking_pairs(), both in one database.
void write_station(const fs::path& path) {
  std::vector<std::string> run{
      vip_study, "run", "protocols/task2.toml", "--db", path, "--observer", "random", "--station", "north"};
  for (const char* who : {code, "P02", "P03"}) run.insert(run.end(), {"--participant", who});
  succeeds(run);
  study::Store store(path, Open::Write);
  const std::int64_t added = store.add_run(study::test::run_plan(asking_pairs(), {code, "P02", "P03"}));
  for (const study::OpenRun& open : store.open_runs())
    for (const study::OpenSession& session : open.sessions)
      if (open.id == added) take_part(store, session);
}

/// An export and a report, both killed before they are in place.
void leave_drafts(const fs::path& database, const fs::path& folder) {
  ::test::killed([&] {
    Connection reader(database, Open::Read);
    const auto people = study::everybody(reader);
    const study::ExportKind kind{"csv", [](const fs::path&) { return false; },
                                 [](const std::string&) { return false; }};
    const study::ExportDraft draft({database, kind, people, study::Readers::Owner}, folder / "killed");
    study::ExportFile file(draft, "sessions.csv");
    file.write(leaver);
    file.finish();
    base::NewFile page(folder / "killed.html", base::Readers::Owner);
    const study::RegisteredExport record(database, "vip-stats report", folder / "killed.html", people,
                                         page.draft());
    page.write(leaver);
    ::test::kill_here();
  });
}

void write_everything_out(const fs::path& database, const fs::path& folder) {
  const std::string stats = VIP_BIN_DIR "/vip-stats";
  succeeds({vip_study, "export", "--db", database, "--csv", folder / "csv", "--bids", folder / "bids",
            "--psych-ds", folder / "psych", "--words", "--gaze"});
  succeeds({stats, "report", database, "--html", folder / "r.html", "--json", folder / "r.json", "--csv",
            folder / "tables"});
  succeeds({stats, "task2", database, "--json", folder / "t.json", "--csv", folder / "t"});
}

class WithdrawalBytes : public ::testing::Test {
 protected:
  /// A database of the first version is upgraded by the merge with a station; then every kind of file that a
  /// database may leave beside it is made.
  WithdrawalBytes() {
    fs::create_directory(out);
    const TemporaryFolder north;
    write_station(north / "north.db");
    study::test::write_version_1(path, code);
    succeeds({vip_study, "merge", north / "north.db", "--into", path});
    first_version = study::backups_of(path).at(0);
    Connection now(path, Open::Write);
    Statement(now, "VACUUM INTO ?").bind_all(later_backup.string()).run();  // like an upgrade's backup
    study::PersonalFile(path).keep({{leaver, "age", "How old?", secret}, {"P02", "age", "How old?", "33"}});
    write_everything_out(path, out);
    leave_drafts(path, out);
  }

  std::vector<std::string> traces(const std::string& participant) {
    return rows_of(path, "SELECT uid FROM session WHERE participant = '" + participant +
                             "' UNION SELECT person FROM session WHERE participant = '" + participant + "'");
  }

  const TemporaryFolder folder;
  const fs::path path = folder / "s.db", out = folder / "out", later_backup = folder / "s.db.v3-then.bak";
  fs::path first_version;
};

TEST_F(WithdrawalBytes, OfThePersonAreNowhereAndOfAllOthersAsTheyWere) {
  auto telling = traces(leaver);
  ASSERT_EQ(telling.size(), 3u);  // identifiers of two sessions and of the person
  for (std::string& one : telling) one.pop_back();
  telling.insert(telling.end(), {leaver, secret, stored(telling_ns), stored(telling_x), "0.123456789012345",
                                 stored(telling_place), "0.234567890123456", stored(telling_ipd)});
  const auto holders = files_with(folder.path(), leaver);
  for (const char* file : {"s.db", "s.db.personal", "s.db.answers.jsonl", "s.db.v3-then.bak", "out/r.json",
                           "out/t.json", "out/tables/task2_choices.csv", "out/csv/sessions.csv"})
    EXPECT_THAT(holders, Contains(file));
  EXPECT_THAT(holders, Contains(HasSubstr("out/killed.html.tmp")));
  EXPECT_THAT(holders, Contains(HasSubstr("out/killed.tmp")));
  EXPECT_THAT(files_with(folder.path(), secret), Contains("out/csv/words.csv"));
  for (const std::string& one : telling) EXPECT_THAT(files_with(folder.path(), one), Not(IsEmpty())) << one;
  const auto others = kept_of_others(path);
  const auto older = content_of(first_version);
  ASSERT_THAT(older, Contains(HasSubstr(code)));  // the code of another person

  Connection reader(path, Open::Write);  // keeps a write-ahead log beside the database
  reader.integer("SELECT count(*) FROM session");
  const Ended done = call({vip_study, "withdraw", leaver, "--db", path, "--yes"});
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;

  for (const std::string& one : telling) EXPECT_THAT(files_with(folder.path(), one), IsEmpty()) << one;
  EXPECT_TRUE(fs::is_empty(out));
  EXPECT_EQ(kept_of_others(path), others);
  EXPECT_EQ(kept_of_others(later_backup), others);
  EXPECT_EQ(content_of(first_version), older);
  EXPECT_EQ(study::PersonalFile(path).read("P02").at(0).answer, "33");
  write_everything_out(path, out);
  EXPECT_THAT(files_with(out, leaver), ElementsAre("csv/tombstones.csv"));
  EXPECT_THAT(files_with(out, "P02"), Contains("r.json"));
}

TEST_F(WithdrawalBytes, OfTheOtherOfTheSameCodeGoFromTheOlderBackup) {
  const auto other = rows_of(path, "SELECT participant FROM session WHERE code = 'QXJ7' AND station = ''");
  ASSERT_EQ(other.size(), 1u);
  const std::string participant = other[0].substr(0, other[0].size() - 1);
  const auto telling = traces(participant);
  const auto answers = rows_of(path,
                               "SELECT count(*) FROM response JOIN unit USING (unit_id) JOIN session "
                               "USING (session_id) WHERE participant = 'QXJ7-north'");
  succeeds({vip_study, "withdraw", participant, "--db", path, "--yes"});
  EXPECT_EQ(bytes_of(first_version).find(code), std::string::npos);
  EXPECT_THAT(rows_of(first_version, "SELECT participant FROM session"), ElementsAre("P01|"));
  for (const std::string& one : telling)
    EXPECT_THAT(files_with(folder.path(), one.substr(0, one.size() - 1)), IsEmpty());
  EXPECT_THAT(files_with(folder.path(), participant), IsEmpty());
  EXPECT_EQ(rows_of(path,
                    "SELECT count(*) FROM response JOIN unit USING (unit_id) JOIN session "
                    "USING (session_id) WHERE participant = 'QXJ7-north'"),
            answers);
  succeeds({vip_study, "withdraw", leaver, "--db", path, "--yes"});
  EXPECT_THAT(files_with(folder.path(), code), IsEmpty());
}

}  // namespace
}  // namespace apps::test
