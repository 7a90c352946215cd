#include "stats/base/durable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "stats/base/error.hpp"

namespace base {

namespace fs = std::filesystem;

namespace {

void sync(const fs::path& path, int flags) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (fd < 0) return;
  const int reason = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  if (reason == EIO || reason == ENOSPC || reason == EDQUOT)
    throw Error(path.string(), std::string("cannot be written to the disk: ") + std::strerror(reason),
                "free space or check the disk, and run the command again");
}

void sync_folder(const fs::path& folder) { sync(folder, O_DIRECTORY); }

}  // namespace

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : "."; }

void sync_folder_of(const fs::path& path) { sync_folder(folder_of(path)); }

void sync_file(const fs::path& path) { sync(path, O_NONBLOCK); }

void sync_folders(const fs::path& folder) {
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_directory() && !entry.is_symlink()) sync_folder(entry.path());
  } catch (const fs::filesystem_error& error) {
    throw Error(folder.string(), "cannot be searched for folders: " + error.code().message(),
                "check its permissions, and run the command again");
  }
  sync_folder(folder);
}

bool rename_durably(const fs::path& from, const fs::path& to, unsigned flags) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) != 0) return false;
  sync_folder_of(to);
  if (folder_of(from) != folder_of(to)) sync_folder_of(from);
  return true;
}

void remove_durably(const fs::path& path) {
  std::error_code problem;
  fs::remove_all(path, problem);
  if (problem)
    throw Error(path.string(), "cannot be deleted: " + problem.message(),
                "check its permissions, and run the command again");
  sync_folder_of(path);
}

}  // namespace base
