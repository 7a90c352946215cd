#pragma once
/// Makes files with people's answers private: mode 0600 whatever the umask. make_private() works on the path
/// and opens no descriptor: closing one would release the locks that this process has on the file through
/// SQLite.

#include <filesystem>

namespace study {

/// Makes an empty file that only its owner can read and write. Returns false if the file exists already.
/// base::Error if it cannot be made.
bool create_private(const std::filesystem::path& path);

/// Removes other users' access rights on a file, if the file exists. A file of another owner stays unchanged.
void make_private(const std::filesystem::path& path);

}  // namespace study
