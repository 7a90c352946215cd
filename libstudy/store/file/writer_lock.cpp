#include "libstudy/store/file/writer_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/foreign_log.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

using FileId = std::pair<dev_t, ino_t>;

/// Files that this process has locked. A second WriterLock must not even open such a file: closing it would
/// release SQLite's locks.
struct OwnLocks {
  std::mutex mutex;
  std::set<FileId> files;
};

OwnLocks& own_locks() {
  static OwnLocks locks;
  return locks;
}

FileId id_of(const struct stat& file) { return {file.st_dev, file.st_ino}; }

bool locked_here(const fs::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return false;
  const std::lock_guard guard(own_locks().mutex);
  return own_locks().files.contains(id_of(file));
}

/// True if the file at the path is the open file `fd`; false if the path has another file or none.
bool leads_to(const fs::path& path, int fd) {
  struct stat there {
  }, held{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(fd, &held) == 0 && id_of(there) == id_of(held);
}

[[noreturn]] void throw_busy(const fs::path& path) {
  throw base::Error(path.string(), "another vip-study is running on this database",
                    "wait until it has ended");
}

[[noreturn]] void throw_unopened(const fs::path& path, int problem) {
  if (problem == ENOENT && !fs::is_symlink(path) && fs::is_directory(fs::absolute(path).parent_path()))
    throw base::Error(path.string(), "there is no such database", "check the path that you gave");
  if (problem == EISDIR) throw base::Error(path.string(), "is a folder, not a database", "name a file");
  throw base::Error(path.string(), std::string("cannot be opened for writing: ") + std::strerror(problem),
                    "use a file and a folder that you may write to");
}

}  // namespace

WriterLock::WriterLock(const fs::path& database, sqlite::Open how) : path_(database) {
  refuse_service(path_);
  if (how == sqlite::Open::Create) {
    base::make_folder_of(path_);
    refuse_orphaned_log(path_);
  }
  // Tries again if another process made or removed the file between two steps.
  for (int round = 0;; ++round) {
    if (locked_here(path_)) throw_busy(path_);
    if (how == sqlite::Open::Create) {
      fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
      made_ = fd_ >= 0;
      if (!made_ && errno != EEXIST) throw_unopened(path_, errno);
    }
    if (!made_) fd_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd_ < 0 && (errno != ENOENT || how != sqlite::Open::Create || round > 100))
      throw_unopened(path_, errno);
    if (fd_ < 0) continue;
    if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      const int problem = errno;
      ::close(fd_);
      if (problem == EWOULDBLOCK) throw_busy(path_);
      throw_unopened(path_, problem);
    }
    if (leads_to(path_, fd_)) break;
    ::close(fd_);
  }
  struct stat held {};
  ::fstat(fd_, &held);
  // Another process may have made this empty file but failed to lock it first. The process with the lock must
  // remove the file if nothing is stored in it.
  if (how == sqlite::Open::Create && held.st_size == 0) made_ = true;
  const std::lock_guard guard(own_locks().mutex);
  own_locks().files.insert(id_of(held));
}

WriterLock::~WriterLock() {
  if (made_ && leads_to(path_, fd_)) {
    std::error_code ignored;
    for (const char* beside : {"-journal", "-wal", "-shm", ""}) fs::remove(path_.string() + beside, ignored);
  }
  struct stat held {};
  ::fstat(fd_, &held);
  {
    const std::lock_guard guard(own_locks().mutex);
    own_locks().files.erase(id_of(held));
  }
  ::close(fd_);
}

}  // namespace study
