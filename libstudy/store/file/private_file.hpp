#pragma once
/// Makes files with people's answers private: mode 0600 even if the umask permits more. make_private() works
/// on the path and opens no descriptor: closing one would release the locks that this process has on the file
/// through SQLite.

#include <filesystem>

namespace study {

/// Makes an empty file that only its owner can read and write. Returns false if the file exists already.
/// base::Error if it cannot be made.
bool create_private(const std::filesystem::path& path);

/// Sets the mode of an existing file to 0600 if other users have any access right. The file of another owner
/// stays unchanged, without an error.
void make_private(const std::filesystem::path& path);

}  // namespace study
