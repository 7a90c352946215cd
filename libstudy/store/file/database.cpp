#include "libstudy/store/file/database.hpp"

#include <sqlite3.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/foreign_log.hpp"
#include "libstudy/store/file/page_file.hpp"
#include "libstudy/store/file/private_file.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;

namespace {

constexpr std::array parts{"", "-wal", "-journal"};
constexpr int rounds = 5;

/// A temporary folder that only its owner can read; the destructor deletes it with its content.
class PrivateFolder {
 public:
  PrivateFolder() : path_((fs::temp_directory_path() / "vip-study-XXXXXX").string()) {
    if (!::mkdtemp(path_.data()))
      throw base::Error(path_,
                        std::string("cannot be created as a temporary folder: ") + std::strerror(errno),
                        "set TMPDIR to a folder that you may write to");
  }
  ~PrivateFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  fs::path operator/(const std::string& name) const { return fs::path(path_) / name; }

 private:
  std::string path_;
};

/// Sizes and modification times of a database, its log and its journal. If they are equal before and after a
/// copy, the copy is consistent.
std::vector<std::tuple<long long, long long, long long>> state_of(const fs::path& path) {
  std::vector<std::tuple<long long, long long, long long>> state;
  for (const char* part : parts) {
    struct stat file {};
    if (::stat((path.string() + part).c_str(), &file) != 0) file = {};
    state.emplace_back(file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
  }
  return state;
}

void copy_parts(const fs::path& path, const fs::path& copy) {
  for (const char* part : parts) {
    const fs::path from = path.string() + part, to = copy.string() + part;
    std::error_code error;
    if (part[0] != '\0' && !fs::exists(from, error)) continue;
    create_private(to);
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (error)
      throw base::Error(from.string(),
                        "cannot be copied to the temporary file " + to.string() + ": " + error.message(),
                        "copy the database and the files beside it to a folder that you own, or set TMPDIR "
                        "to a folder with free space");
    make_private(to);
  }
}

/// A temporary copy of a database, to which SQLite has applied the log and the journal. Needed on read-only
/// media and folders, where SQLite can neither make a log's shared memory nor roll back a journal.
/// base::Error if the file cannot be read, or changes during each of several tries.
std::unique_ptr<Connection> snapshot(const fs::path& path) {
  for (int round = 0; round < rounds; ++round) {
    const PrivateFolder folder;
    const fs::path copied = folder / "copy.db";
    const auto before = state_of(path);
    copy_parts(path, copied);
    if (state_of(path) != before) continue;
    Connection whole(copied, sqlite::Open::Write);
    whole.show_as(path);
    auto held = std::make_unique<Connection>(path, sqlite::Temporary{});
    held->copy_from(whole);
    return held;
  }
  throw base::Error(path.string(), "cannot be read: another program changes it all the time",
                    "wait until that program has ended, or copy the file to a folder that you own");
}

constexpr std::array step_files{
    "001_initial.sql",      "002_blocks.sql",   "003_permissions.sql", "004_counting.sql", "005_headsets.sql",
    "006_effects.sql",      "007_promises.sql", "008_factors.sql",     "009_imports.sql",  "010_markers.sql",
    "011_eye_trackers.sql", "012_light.sql",    "013_slots.sql",       "014_surface.sql"};
constexpr std::size_t max_sql_bytes = 1 << 20;

std::string read_sql(const std::string& name) {
  return base::read_file(base::resource("libstudy/store/sql/" + name), max_sql_bytes);
}

struct Identity {
  std::int64_t application = 0;
  std::int64_t version = 0;
  bool empty = true;
};

Identity identify(Connection& database) {
  return {database.integer("PRAGMA application_id"), database.integer("PRAGMA user_version"),
          database.integer("SELECT EXISTS (SELECT 1 FROM sqlite_schema)") == 0};
}

/// True if the rollback journal records that the database file had no pages. A power cut in the first
/// transaction leaves such a journal beside a file with arbitrary bytes; rolling back then empties the file.
bool was_empty_before(const fs::path& journal) {
  // Header of a rollback journal (sqlite.org/fileformat.html, section 3): 8 magic bytes; at byte 16, the
  // number of pages that the database file had.
  std::ifstream file(journal, std::ios::binary);
  std::string head(20, '\0');
  return file.read(head.data(), 20) && head.starts_with(salvaging::rollback_magic) &&
         salvaging::u32(head, 16) == 0;
}

bool has_bytes(const fs::path& path) {
  std::error_code ignored;
  const auto bytes = fs::file_size(path, ignored);
  return !ignored && bytes > 0;
}

/// True if the file never had a commit (holds_nothing()). head: the file's first bytes, at most header_bytes.
bool empty_or_emptied(const fs::path& path, const std::string& head) {
  if (!has_bytes(path)) return true;
  if (!was_empty_before(path.string() + "-journal")) return false;
  // The journal records an empty file. If the file is a vip-study database of a schema above 1, it had
  // commits already, so the journal belongs to another file.
  return head.size() < salvaging::header_bytes || !head.starts_with(salvaging::database_magic) ||
         salvaging::u32(head, salvaging::application_at) != database_application_id ||
         salvaging::u32(head, salvaging::version_at) <= 1;
}

/// base::Error unless the file is a database of vip-study whose schema is not newer than `newest`. With
/// Open::Create, an empty database is accepted too. `head`: the file's first bytes as Connection::header()
/// read them, because opening and closing the file here would release SQLite's locks.
void recognise(const fs::path& path, const std::string& head, const Identity& found, Open how,
               std::size_t newest) {
  const bool blank = found.empty && found.application == 0 && found.version == 0;
  if (blank && how == Open::Create) return;
  if (empty_or_emptied(path, head)) {
    throw base::Error(path.string(),
                      "holds nothing: it is empty, or the command that was making it was cut off",
                      "run that command (vip-study run or merge) again: it creates the file");
  }
  if (found.application != database_application_id) {
    throw base::Error(path.string(), "is not a database of vip-study",
                      std::string("name the file that vip-study run wrote") +
                          (how == Open::Create ? ", or a new file" : ""));
  }
  if (found.version > static_cast<std::int64_t>(newest)) {
    throw base::Error(path.string(),
                      "was written by a newer program (schema " + std::to_string(found.version) +
                          ", this program knows " + std::to_string(newest) + ")",
                      "use the newer vip-study; the file was left as it is");
  }
}

/// base::Error if the header in the file itself is not that of a vip-study database. Called before SQLite
/// uses the log or journal. The first commit writes the header into the file, never only into a log.
void recognise_header(const fs::path& path, const std::string& head, Open how, std::size_t newest) {
  if (head.empty() && how == Open::Create) return;
  const fs::path journal = path.string() + "-journal";
  Identity found{0, 0, false};
  if (head.size() == salvaging::header_bytes && head.starts_with(salvaging::database_magic)) {
    found.application = salvaging::u32(head, salvaging::application_at);
    found.version = salvaging::u32(head, salvaging::version_at);
    // identify() later checks whether a file without a journal has tables. With a journal, identify() would
    // roll the journal back and so change the file, so such a file is not accepted as empty.
    found.empty = !has_bytes(journal);
  }
  if (how == Open::Create && was_empty_before(journal)) return;
  recognise(path, head, found, how, newest);
}

/// Makes the backup before an upgrade, completely or not at all. A kill leaves a draft, which the next
/// upgrade removes.
void back_up(Connection& database, std::int64_t version) {
  const std::string path = database.path().string(), draft = path + ".bak.tmp",
                    copy = path + ".v" + std::to_string(version) + "-" + base::utc_now() + ".bak";
  std::error_code failed;
  fs::remove(draft, failed);
  if (!create_private(draft))
    throw base::Error(draft, "exists, but the backup before the upgrade must be written there first",
                      "move that file elsewhere and give the command again");
  try {
    sqlite::Statement(database, "VACUUM INTO ?").bind_all(draft).run();
    base::sync_file(draft);
    if (!base::rename_durably(draft, copy))
      throw base::Error(copy, std::string("cannot be put in place: ") + std::strerror(errno),
                        "check the disk and try again");
  } catch (...) {
    fs::remove(draft, failed);
    throw;
  }
}

/// Sets the schema cookie to a random number >= first_identity, unless it is that large already. The cookie
/// identifies the database, also in its log (foreign_log.hpp).
void give_identity(Connection& database) {
  if (database.integer("PRAGMA schema_version") >= first_identity) return;
  std::mt19937 chance{std::random_device()()};
  const std::int64_t number = std::uniform_int_distribution<std::int64_t>(first_identity, 1 << 30)(chance);
  // While SQLITE_DBCONFIG_DEFENSIVE is on, SQLite ignores this pragma.
  sqlite3_db_config(database.handle(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  database.execute("PRAGMA schema_version = " + std::to_string(number));
  sqlite3_db_config(database.handle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

void set_version(Connection& database, std::size_t version) {
  database.execute("PRAGMA application_id = " + std::to_string(database_application_id));
  database.execute("PRAGMA user_version = " + std::to_string(version));
}

/// Makes the newest schema from one file, schema.sql. Running all schema steps would give the same schema
/// more slowly: SQLite reads the whole schema again for each table that a step renames.
void make_schema(Connection& database, std::size_t version) {
  // Commits application_id alone first, with schema version 0. If a power cut interrupts this first commit,
  // the journal beside the file empties it; holds_nothing() takes such a journal for that of another file if
  // the file's schema version is above 1.
  sqlite::Transaction named(database);
  set_version(database, 0);
  named.commit();
  sqlite::Transaction transaction(database);
  database.execute(read_sql("schema.sql"));
  set_version(database, version);
  give_identity(database);
  transaction.commit();
}

/// Runs one schema step in a transaction. A step may recreate tables, and then references are invalid until
/// it ends; so all references are checked before the commit.
void take_step(Connection& database, const SchemaSteps& steps, std::size_t version) {
  sqlite::Transaction transaction(database);
  database.execute(steps.at(version - 1));
  if (sqlite::Statement lost(database, "PRAGMA foreign_key_check"); lost.step()) {
    throw base::Error(
        database.path().string(),
        "cannot be upgraded: a row of " + lost.text(0) + " refers to a missing row of " + lost.text(2),
        "restore a backup of it; the file was left as it is");
  }
  set_version(database, version);
  if (version == steps.size()) give_identity(database);
  transaction.commit();
}

/// A temporary, read-only copy of an older database, upgraded to the newest schema. The file stays unchanged.
std::unique_ptr<Connection> upgraded_copy(Connection& database, const SchemaSteps& steps) {
  auto copy = std::make_unique<Connection>(database.path(), sqlite::Temporary{});
  copy->copy_from(database);
  upgrade(*copy, steps);
  copy->execute("PRAGMA query_only = ON");
  copy->seal();
  return copy;
}

std::unique_ptr<Connection> to_read(std::unique_ptr<Connection> database, const SchemaSteps& steps,
                                    std::int64_t version) {
  if (version < static_cast<std::int64_t>(steps.size())) return upgraded_copy(*database, steps);
  database->execute("PRAGMA foreign_keys = ON; PRAGMA query_only = ON");
  database->seal();
  return database;
}

std::unique_ptr<Connection> to_write(std::unique_ptr<Connection> database, const SchemaSteps& steps,
                                     std::int64_t version, std::int64_t max_pages) {
  const fs::path& path = database->path();
  for (const char* part : {"", "-wal", "-shm", "-journal"}) make_private(path.string() + part);
  database->execute("PRAGMA synchronous = FULL");
  if (max_pages > 0) database->limit_pages(max_pages);
  if (version > 0 && version < static_cast<std::int64_t>(steps.size())) back_up(*database, version);
  upgrade(*database, steps);
  if (database->text("PRAGMA journal_mode = WAL") != "wal") {
    throw base::Error(path.string(), "cannot keep a write-ahead log here",
                      "put the database on a local disk");
  }
  database->watch();
  database->mark_commits();
  database->seal();
  return database;
}

}  // namespace

bool holds_nothing(const fs::path& path) {
  std::string head(salvaging::header_bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), salvaging::header_bytes);
  head.resize(static_cast<std::size_t>(file.gcount()));
  return empty_or_emptied(path, head);
}

SchemaSteps read_schema_steps() {
  SchemaSteps steps;
  for (const char* file : step_files) steps.push_back(read_sql(file));
  return steps;
}

void upgrade(Connection& database, const SchemaSteps& steps) {
  // Switches off foreign keys before the steps, because this pragma has no effect within their transactions.
  database.execute("PRAGMA foreign_keys = OFF");
  auto version = static_cast<std::size_t>(database.integer("PRAGMA user_version"));
  if (version == 0 && steps == read_schema_steps()) {
    make_schema(database, steps.size());
    version = steps.size();
  }
  for (; version < steps.size(); ++version) take_step(database, steps, version + 1);
  database.execute("PRAGMA foreign_keys = ON");
}

std::unique_ptr<Connection> make_temporary_database(const fs::path& shown, const SchemaSteps& steps) {
  auto database = std::make_unique<Connection>(shown, sqlite::Temporary{});
  upgrade(*database, steps);
  return database;
}

std::unique_ptr<Connection> open_database(const fs::path& given, Open how, const SchemaSteps& steps,
                                          std::int64_t max_pages, const sqlite::Waiting& waiting) {
  refuse_service(given);
  const fs::path path = real_file(given);
  auto database = std::make_unique<Connection>(path, how);
  database->wait_with(waiting);
  const std::string head = database->header();
  recognise_header(path, head, how, steps.size());
  // Lets SQLite copy no page of an existing log into the file: a reader changes no file, and a writer first
  // compares the database with the journal of answers (AnswerJournal).
  database->keep_log(has_bytes(path.string() + "-wal"));
  database->distrust();
  if (how == Open::Read && !database->can_read()) {
    database = snapshot(path);
    database->distrust();
  }
  const Identity found = identify(*database);
  recognise(path, head, found, how, steps.size());
  check_schema(*database, steps, found.version);
  database->recognise();
  database->check_integrity();
  if (how == Open::Read) return to_read(std::move(database), steps, found.version);
  return to_write(std::move(database), steps, found.version, max_pages);
}

}  // namespace study
