#include "tests/libstudy/hostile_files.hpp"

#include <sqlite3.h>
#include <sys/time.h>

#include <memory>
#include <stdexcept>

#include "libstudy/store/file/database.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;

namespace {

using Spoil = std::function<void(const fs::path&, const fs::path&)>;

Spoil with(const std::string& sql) {
  return [sql](const fs::path& path, const fs::path&) { spoil_with(path, sql); };
}

/// Changes the SQL of a table in the schema, and leaves its rows.
Spoil with_schema(const std::string& table, const std::string& what, const std::string& by) {
  return with("PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, '" + what + "', '" +
              by + "') WHERE name = '" + table + "'; PRAGMA writable_schema = RESET");
}

/// SQL that sets the version to what it is, which rewrites the first page.
std::string same_version() { return "PRAGMA user_version = " + std::to_string(read_schema_steps().size()); }

/// Commits an event to `source`, and copies the log of `source` beside `path`.
void lend_log(const fs::path& source, const fs::path& path) {
  const auto database = open_database(source, Open::Write, read_schema_steps());
  sqlite::Transaction transaction(*database);
  database->execute("INSERT INTO event (utc, kind, detail) VALUES ('2026-01-01T00:00:00Z', 'note', 'lent')");
  transaction.commit();
  fs::copy_file(source.string() + "-wal", path.string() + "-wal", fs::copy_options::overwrite_existing);
}

/// Puts a log from before later commits beside the database.
void put_earlier_log(const fs::path& path, const fs::path&) {
  const fs::path log = path.string() + "-wal", kept = path.string() + ".kept";
  lend_log(path, kept);
  for (int i = 0; i < 3; ++i) spoil_with(path, "UPDATE run SET options = options; " + same_version());
  fs::rename(kept.string() + "-wal", log);
}

/// Puts the rollback journal of an open transaction in `other` beside `path`.
void put_foreign_journal(const fs::path& path, const fs::path& other) {
  Connection database(other, Open::Write);
  database.text("PRAGMA journal_mode = DELETE");
  database.execute("PRAGMA synchronous = OFF; BEGIN IMMEDIATE; " + same_version() +
                   "; UPDATE run SET options = ''");
  fs::copy_file(other.string() + "-journal", path.string() + "-journal");
  database.execute("ROLLBACK");
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

constexpr const char* journal_magic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";

/// Puts a rollback journal beside `path` that names `other` as its super-journal. SQLite would read that file
/// and delete it.
void put_naming_journal(const fs::path& path, const fs::path& other) {
  const std::string victim = fs::absolute(other).string();
  std::uint32_t sum = 0;
  for (const char c : victim) sum += static_cast<unsigned char>(c);
  std::string bytes =
      journal_magic + big_endian(0) + big_endian(1) + big_endian(1) + big_endian(512) + big_endian(4096);
  bytes.resize(512, '\0');
  bytes += big_endian(262145) + victim + big_endian(static_cast<std::uint32_t>(victim.size())) +
           big_endian(sum) + journal_magic;
  base::write_file_atomically(path.string() + "-journal", bytes);
}

/// Puts a rollback journal beside `path` that says that the database was empty before.
void put_emptying_journal(const fs::path& path, const fs::path&) {
  std::string bytes =
      journal_magic + big_endian(0) + big_endian(1) + big_endian(0) + big_endian(512) + big_endian(4096);
  bytes.resize(512, '\0');
  base::write_file_atomically(path.string() + "-journal", bytes);
}

}  // namespace

void spoil_with(const fs::path& path, const std::string& sql) {
  sqlite3* database = nullptr;
  sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> owner(database, sqlite3_close);
  char* problem = nullptr;
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &problem) == SQLITE_OK) return;
  const std::string text = problem ? problem : "cannot be opened";
  sqlite3_free(problem);
  throw std::runtime_error(sql + ": " + text);
}

std::map<std::string, std::string> everything_in(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    all[entry.path().string()] = entry.is_regular_file() ? bytes_of(entry.path()) : "";
  return all;
}

ProcessorTime::ProcessorTime(int seconds) {
  const itimerval limit{{0, 0}, {seconds, 0}};
  ::setitimer(ITIMER_PROF, &limit, nullptr);
}

ProcessorTime::~ProcessorTime() {
  const itimerval none{};
  ::setitimer(ITIMER_PROF, &none, nullptr);
}

