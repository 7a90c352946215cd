#pragma once
/// Paths of the files beside a database, which have the database's path with a suffix.

#include <filesystem>
#include <string>

namespace study {

/// Follows symbolic links from `path` to a file, which need not exist; a path that is no link is returned
/// unchanged. So a database has the same files beside it, no matter through which link it is opened.
std::filesystem::path real_file(const std::filesystem::path& path);

/// The path real_file(database) with `suffix` appended.
std::filesystem::path beside(const std::filesystem::path& database, const std::string& suffix);

}  // namespace study
