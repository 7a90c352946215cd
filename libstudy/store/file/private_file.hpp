#pragma once
/// Files with people's answers: 0600 whatever the umask. Functions take paths only: closing a descriptor of a
/// file would release the locks that SQLite holds on it in the same process.

#include <filesystem>

namespace study {

/// Makes an empty file, readable and writable by its owner only. False if it exists already. base::Error if
/// it cannot be made.
bool create_private(const std::filesystem::path& path);

/// Removes the rights of others on a file, if it exists. A file of another owner stays unchanged.
void make_private(const std::filesystem::path& path);

}  // namespace study
