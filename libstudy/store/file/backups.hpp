#pragma once
/// Copies beside a database: "<database>.v<version>-<UTC time>.bak" from an upgrade, "<database>.rescued-<UTC
/// time>.db", or at least its log ".wal", from a session whose file was removed or replaced.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// All backups of a database, sorted by name.
std::vector<std::filesystem::path> backups_of(const std::filesystem::path& database);

/// Deletes every session of `person` (session.person) from a backup of any schema and overwrites the bytes.
/// Sessions of others stay, whatever their code there. False if the person is not in it. base::Error: not a
/// backup that this program knows, or it cannot be written.
bool delete_from_backup(const std::filesystem::path& backup, const std::string& person);

/// Deletes every session of `person`, with all dependent rows, from a database of schema `version` within the
/// caller's transaction. From schema 2 on a tombstone stays.
void bury(sqlite::Connection& database, const std::string& person, std::int64_t version);

}  // namespace study
