#include "libstudy/store/file/journal_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>

#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace fs = std::filesystem;
using Json = base::Json;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& problem, int reason) {
  throw base::Error(
      path.string(), problem + ": " + std::strerror(reason),
      reason == ENOSPC || reason == EDQUOT || reason == EFBIG
          ? "free space on the disk, then run vip-study resume; all answers given are kept"
          : "see that you may write to the journal of answers and its folder, and that it is no link");
}

[[noreturn]] void fail_to_read(const fs::path& path, int reason) {
  throw base::Error(
      path.string(), std::string("cannot be read: ") + std::strerror(reason),
      reason == EACCES || reason == EPERM
          ? "ask its owner for the right to read it: it says who withdrew, and without it nothing "
            "of the database is shown"
          : "check the disk, and see that the journal of answers is a file and no link");
}

/// Writes all bytes; returns 0, or errno if that fails.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

/// Size of a regular file, bytes. base::Error if the file is not regular.
std::uintmax_t size_of(int fd, const fs::path& path) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail_to_read(path, errno);
  if (!S_ISREG(status.st_mode))
    throw base::Error(path.string(), "is not a regular file",
                      "move it away: the journal of answers has this path");
  return static_cast<std::uintmax_t>(status.st_size);
}

std::string whole(const fs::path& path, bool& exists) {
  const base::Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  exists = file.get() >= 0;
  if (!exists && errno == ENOENT) return {};
  if (!exists) fail_to_read(path, errno);
  std::string bytes(size_of(file.get(), path), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_to_read(path, errno);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

/// Parses a journal line by line.
class Reader {
 public:
  void line(const std::string& text, std::uintmax_t end) {
    if (!text.starts_with('{')) {
      ++skipped_;
      return;
    }
    if (auto row = journal::read_row(text)) {
      batch_.push_back(std::move(*row));
      return;
    }
    const Json mark = base::parse_json(text, journal::most_levels);
    if (!mark.is_object() || !take(mark)) {
      ++skipped_;
      return;
    }
    content.end = end;
    content.unreadable += std::exchange(skipped_, 0);
  }

  JournalContent content;

 private:
  bool take(const Json& mark) {
    if (mark.contains("journal")) {
      const auto schema = mark.find("schema");
      content.schema = schema != mark.end() && schema->is_number_integer() ? schema->get<std::int64_t>() : 0;
      return true;
    }
    if (const auto ready = mark.find("ready"); ready != mark.end() && ready->is_number_integer()) {
      // A batch without a "kept" line before the next batch was never committed: drop its rows.
      content.last_number = std::max(content.last_number, ready->get<std::int64_t>());
      waiting_ = ready->get<std::int64_t>();
      content.torn = skipped_ > 0;
      content.pending.clear();
      take_batch(content.pending);
      return true;
    }
    if (const auto kept = mark.find("kept"); kept != mark.end() && kept->is_number_integer()) {
      if (kept->get<std::int64_t>() == waiting_) {
        for (auto& [key, row] : content.pending) content.kept.insert_or_assign(key, std::move(row));
        content.pending.clear();
      }
      return true;
    }
    if (const auto persons = mark.find("rewrite"); persons != mark.end() && persons->is_array()) {
      content.rewriting = true;
      for (const Json& person : *persons) {
        if (person.is_string()) content.forgotten.push_back(person.get<std::string>());
      }
      return true;
    }
    return false;
  }

  void take_batch(JournalRows& rows) {
    for (journal::Row& row : batch_) {
      const std::pair key{row.table, row.key};
      rows.insert_or_assign(key, std::move(row));
    }
    batch_.clear();
    content.rewriting = false;
  }

  std::vector<journal::Row> batch_;
  std::int64_t waiting_ = 0;
  std::int64_t skipped_ = 0;
};

}  // namespace

fs::path journal_beside(const fs::path& database) {
  std::error_code ignored;
  const fs::path itself =
      fs::is_symlink(database, ignored) ? fs::weakly_canonical(database, ignored) : database;
  return (itself.empty() ? database : itself).string() + ".answers.jsonl";
}

JournalContent read_journal(const fs::path& path) {
  Reader reader;
  const std::string bytes = whole(path, reader.content.exists);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) break;
    reader.line(bytes.substr(at, end - at), end + 1);
    at = end + 1;
  }
  return std::move(reader.content);
}

std::int64_t last_event(const JournalRows& rows) {
  std::int64_t last = 0, id = 0;
  for (const auto& [key, row] : rows) {
    if (row.table->name != std::string("event")) continue;
    const auto read = std::from_chars(row.key.data(), row.key.data() + row.key.size(), id);
    if (read.ec == std::errc()) last = std::max(last, id);
  }
  return last;
}

std::string journal_head(std::int64_t schema) {
  return Json{{"journal", "answers of vip-study"}, {"schema", schema}}.dump() + '\n';
}
std::string ready_line(std::int64_t number) { return Json{{"ready", number}}.dump() + '\n'; }
std::string kept_line(std::int64_t number) { return Json{{"kept", number}}.dump() + '\n'; }
std::string rewrite_line(const std::vector<std::string>& persons) {
  Json line;
  line["rewrite"] = Json(persons);
  return line.dump() + '\n';
}

JournalFile::~JournalFile() { close(); }

void JournalFile::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

