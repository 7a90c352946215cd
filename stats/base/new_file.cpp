#include "stats/base/new_file.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"

namespace base {

namespace fs = std::filesystem;

namespace {

constexpr const char* mend = "free space, or write to a folder that you may write to";

}  // namespace

std::string random_digits() {
  std::array<unsigned char, 8> random{};
  randombytes_buf(random.data(), random.size());
  std::array<char, 2 * random.size() + 1> text{};
  sodium_bin2hex(text.data(), text.size(), random.data(), random.size());
  return text.data();
}

fs::path draft_name(const fs::path& path) { return path.string() + ".tmp" + random_digits(); }

bool is_draft_name(const std::string& name, const std::string& target) {
  const std::string start = target + ".tmp";
  return name.starts_with(start) && name.size() > start.size() &&
         name.find_first_not_of("0123456789abcdef", start.size()) == std::string::npos;
}

void remove_stale_drafts(const fs::path& path) {
  std::error_code ignored;
  const fs::path folder = folder_of(path);
  const std::size_t length = draft_name(path.filename()).string().size();
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.size() != length || !is_draft_name(name, path.filename().string())) continue;
    const int fd = ::open(entry.path().c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) continue;
    if (::flock(fd, LOCK_EX | LOCK_NB) == 0) ::unlink(entry.path().c_str());
    ::close(fd);
  }
}

namespace {

/// Throws base::Error, which names `output`, unless the folder is writable or can be created.
void check_writable(fs::path folder, const fs::path& output) {
  struct stat above {};
  while (::stat(folder.c_str(), &above) != 0 && errno == ENOENT) folder = folder_of(folder);
  if (S_ISDIR(above.st_mode) && ::access(folder.c_str(), W_OK | X_OK) == 0) return;
  if (!S_ISDIR(above.st_mode) && above.st_mode != 0) errno = ENOTDIR;
  throw Error(output.string(), std::string("cannot be created: ") + std::strerror(errno), mend);
}

}  // namespace

void check_output(const fs::path& path) {
  struct stat standing {};
  if (::stat(path.c_str(), &standing) == 0 && !S_ISREG(standing.st_mode))
    throw Error(path.string(), "is a folder, a device or a pipe, and cannot be replaced by a file",
                "give the path of a file");
  check_writable(folder_of(path), path);
}

void check_output_folder(const fs::path& folder) { check_writable(folder, folder); }

fs::path make_folder_of(const fs::path& path) {
  std::error_code problem;
  fs::path made, folder = folder_of(path);
  for (fs::path above = folder; !fs::exists(above, problem) && !problem; above = folder_of(above))
    made = above;
  if (!made.empty()) fs::create_directories(folder, problem);
  if (problem) throw Error(path.string(), "cannot be created: " + problem.message(), mend);
  return made;
}

NewFile::NewFile(const fs::path& path, Readers readers) : path_(path), readers_(readers) {
  check_output(path);
  made_ = make_folder_of(path);
  while (!make_draft()) {
  }
}

/// Creates and locks the temporary file. Returns false if remove_stale_drafts() of another process locked or
/// deleted the file first.
bool NewFile::make_draft() {
  const fs::path draft = draft_name(path_);
  const mode_t rights = readers_ == Readers::Owner ? 0600 : 0666;
  fd_ = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, rights);
  if (fd_ < 0) fail("cannot be created");
  draft_ = draft;
  struct stat made {};
  // A file system without locks reports another error than EWOULDBLOCK. The file is then used unlocked:
  // remove_stale_drafts() cannot lock and delete it either.
  const bool taken = ::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!taken && ::fstat(fd_, &made) == 0 && made.st_nlink > 0) return true;
  ::close(std::exchange(fd_, -1));
  return false;
}

NewFile::~NewFile() {
  if (fd_ >= 0) ::close(fd_);
  if (!draft_.empty()) ::unlink(draft_.c_str());
  if (made_.empty()) return;
  for (fs::path folder = folder_of(path_); ::rmdir(folder.c_str()) == 0 && folder != made_;)
    folder = folder_of(folder);
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
  const bool replaces = ::lstat(path_.c_str(), &standing) == 0 && S_ISREG(standing.st_mode);
  if (replaces && readers_ == Readers::AsUmask)
    if (::fchmod(fd_, standing.st_mode & 07777) != 0) fail("cannot be given the rights of the file there");
  if (::fsync(fd_) != 0) fail("cannot be written");
  const int closing = fd_;
  fd_ = -1;
  if (::close(closing) != 0) fail("cannot be written");
  if (!rename_durably(draft_, path_)) fail("cannot be put in place");
  draft_.clear();
  // Each folder that was created for the file is an entry of its parent, which must be synced too.
  for (fs::path folder = folder_of(path_); !made_.empty(); folder = folder_of(folder)) {
    sync_folder_of(folder);
    if (folder == made_) made_.clear();
  }
}

void NewFile::fail(const std::string& step) const {
  throw Error(path_.string(), step + ": " + std::strerror(errno), mend);
}

FileLock::FileLock(const fs::path& path) {
  const fs::path beside = path.string() + ".lock";
  make_folder_of(beside);
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
