#pragma once
/// Opens the database of a study: checks that the file is a sound database of vip-study, and upgrades its
/// schema.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The application_id in the header of vip-study's SQLite files: "ViPL".
inline constexpr std::int64_t database_application_id = 0x5669504C;

/// The SQL of each schema step, in order; element i upgrades a database to user_version i + 1.
using SchemaSteps = std::vector<std::string>;
/// Reads the schema steps of this program, from libstudy/store/sql/.
SchemaSteps read_schema_steps();

/// Opens the database at `path`, also through links (beside.hpp), with foreign keys. Open::Create and
/// Open::Write also set WAL mode and synchronous = FULL. Applies SQLite's log or journal beside the file, so
/// that a file left by a kill, a full disk or a power cut is read correctly.
///
/// Open::Create makes a database if the file is missing or empty. Open::Create and Open::Write upgrade an
/// older database, each step in one transaction, after making a copy "<path>.v<version>-<UTC time>.bak". Both
/// set the file's mode to 0600 and watch the file (Connection::watch()); the caller must hold a WriterLock.
/// Open::Read returns a temporary copy if SQLite may not write the files beside the database that reading
/// needs. It returns an upgraded temporary copy of an older database.
///
/// base::Error, with the stored data unchanged, if the file is not a database of vip-study or has other
/// tables, columns, views or triggers (schema.hpp), if the log beside it belongs to another database
/// (foreign_log.hpp), if its schema is newer than `steps`, or if it is damaged and SQLite cannot recover it.
///
/// Open::Read never changes an existing log. With Open::Create and Open::Write, SQLite copies no page of an
/// existing log into the file until the caller has compared the database with the journal of answers and
/// calls Connection::keep_log(false). max_pages > 0 limits the file to that many pages (4 KiB each in a new
/// database). waiting: decides how long to wait for another program's lock
/// (Connection::wait_with()); if empty, five seconds.
std::unique_ptr<sqlite::Connection> open_database(const std::filesystem::path& path, sqlite::Open how,
                                                  const SchemaSteps& steps, std::int64_t max_pages = 0,
                                                  const sqlite::Waiting& waiting = {});

/// True if the file never had a commit: it is missing or empty, or its creation was interrupted and SQLite's
/// journal beside it makes it empty again. Open::Create overwrites such a file. Opens and closes the file, so
/// the process must have no connection to it.
bool holds_nothing(const std::filesystem::path& path);

/// Upgrades a database to the newest schema of `steps`, each step in one transaction. If `steps` are all
/// steps of this program, an empty database gets the newest schema directly.
void upgrade(sqlite::Connection& database, const SchemaSteps& steps);

/// Makes an empty temporary database of the newest schema in `steps`. Error messages name `shown` as its
/// file.
std::unique_ptr<sqlite::Connection> make_temporary_database(const std::filesystem::path& shown,
                                                            const SchemaSteps& steps = read_schema_steps());

}  // namespace study
