#pragma once
/// Files beside a database: its name with a suffix.

#include <filesystem>
#include <string>

namespace study {

/// Resolves symbolic links to files; the target need not exist. Other paths are returned unchanged. So a
/// database has one set of files beside it, whatever link it is opened through.
std::filesystem::path real_file(const std::filesystem::path& path);

/// The path "<database><suffix>" of the database's real file.
std::filesystem::path beside(const std::filesystem::path& database, const std::string& suffix);

}  // namespace study
