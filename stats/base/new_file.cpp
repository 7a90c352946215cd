#include "stats/base/new_file.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "stats/base/error.hpp"

namespace base {

namespace fs = std::filesystem;

namespace {

constexpr const char* mend = "free space, or write to a folder that you may write to";

/// A rename is sure to stand after a power cut only once the folder was synced. File systems that cannot do
/// that have nothing to be told, and the file is in place.
void sync_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

}  // namespace

fs::path draft_name(const fs::path& path) {
  std::array<unsigned char, 8> random{};
  randombytes_buf(random.data(), random.size());
  std::array<char, 2 * random.size() + 1> text{};
  sodium_bin2hex(text.data(), text.size(), random.data(), random.size());
  return path.string() + ".tmp" + text.data();
}

NewFile::NewFile(const fs::path& path) : path_(path) {
  const fs::path draft = draft_name(path);
  fd_ = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd_ < 0) fail("cannot be created");
  draft_ = draft;
}

NewFile::~NewFile() {
  if (fd_ >= 0) ::close(fd_);
  if (!draft_.empty()) ::unlink(draft_.c_str());
}

void NewFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void NewFile::put_in_place() {
  struct stat standing {};
  if (::lstat(path_.c_str(), &standing) == 0 && S_ISREG(standing.st_mode))
    if (::fchmod(fd_, standing.st_mode & 07777) != 0) fail("cannot be given the rights of the file there");
  if (::fsync(fd_) != 0) fail("cannot be written");
  const int closing = fd_;
  fd_ = -1;
  if (::close(closing) != 0) fail("cannot be written");
  if (::rename(draft_.c_str(), path_.c_str()) != 0) fail("cannot be put in place");
  draft_.clear();
  sync_folder_of(path_);
}

void NewFile::fail(const std::string& step) const {
  throw Error(path_.string(), step + ": " + std::strerror(errno), mend);
}

FileLock::FileLock(const fs::path& path) {
  const fs::path beside = path.string() + ".lock";
  fd_ = ::open(beside.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  int done = fd_ < 0 ? -1 : ::flock(fd_, LOCK_EX);
  while (done != 0 && fd_ >= 0 && errno == EINTR) done = ::flock(fd_, LOCK_EX);
  if (done == 0) return;
  const std::string reason = std::strerror(errno);
  if (fd_ >= 0) ::close(fd_);
  throw Error(beside.string(), "cannot be locked: " + reason, mend);
}

FileLock::~FileLock() { ::close(fd_); }

}  // namespace base