std::string JournalFile::trouble() const {
  if (fd_ < 0) return {};
  struct stat here {
  }, there{};
  if (::lstat(path_.c_str(), &there) != 0) return "was deleted or moved away";
  if (::fstat(fd_, &here) != 0 || here.st_dev != there.st_dev || here.st_ino != there.st_ino)
    return "was replaced by another file";
  return static_cast<std::uintmax_t>(here.st_size) == size_ ? "" : "was changed by another program";
}

fs::path JournalFile::set_aside() {
  close();
  std::error_code failed;
  if (!fs::exists(fs::symlink_status(path_, failed))) return {};
  fs::path aside = path_.string() + ".replaced-" + base::utc_now();
  for (int i = 2; fs::exists(fs::symlink_status(aside, failed)); ++i)
    aside = path_.string() + ".replaced-" + base::utc_now() + "-" + std::to_string(i);
  if (::rename(path_.c_str(), aside.c_str()) != 0) fail(path_, "cannot be renamed", errno);
  return aside;
}

void JournalFile::open(const std::string& head) {
  if (fd_ >= 0) return;
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0600);
  if (fd_ < 0) fail(path_, "cannot be opened", errno);
  size_ = size_of(fd_, path_);
  if (::fchmod(fd_, 0600) != 0) fail(path_, "cannot be kept private", errno);
  if (size_ > 0) return;
  if (const int reason = write_all(fd_, head)) {
    if (::ftruncate(fd_, 0) != 0) fail(path_, "cannot be written", errno);
    fail(path_, "cannot be written", reason);
  }
  size_ = head.size();
  base::sync_folder_of(path_);
}

void JournalFile::append(const std::string& text, const std::string& head, bool to_disk) {
  open(head);
  const std::uintmax_t before = size_of(fd_, path_);
  int reason = write_all(fd_, text);
  if (reason == 0 && to_disk && ::fdatasync(fd_) != 0) reason = errno;
  size_ = before + (reason == 0 ? text.size() : 0);
  if (reason == 0) return;
  if (::ftruncate(fd_, static_cast<off_t>(before)) != 0) fail(path_, "cannot be written", errno);
  fail(path_, "cannot be written", reason);
}

void JournalFile::cut(std::uintmax_t end) {
  open("");
  if (size_of(fd_, path_) > end && ::ftruncate(fd_, static_cast<off_t>(end)) != 0)
    fail(path_, "cannot be written", errno);
  size_ = size_of(fd_, path_);
}

namespace {

fs::path draft_of(const fs::path& journal) { return journal.string() + ".new"; }

/// Overwrites a file with zeros. Needed before deleting it, because deletion leaves the bytes on the disk.
void overwrite(const base::Descriptor& file, const fs::path& path) {
  const std::string zeros(1 << 16, '\0');
  for (std::uintmax_t left = size_of(file.get(), path); left > 0;) {
    const auto part = static_cast<std::size_t>(std::min<std::uintmax_t>(left, zeros.size()));
    if (const int reason = write_all(file.get(), {zeros.data(), part}))
      fail(path, "cannot be overwritten", reason);
    left -= part;
  }
  if (::fsync(file.get()) != 0) fail(path, "cannot be overwritten", errno);
}

void overwrite(const fs::path& path) {
  const base::Descriptor file(::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  const bool holds_bytes = file.get() >= 0 || (errno != ENOENT && errno != ELOOP && errno != ENXIO);
  if (!holds_bytes) return;  // a missing file, a link or a pipe has no bytes to overwrite
  if (file.get() < 0) fail(path, "cannot be overwritten", errno);
  overwrite(file, path);
}

void write_draft(const fs::path& draft, const fs::path& journal, const std::string& text) {
  const base::Descriptor file(
      ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (file.get() < 0) fail(draft, "cannot be made", errno);
  int reason = ::fchmod(file.get(), 0600) != 0 ? errno : write_all(file.get(), text);
  if (reason == 0 && ::fsync(file.get()) != 0) reason = errno;
  if (reason == 0) return;
  ::unlink(draft.c_str());
  fail(journal, "cannot be written", reason);
}

}  // namespace

void remove_journal_draft(const fs::path& path) {
  const fs::path draft = draft_of(path);
  overwrite(draft);
  if (::unlink(draft.c_str()) == 0) base::sync_folder_of(draft);
}

void replace_journal(const fs::path& path, const std::string& text) {
  const fs::path draft = draft_of(path);
  remove_journal_draft(path);
  if (text.empty()) {
    overwrite(path);
    if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail(path, "cannot be deleted", errno);
    return base::sync_folder_of(path);
  }
  write_draft(draft, path, text);
  // Exchanges the two files' names. After a power cut, `path` is either the old or the new journal, complete.
  if (base::rename_durably(draft, path, fs::exists(fs::symlink_status(path)) ? RENAME_EXCHANGE : 0))
    return remove_journal_draft(path);
  // Some file systems, such as network file systems, cannot exchange two names (EINVAL): rename the new
  // journal over the old one instead.
  const int reason = errno;
  const base::Descriptor old(::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (reason != EINVAL) fail(path, "cannot be replaced", reason);
  if (!base::rename_durably(draft, path)) fail(path, "cannot be replaced", errno);
  if (old.get() >= 0) overwrite(old, path);
}

}  // namespace study
