#include "libstudy/store/file/database.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"
#include "tests/libstudy/version_1.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A database with one planned run.
fs::path make_study(const test::TemporaryFolder& folder) {
  Store(folder / "study.db", Open::Create).add_run(test::run_plan(test::pilot(), {"P01"}));
  return folder / "study.db";
}

/// Every way of opening fails with `problem` and leaves the file and its folder unchanged.
void expect_refused(const fs::path& path, const std::string& problem) {
  const std::string before = test::bytes_of(path);
  const auto count = [&] { return std::distance(fs::directory_iterator(path.parent_path()), {}); };
  const auto files = count();
  for (const Open how : {Open::Create, Open::Write, Open::Read}) {
    EXPECT_THAT([&] { open_database(path, how, read_schema_steps()); },
                ThrowsMessage<base::Error>(
                    ::testing::AllOf(HasSubstr(path.string()), HasSubstr(problem), HasSubstr("mend: "))));
    EXPECT_TRUE(test::bytes_of(path) == before);
    EXPECT_EQ(count(), files);
  }
}

TEST(Database, NewerIsRefusedUntouched) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  Connection(path, Open::Write).execute("PRAGMA user_version = 99");
  expect_refused(path, "newer program (schema 99");
}

TEST(Database, ForeignDatabaseIsRefused) {
  const test::TemporaryFolder folder;
  Connection(folder / "foreign.db", Open::Create).execute("CREATE TABLE trial (a)");
  expect_refused(folder / "foreign.db", "is not a database of vip-study");
}

TEST(Database, OtherFilesAreRefused) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder / "text.db", std::string(5000, 'x'));
  expect_refused(folder / "text.db", "is not a database of vip-study");
  base::write_file_atomically(folder / "short.db", "x");
  expect_refused(folder / "short.db", "is not a database of vip-study");
}

TEST(Database, TruncatedIsRefused) {
  const test::TemporaryFolder folder;
  const std::string whole = test::bytes_of(make_study(folder));
  for (const double part : {0.1, 0.5, 0.9}) {
    const fs::path cut = folder / "cut.db";
    base::write_file_atomically(
        cut, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    expect_refused(cut, "damaged or cut short");
  }
}

TEST(Database, WrongValuesAreRefused) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  {
    Connection database(path, Open::Write);
    database.execute("PRAGMA ignore_check_constraints = ON");
    database.execute("UPDATE trial SET state = 'lost' WHERE position = 4");
  }
  expect_refused(path, "CHECK constraint failed in trial");
}

TEST(Database, MissingIsAnErrorUnlessMade) {
  const test::TemporaryFolder folder;
  for (const Open how : {Open::Write, Open::Read}) {
    EXPECT_THAT([&] { open_database(folder / "none.db", how, read_schema_steps()); },
                ThrowsMessage<base::Error>(HasSubstr("there is no such database")));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_THAT([&] { open_database(folder.path(), Open::Create, read_schema_steps()); },
              ThrowsMessage<base::Error>(HasSubstr("is a folder")));
}

TEST(Database, NameWithUriSyntaxIsAName) {
  const test::TemporaryFolder folder;
  open_database(folder / "a?mode=memory#%41.db", Open::Create, read_schema_steps());
  EXPECT_TRUE(fs::exists(folder / "a?mode=memory#%41.db"));
}

/// Leaves the files of a power cut in the very first transaction: some pages are written, but not the first,
/// and a rollback journal says that the file was empty before.
void put_unmade(const fs::path& path) {
  base::write_file_atomically(path, std::string(4096, '\0') + std::string(8192, '\r'));
  std::string journal("\xd9\xd5\x05\xf9\x20\xa1\x63\xd7\0\0\0\0\0\0\0\1\0\0\0\0\0\0\2\0\0\0\x10\0", 28);
  journal.resize(512, '\0');
  base::write_file_atomically(path.string() + "-journal", journal);
}

TEST(Database, CutOffInItsFirstTransactionIsMadeAnew) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), run = folder / "run.db", into = folder / "into.db";
  for (const fs::path& one : {run, into}) put_unmade(one);
  EXPECT_TRUE(holds_nothing(into));
  EXPECT_FALSE(holds_nothing(path));
  EXPECT_THAT([&] { export_csv(into, folder / "csv"); },
              ThrowsMessage<base::Error>(HasSubstr("holds nothing")));
  Store(run, Open::Create).add_run(test::run_plan(test::pilot(), {"P02"}));
  EXPECT_EQ(merge({path, run}, into).sessions, 2);
  // A rollback journal that says that the file was empty does not make a complete database count as empty.
  fs::copy_file(path, folder / "whole.db");
  put_unmade(folder / "other.db");
  fs::rename(folder / "other.db-journal", folder / "whole.db-journal");
  EXPECT_FALSE(holds_nothing(folder / "whole.db"));
}

