#include "libstudy/store/database.hpp"

#include <array>

#include "libstudy/store/beside.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;

namespace {

constexpr std::array step_files{"001_initial.sql", "002_blocks.sql", "003_permissions.sql"};
constexpr std::size_t max_sql_bytes = 1 << 20;
constexpr std::uintmax_t smallest_page_bytes = 512;

struct Identity {
  std::int64_t application = 0;
  std::int64_t version = 0;
  bool empty = true;
};

Identity identify(Connection& database) {
  return {database.integer("PRAGMA application_id"), database.integer("PRAGMA user_version"),
          database.integer("SELECT count(*) FROM sqlite_schema") == 0};
}

/// Throws unless the database is ours, or blank where one may be made, and not newer than the program.
void recognise(const fs::path& path, const Identity& found, Open how, std::size_t newest) {
  const bool blank = found.empty && found.application == 0 && found.version == 0;
  if (blank && how == Open::Create) return;
  if (found.application != database_application_id) {
    throw base::Error(path.string(), "is not a database of vip-study",
                      "name the file that vip-study run wrote, or a new file");
  }
  if (found.version > static_cast<std::int64_t>(newest)) {
    throw base::Error(path.string(),
                      "was written by a newer program (schema " + std::to_string(found.version) +
                          ", this program knows " + std::to_string(newest) + ")",
                      "use the newer vip-study; the file was left as it is");
  }
}

/// A look at a file before anything of SQLite's can change it or its log.
void recognise_untouched(const fs::path& path, Open how, std::size_t newest) {
  std::error_code ignored;
  if (how == Open::Create && (!fs::exists(path, ignored) || fs::file_size(path, ignored) == 0)) return;
  if (const auto bytes = fs::file_size(path, ignored); !ignored && bytes < smallest_page_bytes) {
    // SQLite takes a file of one byte for an empty one.
    recognise(path, {0, 0, false}, how, newest);
  }
  // A power cut in the very first transaction leaves a blank file with a journal that undoes it.
  if (how == Open::Create && fs::exists(path.string() + "-journal", ignored)) return;
  Connection look(path, Open::Untouched);
  recognise(path, identify(look), how, newest);
}

void check_integrity(Connection& database) {
  const std::string found = database.text("PRAGMA integrity_check(1)");
  if (found != "ok") {
    throw base::Error(database.path().string(), "is damaged or cut short: " + found,
                      "restore a backup of it");
  }
}

void back_up(Connection& database, std::int64_t version) {
  std::string copy =
      database.path().string() + ".v" + std::to_string(version) + "-" + base::utc_now() + ".bak";
  sqlite::Statement(database, "VACUUM INTO ?").bind(0, copy).run();
}

/// A step may make tables anew, so that rows point nowhere until it ends: they are checked before the commit.
void take_step(Connection& database, const std::string& sql, std::size_t version) {
  sqlite::Transaction transaction(database);
  database.execute(sql);
  if (sqlite::Statement lost(database, "PRAGMA foreign_key_check"); lost.step()) {
    throw base::Error(database.path().string(),
                      "cannot be upgraded: a row of " + lost.text(0) + " belongs to none of " + lost.text(2),
                      "restore a backup of it; the file was left as it is");
  }
  database.execute("PRAGMA application_id = " + std::to_string(database_application_id));
  database.execute("PRAGMA user_version = " + std::to_string(version));
  transaction.commit();
}

void upgrade(Connection& database, const SchemaSteps& steps, std::int64_t version) {
  // The switch has no effect within a transaction.
  database.execute("PRAGMA foreign_keys = OFF");
  for (auto step = static_cast<std::size_t>(version); step < steps.size(); ++step)
    take_step(database, steps[step], step + 1);
  database.execute("PRAGMA foreign_keys = ON");
}

/// An older database as this program reads it: the file stays as it is.
std::unique_ptr<Connection> upgraded_copy(Connection& database, const SchemaSteps& steps,
                                          std::int64_t version) {
  auto copy = std::make_unique<Connection>(database.path(), sqlite::Temporary{});
  copy->copy_from(database);
  upgrade(*copy, steps, version);
  copy->execute("PRAGMA query_only = ON");
  return copy;
}

std::unique_ptr<Connection> open_checked(const fs::path& path, Open how, const SchemaSteps& steps,
                                         std::int64_t max_pages) {
  recognise_untouched(path, how, steps.size());
  auto database = std::make_unique<Connection>(path, how);
  const Identity found = identify(*database);
  recognise(path, found, how, steps.size());
  check_integrity(*database);
  const auto newest = static_cast<std::int64_t>(steps.size());
  if (how == Open::Read) {
    if (found.version < newest) return upgraded_copy(*database, steps, found.version);
    database->execute("PRAGMA foreign_keys = ON; PRAGMA query_only = ON");
    return database;
  }
  database->execute("PRAGMA synchronous = FULL");
  if (max_pages > 0) database->integer("PRAGMA max_page_count = " + std::to_string(max_pages));
  if (found.version > 0 && found.version < newest) back_up(*database, found.version);
  upgrade(*database, steps, found.version);
  if (database->text("PRAGMA journal_mode = WAL") != "wal") {
    throw base::Error(path.string(), "cannot keep a write-ahead log here",
                      "put the database on a local disk");
  }
  return database;
}

}  // namespace

SchemaSteps read_schema_steps() {
  SchemaSteps steps;
  for (const char* file : step_files) {
    steps.push_back(
        base::read_file(base::resource(std::string("libstudy/store/sql/") + file), max_sql_bytes));
  }
  return steps;
}

std::unique_ptr<Connection> make_temporary_database(const fs::path& shown) {
  auto database = std::make_unique<Connection>(shown, sqlite::Temporary{});
  upgrade(*database, read_schema_steps(), 0);
  return database;
}

std::unique_ptr<Connection> open_database(const fs::path& given, Open how, const SchemaSteps& steps,
                                          std::int64_t max_pages) {
  const fs::path path = real_file(given);
  std::error_code ignored;
  const bool made_here = how == Open::Create && !fs::exists(path, ignored);
  try {
    return open_checked(path, how, steps, max_pages);
  } catch (...) {
    if (made_here) {
      for (const char* beside : {"", "-journal", "-wal", "-shm"}) fs::remove(path.string() + beside, ignored);
    }
    throw;
  }
}

}  // namespace study
