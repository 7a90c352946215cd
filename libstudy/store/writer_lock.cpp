#include "libstudy/store/writer_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "stats/base/error.hpp"

namespace study {

WriterLock::WriterLock(const std::filesystem::path& database)
    : fd_(::open(database.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (fd_ >= 0 && ::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd_);
    throw base::Error(database.string(), "another vip-study is running on this database",
                      "wait until it has ended");
  }
}

WriterLock::~WriterLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace study