TEST(Database, FullAtItsCreationLeavesNoFile) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { Store(folder / "study.db", Open::Create, 2); },
              ThrowsMessage<base::Error>(HasSubstr("no room left")));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Database, FullLaterKeepsWhatWasCommitted) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create, 100);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  const OpenUnit& unit = session.units.at(2);
  const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
  EXPECT_THAT([&] { store.add_frames(id, 0, test::frames(0, 20000)); },
              ThrowsMessage<base::Error>(HasSubstr("no room left")));
  EXPECT_EQ(store.open_runs().at(0).sessions.at(0).units.size(), 24u);
  EXPECT_EQ(test::trials_of(folder / "study.db").size(), 21u);
}

TEST(Database, UpgradeKeepsACopyAndTheData) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  SchemaSteps steps = read_schema_steps();
  const std::string version = std::to_string(steps.size());
  steps.push_back("ALTER TABLE session ADD COLUMN weather TEXT;");

  const std::string before = test::bytes_of(path);
  EXPECT_EQ(open_database(path, Open::Read, steps)->integer("SELECT count(weather) FROM session"), 0);
  EXPECT_TRUE(test::bytes_of(path) == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);  // the database and its journal
  const auto upgraded = open_database(path, Open::Write, steps);
  EXPECT_EQ(upgraded->integer("PRAGMA user_version"), static_cast<std::int64_t>(steps.size()));
  EXPECT_EQ(upgraded->integer("SELECT count(*) FROM trial"), 21);
  EXPECT_EQ(upgraded->integer("SELECT count(weather) FROM session"), 0);

  fs::path copy;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (entry.path().extension() == ".bak") copy = entry.path();
  }
  ASSERT_THAT(copy.string(), HasSubstr("study.db.v" + version));
  EXPECT_EQ(test::trials_of(copy).size(), 21u);
}

/// Every table, index, view and trigger with its SQL, comments included: exports describe columns by them.
std::vector<std::string> schema_texts(sqlite::Connection& database) {
  std::vector<std::string> texts;
  sqlite::Statement row(database, "SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY type, name");
  while (row.step())
    texts.push_back(row.text(0) + " " + row.text(1) + " of " + row.text(2) + ": " + row.text(3));
  return texts;
}

TEST(Database, TheStepsGiveTheSchemaOfNewDatabases) {
  const SchemaSteps steps = read_schema_steps();
  const auto stepped = make_temporary_database("by steps", {steps.front()});
  upgrade(*stepped, steps);
  const auto made = make_temporary_database("at once");
  EXPECT_EQ(schema_texts(*stepped), schema_texts(*made));
  for (const char* number : {"PRAGMA user_version", "PRAGMA application_id"})
    EXPECT_EQ(stepped->integer(number), made->integer(number)) << number;
}

TEST(Database, FailedUpgradeChangesNothing) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  SchemaSteps steps = read_schema_steps();
  const std::string before = test::bytes_of(path);
  steps.push_back("DROP TABLE response; CREATE TABLE trial (again);");
  EXPECT_THROW(open_database(path, Open::Write, steps), base::Error);
  EXPECT_TRUE(test::bytes_of(path) == before);
  EXPECT_EQ(test::trials_of(path).size(), 21u);
}

TEST(Database, AStepThatLosesRowsChangesNothing) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  SchemaSteps steps = read_schema_steps();
  const std::string before = test::bytes_of(path);
  steps.push_back("DELETE FROM protocol;");
  EXPECT_THAT([&] { open_database(path, Open::Write, steps); },
              ThrowsMessage<base::Error>(HasSubstr("refers to a missing row of protocol")));
  EXPECT_TRUE(test::bytes_of(path) == before);
}

TEST(Database, ReadingLeavesNothingBehind) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  const std::string before = test::bytes_of(path);
  EXPECT_EQ(test::trials_of(path).size(), 21u);
  EXPECT_TRUE(test::bytes_of(path) == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);  // the database and its journal
}

