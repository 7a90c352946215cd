#pragma once
/// Opens the database of a study: identifies it, checks it and upgrades its schema.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// SQLite's application_id of our databases: "ViPL".
inline constexpr std::int64_t database_application_id = 0x5669504C;

/// The SQL of each schema step in order; step i leads to user_version i + 1.
using SchemaSteps = std::vector<std::string>;
/// The program's own steps, from libstudy/store/sql/.
SchemaSteps read_schema_steps();

/// Opens `path` (through links, see beside.hpp) with foreign keys, WAL and synchronous = FULL. Always uses
/// its log and journal, so that a file left by a kill, a full disk or a power cut is read correctly.
///
/// Open::Create makes a missing or empty file into a database; Open::Write upgrades an older one, each step
/// in one transaction, after a copy "<path>.v<version>-<UTC time>.bak"; either makes the file 0600 and
/// watches it (Connection::watch). A writer must hold a WriterLock. Open::Read returns an upgraded temporary
/// copy of an older database, and a temporary copy if nothing can be written beside the file. base::Error,
/// with the file and its neighbours unchanged: not a database of this program, foreign tables or views
/// (schema.hpp), a log of another database beside it (foreign_log.hpp), newer than `steps`, or damaged beyond
/// SQLite's recovery (integrity check). An existing log stays unchanged: for good with Open::Read, else until
/// Connection::keep_log(false), after the comparison with the journal of answers. max_pages > 0 limits the
/// file to that many pages of 4 KiB; waiting: Connection::wait_with.
std::unique_ptr<sqlite::Connection> open_database(const std::filesystem::path& path, sqlite::Open how,
                                                  const SchemaSteps& steps, std::int64_t max_pages = 0,
                                                  const sqlite::Waiting& waiting = {});

/// True if there was never a commit: the file is missing or empty, or its creation was interrupted, so that
/// its journal makes it empty again. Open::Create overwrites such a file.
bool holds_nothing(const std::filesystem::path& path);

/// Upgrades a database to the newest schema of `steps`, each step in one transaction.
void upgrade(sqlite::Connection& database, const SchemaSteps& steps);

/// Makes an empty database of the newest schema, without a file; messages name `shown`.
std::unique_ptr<sqlite::Connection> make_temporary_database(const std::filesystem::path& shown,
                                                            const SchemaSteps& steps = read_schema_steps());

}  // namespace study