const std::vector<HostileFile>& hostile_files() {
  static const std::string endless =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT ";
  static const std::vector<HostileFile> files{
      {"answers that double", "trigger",
       with("CREATE TRIGGER doubling AFTER INSERT ON response BEGIN UPDATE response SET score = 7; END"),
       "has a trigger 'doubling' that vip-study did not make"},
      {"a log that ends the study", "trigger",
       with("CREATE TRIGGER wiping AFTER INSERT ON event BEGIN DELETE FROM response; END"),
       "has a trigger 'wiping'"},
      {"a tombstone that is kept out", "trigger",
       with("CREATE TRIGGER sparing BEFORE INSERT ON tombstone BEGIN SELECT RAISE(IGNORE); END"),
       "has a trigger 'sparing'"},
      {"a copy that is looked up", "view", with("CREATE VIEW everybody AS SELECT * FROM session"),
       "has a view 'everybody'"},
      {"tombstones without end", "view",
       with("DROP TABLE tombstone; CREATE VIEW tombstone AS " + endless +
            "i AS person, 'P', 'P', '', '' FROM n"),
       "has a view 'tombstone'", false},
      {"a yes of everybody", "view",
       with("DROP VIEW sharing; CREATE VIEW sharing AS SELECT DISTINCT person, 1 AS granted FROM session"),
       "has the view 'sharing' otherwise than vip-study made it"},
      {"answers without end", "view",
       with("DROP VIEW answer; CREATE VIEW answer AS " + endless + "i, 'P' FROM n"),
       "has the view 'answer' otherwise"},
      {"a copy of the answers", "table", with("CREATE TABLE kept AS SELECT * FROM response"),
       "has a table 'kept' that vip-study did not make"},
      {"statistics", "table", with("ANALYZE"), "has a table 'sqlite_stat1'"},
      {"a name that moves the cursor", "table", with("CREATE TABLE \"\x1b[2J\x1b]0;owned\x07\" (a)"),
       "has a table '?[2J?]0;owned?'"},
      {"SQL as the name of a column", "column",
       with("ALTER TABLE response ADD COLUMN \"score) SELECT unit_id, 99, question_id, 7 FROM response --\" "
            "TEXT"),
       "has the table 'response' otherwise"},
      {"one column more", "column", with("ALTER TABLE session ADD COLUMN name TEXT"),
       "has the table 'session' otherwise"},
      {"a column that is reckoned", "column",
       with("ALTER TABLE note ADD COLUMN big TEXT AS (hex(zeroblob(50000000)))"),
       "has the table 'note' otherwise"},
      {"one column fewer", "column", with("ALTER TABLE session DROP COLUMN screen_width_mm"),
       "has the table 'session' otherwise", false},
      {"any score is right", "constraint", with_schema("response", "CHECK (attempt >= 0)", ""),
       "has the table 'response' otherwise"},
      {"any type is right", "constraint", with_schema("response", "STRICT", ""),
       "has the table 'response' otherwise"},
      {"an index over an expression", "index",
       with("CREATE INDEX slow ON response (length(hex(zeroblob(1000))))"), "has an index 'slow'"},
      {"an index of a part", "index", with("CREATE UNIQUE INDEX one ON session (visit) WHERE visit > 50"),
       "has an index 'one'"},
      {"a module's table", "virtual table", with("CREATE VIRTUAL TABLE boxes USING rtree(id, low, high)"),
       "has a table 'boxes'"},
      {"a schema that cannot be read", "schema",
       with_schema("note", "CREATE TABLE note (", "CREATE TABLE note ((("), "malformed database schema"},
      {"a schema of thousands", "schema",
       with("PRAGMA writable_schema = ON; WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n "
            "LIMIT 4000) "
            "INSERT INTO sqlite_schema SELECT 'view', 'v' || i, 'v' || i, 0, 'CREATE VIEW v' || i || ' AS "
            "SELECT 1' "
            "FROM n; PRAGMA writable_schema = RESET"),
       "lists thousands of tables", false},
      {"another program's database", "header",
       [](const fs::path& path, const fs::path&) {
         fs::remove(path);
         Connection(path, Open::Create)
             .execute("CREATE TABLE trial (a); PRAGMA application_id = 0x5669504C; " + same_version());
       },
       "of its schema", false},
      {"a study under an older number", "header", with("PRAGMA user_version = 5"), "vip-study", false},
      {"the log of another study", "log",
       [](const fs::path& path, const fs::path& other) { lend_log(other, path); }, "is of another database"},
      {"the log of yesterday", "log", put_earlier_log, "is of an earlier state of the database"},
      {"the journal of another study", "journal", put_foreign_journal, "is of another database"},
      {"a journal that names a file", "journal", put_naming_journal, "names a further file to be deleted"},
      {"a journal from before the study", "journal", put_emptying_journal, "would make the database empty"},
  };
  return files;
}

}  // namespace study::test