TEST(Database, Version1KeepsEveryAnswerAndEveryFrame) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_version_1(path);
  const auto database = open_database(path, Open::Write, read_schema_steps());
  EXPECT_EQ(database->integer("SELECT count(*) FROM pragma_foreign_key_check"), 0);
  EXPECT_EQ(database->text("PRAGMA integrity_check"), "ok");
  EXPECT_EQ(database->integer("PRAGMA foreign_keys"), 1);
  const auto counts = database->text(
      "SELECT (SELECT count(*) FROM protocol) || ' ' || (SELECT count(*) FROM question) || ' ' || "
      "(SELECT count(*) FROM run) || ' ' || (SELECT count(*) FROM session) || ' ' || "
      "(SELECT count(*) FROM trial) || ' ' || (SELECT count(*) FROM presentation) || ' ' || "
      "(SELECT count(*) FROM frame) || ' ' || (SELECT count(*) FROM response) || ' ' || "
      "(SELECT count(*) FROM event) || ' ' || (SELECT count(*) FROM cell) || ' ' || (SELECT count(*) FROM "
      "unit)");
  EXPECT_EQ(counts, "1 1 1 2 4 5 10 3 3 2 4");
  sqlite::Statement row(
      *database,
      "SELECT s.participant, t.position, u.kind, u.state, r.score, r.response_time_s, "
      "r.attempt, p.start_ns, c.mean_fps, s.state FROM trial t JOIN unit u USING (trial_id) "
      "JOIN session s ON s.session_id = t.session_id "
      "JOIN cell c ON c.protocol_id = s.protocol_id AND c.cell = t.first_cell "
      "LEFT JOIN response r USING (unit_id) "
      "LEFT JOIN presentation p ON p.trial_id = t.trial_id AND p.attempt = r.attempt "
      "ORDER BY t.trial_id");
  std::vector<std::string> lines;
  while (row.step()) {
    lines.emplace_back();
    for (int i = 0; i < row.columns(); ++i) lines.back() += (i ? " " : "") + row.text(i);
  }
  EXPECT_THAT(lines, ::testing::ElementsAre("P01 0 stimulus done 5 1.5 2 50 20.0 done",
                                            "P01 1 stimulus done 2 2.5 1 70 10.0 done",
                                            "P02 0 practice done 7 3.5 1 1234605616436508552 10.0 open",
                                            "P02 1 stimulus planned     20.0 open"));
}

TEST(Database, Version1IsReadWithoutBeingChanged) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_version_1(path);
  const std::string before = test::bytes_of(path);
  const auto rows = test::trials_of(path);
  EXPECT_EQ(read_status(path).sessions.size(), 2u);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].score(), 5);
  EXPECT_EQ(rows[2].trial.kind, "practice");
  EXPECT_FALSE(rows[3].score());
  EXPECT_TRUE(test::bytes_of(path) == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(Database, Version1IsUpgradedByAnExportWhichIsRegisteredInIt) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  test::write_version_1(path);
  EXPECT_EQ(export_csv(path, folder / "out").size(), 26u);
  EXPECT_EQ(read_status(path).sessions.size(), 2u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);  // with the backup of the upgrade
}

TEST(Database, CopiesOfVersion1AreRecognisedAfterTheirUpgrade) {
  const test::TemporaryFolder folder;
  std::vector<std::string> uids;
  for (const char* name : {"one.db", "two.db"}) {
    test::write_version_1(folder / name);
    const auto database = open_database(folder / name, Open::Write, read_schema_steps());
    uids.push_back(database->text("SELECT group_concat(uid || ' ' || person) FROM session"));
  }
  EXPECT_EQ(uids[0], uids[1]);
}

