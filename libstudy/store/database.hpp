#pragma once
/// Opens the database of a study: recognises it, checks it, brings its schema up to date.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// SQLite's application_id of our databases: "ViPL".
inline constexpr std::int64_t database_application_id = 0x5669504C;

/// The SQL of each schema step in order; step i leads to user_version i + 1.
using SchemaSteps = std::vector<std::string>;
/// The program's own steps, from libstudy/store/sql/.
SchemaSteps read_schema_steps();

/// Opens `path` with foreign keys, WAL and synchronous = FULL, always through its log and journal: a file
/// that a kill, a full disk or a power cut left behind is as good as any other. Where it is a
/// link, the real file (beside.hpp).
///
/// Open::Create makes a missing or empty file into a database; Open::Write upgrades an older one, each step
/// in one transaction, after a copy "<path>.v<version>-<UTC time>.bak"; both are 0600 then, and watched
/// (Connection::watch). Whoever writes holds a WriterLock before. Open::Read gives an upgraded, temporary
/// copy of an older one, and where nothing can be written beside the file a temporary copy as well.
/// base::Error, with the file and what stands beside it left byte for byte as they were: not a database of
/// this program, with tables or views that it did not make (schema.hpp), beside a log of another one
/// (foreign_log.hpp), newer than `steps`, or damaged so that SQLite cannot make it whole (integrity check).
/// A log that stood beside it stays as it is: for good with Open::Read, else until
/// Connection::keep_log(false), which comes with the comparison with the journal of answers. max_pages > 0
/// limits the file to that many pages of 4 KiB; waiting: Connection::wait_with.
std::unique_ptr<sqlite::Connection> open_database(const std::filesystem::path& path, sqlite::Open how,
                                                  const SchemaSteps& steps, std::int64_t max_pages = 0,
                                                  const sqlite::Waiting& waiting = {});

/// Whether no commit was ever made: the file is missing, empty, or was being made when a kill or a power cut
/// ended the program, so that its journal makes it empty again. Open::Create makes such a file anew.
bool holds_nothing(const std::filesystem::path& path);

/// Brings a database to the newest schema of `steps`, each step in one transaction.
void upgrade(sqlite::Connection& database, const SchemaSteps& steps);

/// Empty, of the newest schema, without a file; messages name `shown`.
std::unique_ptr<sqlite::Connection> make_temporary_database(const std::filesystem::path& shown,
                                                            const SchemaSteps& steps = read_schema_steps());

}  // namespace study
