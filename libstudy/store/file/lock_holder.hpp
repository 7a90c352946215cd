#pragma once
/// Names the program that holds the lock that a write waits for.

#include <filesystem>
#include <string>

namespace study {

/// The programs with a write lock on a SQLite database or its shared memory, e.g. "sqlitebrowser (process
/// 4711)"; "another program" if the system does not tell.
std::string lock_holder(const std::filesystem::path& database);

}  // namespace study