/// Schema 3 stored values of each frame that were never measured. They must be empty after reading, an
/// upgrade and a salvage.
TEST(Database, FramesOfEarlierSchemasTellWhatWasMeasuredAlone) {
  const test::TemporaryFolder folder;
  const auto expect_frames = [](const fs::path& path, std::int64_t frames) {
    const auto database = open_database(path, Open::Read, read_schema_steps());
    EXPECT_EQ(database->integer("SELECT count(*) FROM frame"), frames);
    EXPECT_EQ(database->integer("SELECT count(coalesce(active_fraction, tau_fps, beta, mu_fps, delta_fps, "
                                "speed_limited, coincident_pairs, not_finite, neighbours_dropped, "
                                "wall_projected, nozzle_waited, saliency_not_finite, gaze_lost)) FROM frame"),
              0);
  };
  const fs::path old = folder / "study.db", upgraded = folder / "upgraded.db", salvaged = folder / "new.db";
  for (const fs::path& copy : {old, upgraded})
    fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v3.db", copy);
  const auto read = [](const fs::path& path) {
    Connection database(path, Open::Read);
    sqlite::Statement row(
        database,
        "SELECT presentation_id, frame_index, content_step, simulation_time_s, scheduled_ns, "
        "submitted_ns, late, particles FROM frame");
    std::vector<std::string> lines;
    while (row.step()) {
      lines.emplace_back();
      for (int i = 0; i < row.columns(); ++i) lines.back() += row.text(i) + "|";
    }
    std::sort(lines.begin(), lines.end());
    return lines;
  };
  const auto before = read(old);
  ASSERT_EQ(before.size(), 40u);
  EXPECT_THAT(before, ::testing::Contains(HasSubstr("|2218 939|"))) << "counted then, so measured";
  expect_frames(old, 40);  // reading makes a temporary copy
  open_database(upgraded, Open::Write, read_schema_steps());
  expect_frames(upgraded, 40);
  EXPECT_EQ(read(upgraded), before);
  // Without its header SQLite cannot read the file, so salvage reads page by page.
  std::string bytes = test::bytes_of(old);
  std::fill_n(bytes.begin(), 100, '\0');
  base::write_file_atomically(old, bytes);
  salvage(old, salvaged);
  expect_frames(salvaged, 40);
  EXPECT_EQ(read(salvaged), before);
}

TEST(Database, ARefusalOfEarlierSchemasIsToldFromRulingOut) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v3.db", path);
  {
    Connection old(path, Open::Write);
    old.execute(
        "UPDATE session SET state = 'not eligible'; INSERT INTO note (session_id, utc, words) "
        "SELECT session_id, '', 'block ' || block FROM unit WHERE kind = 'consent' AND session_id = 1; "
        "INSERT INTO note (session_id, utc, words) SELECT session_id, '', 'block ' || block || ' 2' "
        "FROM unit WHERE kind = 'consent' AND session_id > 1");
    ASSERT_EQ(old.integer("SELECT count(*) FROM note WHERE words = 'block consent'"), 1);
  }
  const auto database = open_database(path, Open::Write, read_schema_steps());
  EXPECT_EQ(database->integer("SELECT count(*) FROM session WHERE state = 'refused'"), 1);
  EXPECT_EQ(database->text("SELECT state FROM session WHERE session_id = 1"), "refused");
  EXPECT_EQ(database->integer("SELECT count(*) FROM permission WHERE session_id = 1"), 2)
      << "views still read it";
}

TEST(Database, EveryReleasedSchemaIsStillOpened) {
  const test::TemporaryFolder folder;
  for (std::size_t schema = 1; schema < read_schema_steps().size(); ++schema)
    EXPECT_TRUE(fs::exists(fs::path(VIP_TEST_DIR) / "libstudy" / "fixtures" /
                           ("study_v" + std::to_string(schema) + ".db")))
        << "keep a database of schema " << schema;
  for (const auto& entry : fs::directory_iterator(fs::path(VIP_TEST_DIR) / "libstudy" / "fixtures")) {
    if (entry.path().extension() != ".db") continue;
    SCOPED_TRACE(entry.path());
    const fs::path copy = folder / entry.path().filename().string();
    fs::copy_file(entry.path(), copy);
    const bool finished = entry.path().filename() == "study_v1.db";
    EXPECT_EQ(Store(copy, Open::Write).open_runs().empty(), finished);
    EXPECT_FALSE(read_status(copy).sessions.empty());
    if (!finished) continue;
    const auto rows = test::trials_of(copy);
    ASSERT_EQ(rows.size(), 4u);
    for (const test::TrialOf& row : rows) {
      const TaskShowing& shown = row.trial.first;
      ASSERT_TRUE(row.score() && shown.verdict);
      EXPECT_NEAR(shown.realised.mean, shown.nominal.mean, 1e-6);
      EXPECT_EQ(row.observer, "ptpe:a=31,b=0.035,slope=0.14,noise=1,participant_sd=0.5");
    }
  }
}

}  // namespace
}  // namespace study
