#include "libstudy/store/file/private_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "stats/base/error.hpp"

namespace study {

bool create_private(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) {
    if (errno == EEXIST) return false;
    throw base::Error(path.string(), std::string("cannot be made: ") + std::strerror(errno),
                      "use a file and a folder that you may write to");
  }
  ::close(fd);
  return true;
}

void make_private(const std::filesystem::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) == 0 && (found.st_mode & 077) != 0) [[maybe_unused]]
    const int other_owner = ::chmod(path.c_str(), 0600);
}

}  // namespace study
