#pragma once
/// Who holds the lock that a write waits for.

#include <filesystem>
#include <string>

namespace study {

/// Programs that hold a lock for writing on a SQLite database or the shared memory of its log, e.g.
/// "sqlitebrowser (process 4711)"; "another program" where the system does not say.
std::string lock_holder(const std::filesystem::path& database);

}  // namespace study
