#pragma once
/// Backups beside a database. An upgrade makes "<database>.v<version>-<UTC time>.bak". A program that finds
/// its database removed, replaced or overwritten by another program saves "<database>.rescued-<UTC time>.db"
/// or, if that fails, only SQLite's write-ahead log as "<database>.rescued-<UTC time>.wal".

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// All backups of a database, sorted by name.
std::vector<std::filesystem::path> backups_of(const std::filesystem::path& database);

/// Deletes every session of `person` (session.person) from a backup of any schema and overwrites the bytes.
/// Sessions of other people stay, even if they have the same code in the backup. Returns false if the backup
/// has no session of the person. base::Error if the file is not a database of vip-study, or cannot be
/// written.
bool delete_from_backup(const std::filesystem::path& backup, const std::string& person);

/// Deletes every session of `person` with all dependent rows, within the caller's transaction, and leaves a
/// tombstone: a row that says who withdrew. `version`: the database's schema, at least 2.
void bury(sqlite::Connection& database, const std::string& person, std::int64_t version);

}  // namespace study
