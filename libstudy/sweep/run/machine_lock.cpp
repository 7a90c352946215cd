#include "libstudy/sweep/run/machine_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "stats/base/error.hpp"

namespace study {

namespace {

namespace fs = std::filesystem;

constexpr const char* mend = "set VIP_LOCK_DIR to a folder of this machine that all its users may write to";

/// The lock's folder: $VIP_LOCK_DIR, or the first of /run/lock and /tmp that everyone may write to. All users
/// must get the same folder, so the permissions of the current user do not matter.
fs::path lock_folder() {
  if (const char* named = std::getenv("VIP_LOCK_DIR"); named && *named) return named;
  for (const fs::path folder : {"/run/lock", "/tmp"}) {
    std::error_code ignored;
    const auto found = fs::status(folder, ignored);
    if (fs::is_directory(found) && (found.permissions() & fs::perms::others_write) != fs::perms::none)
      return folder;
  }
  throw base::Error("/run/lock and /tmp", "are no folders that every user may write to", mend);
}

[[noreturn]] void fail(const fs::path& path, const std::string& step) {
  throw base::Error(path.string(), step + ": " + std::strerror(errno), mend);
}

/// Opens the lock file for reading, which suffices for flock(), and creates it if it is missing. An existing
/// file is opened without O_CREAT: in a folder such as /tmp the kernel may refuse O_CREAT on another user's
/// file (fs.protected_regular).
int open_lock(const fs::path& path) {
  constexpr int flags = O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  int fd = ::open(path.c_str(), flags);
  if (fd < 0 && errno == ENOENT) {
    fd = ::open(path.c_str(), flags | O_CREAT | O_EXCL, 0644);
    if (fd >= 0) ::fchmod(fd, 0644);  // independent of the umask
    if (fd < 0 && errno == EEXIST) fd = ::open(path.c_str(), flags);
  }
  if (fd < 0) fail(path, "cannot be opened");
  return fd;
}

/// Calls flock() again when a signal interrupts it. Returns 0, or -1 with errno.
int lock(int fd, int how) {
  int done = ::flock(fd, how);
  while (done != 0 && errno == EINTR) done = ::flock(fd, how);
  return done;
}

void tell_once(const fs::path& path) {
  static bool told = false;
  if (told) return;
  told = true;
  std::fprintf(stderr, "waits for another timed run on this machine (%s)\n", path.c_str());
}

}  // namespace

MachineLock::MachineLock() {
  const fs::path path = lock_folder() / "vip-bench.lock";
  fd_ = open_lock(path);
  int done = lock(fd_, LOCK_EX | LOCK_NB);
  if (done != 0 && errno == EWOULDBLOCK) {
    tell_once(path);
    done = lock(fd_, LOCK_EX);
  }
  if (done == 0) return;
  const int error = errno;
  ::close(fd_);
  errno = error;
  fail(path, "cannot be locked");
}

MachineLock::~MachineLock() { ::close(fd_); }

}  // namespace study
