#pragma once
/// Changes of folders that outlast a power loss. A file system may write them to the disk in another order
/// than they were made, and what was made, moved or removed may come back, until the folder is synced. Errors
/// are base::Error and name the path.

#include <filesystem>

namespace base {

/// The folder that holds `path`: "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Brings the names in the folder of `path` to the disk. A file system that cannot sync a folder is passed
/// by, as is a folder that is not there.
void sync_folder_of(const std::filesystem::path& path);

/// Brings the bytes of a file to the disk that another library wrote. Not while SQLite has it open in this
/// process, which would lose its locks.
void sync_file(const std::filesystem::path& path);

/// Brings the names in a folder, and in all folders below it, to the disk.
void sync_folders(const std::filesystem::path& folder);

/// Renames, then syncs the folders of both names. flags: of renameat2(2); on error errno is its own.
bool rename_durably(const std::filesystem::path& from, const std::filesystem::path& to, unsigned flags = 0);

/// Removes a file, a link or a folder with all in it, then syncs the folder that held it: also where nothing
/// stands there any more, as an earlier removal may not be on the disk yet.
void remove_durably(const std::filesystem::path& path);

}  // namespace base
