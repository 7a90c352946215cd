#pragma once
/// Copies of a database that an upgrade left beside it, "<database>.v<version>-<UTC time>.bak", or a session
/// whose file was taken away, "<database>.rescued-<UTC time>.db".

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// All of them, by name.
std::vector<std::filesystem::path> backups_of(const std::filesystem::path& database);

/// Deletes every session of `person` (session.person) from a backup of any schema and overwrites where it
/// stood; nobody else's, whatever their code is there. False: the person does not stand in it. base::Error:
/// not a backup that this program knows, or it cannot be written.
bool delete_from_backup(const std::filesystem::path& backup, const std::string& person);

/// Deletes every session of `person` from a database of schema `version`, with all that belongs to them,
/// within a transaction of the caller; from schema 2 on a tombstone stays.
void bury(sqlite::Connection& database, const std::string& person, std::int64_t version);

}  // namespace study
