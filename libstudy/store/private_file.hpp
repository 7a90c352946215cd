#pragma once
/// Files that hold what people said: 0600 whatever the umask. Only ever by path: closing a descriptor of a
/// file would take away the locks that SQLite holds on it in the same process.

#include <filesystem>

namespace study {

/// Makes an empty file, readable and writable by its owner only. False when there is one already. base::Error
/// when it cannot be made.
bool create_private(const std::filesystem::path& path);

/// Takes away the rights of others on a file, if it is there. A file of another owner stays as it is.
void make_private(const std::filesystem::path& path);

}  // namespace study
