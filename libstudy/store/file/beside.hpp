#pragma once
/// Paths of the files beside a database, which have the database's path with a suffix.

#include <filesystem>
#include <optional>
#include <string>

namespace study {

/// Follows symbolic links from `path` to a file, which need not exist; a path that is no link is returned
/// unchanged. So a database has the same files beside it, no matter through which link it is opened.
std::filesystem::path real_file(const std::filesystem::path& path);

/// The name after "service:" if the path names a central database: a section of libpq's service file. None
/// for the path of a file; "./service:x" is one.
std::optional<std::string> service_of(const std::filesystem::path& path);
/// base::Error if the path names a central database: these are read, and only vip-study push writes them.
void refuse_service(const std::filesystem::path& path);

/// The path real_file(database) with `suffix` appended.
std::filesystem::path beside(const std::filesystem::path& database, const std::string& suffix);

}  // namespace study
