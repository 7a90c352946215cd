#pragma once
/// Changes of folders that survive a power loss. Until a folder is synced, a file system may write changes to
/// disk in another order than they were made, and may undo a creation, move or removal. Errors are
/// base::Error and name the path.

#include <filesystem>

namespace base {

/// The parent folder of `path`; "." if `path` is a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Writes the directory entries of the folder of `path` to disk (fsync). Does nothing if the folder does not
/// exist or its file system cannot sync folders.
void sync_folder_of(const std::filesystem::path& path);

/// Writes the bytes of a file to disk (fsync), for files that another library wrote. Do not call it while
/// SQLite has the file open in this process: SQLite would lose its locks.
void sync_file(const std::filesystem::path& path);

/// Writes the directory entries of a folder, and of all folders below it, to disk.
void sync_folders(const std::filesystem::path& folder);

/// Renames, then syncs the folders of both names. `flags` are those of renameat2(2). Returns false if the
/// rename failed; errno is then the error of renameat2.
bool rename_durably(const std::filesystem::path& from, const std::filesystem::path& to, unsigned flags = 0);

/// Removes a file, a link or a folder with all its contents, then syncs the parent folder. It syncs even if
/// nothing exists at `path`, since an earlier removal may not be on disk yet.
void remove_durably(const std::filesystem::path& path);

}  // namespace base
