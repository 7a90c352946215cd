#pragma once
/// What stands beside a database: its name with something appended.

#include <filesystem>
#include <string>

namespace study {

/// The file that a path leads to through symbolic links of files, there or not; a path without them as it is.
/// Whatever link a database is opened through, it is one database with one set of files beside it.
std::filesystem::path real_file(const std::filesystem::path& path);

/// The neighbour of a database's real file: "<database><suffix>".
std::filesystem::path beside(const std::filesystem::path& database, const std::string& suffix);

}  // namespace study
