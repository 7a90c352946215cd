#include "libstudy/store/file/file_watch.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

#include <cstring>
#include <utility>

namespace study {

namespace fs = std::filesystem;

namespace {

// Offsets of fields in the log's shared memory (sqlite.org/walformat.html, section 2): the log's two salts,
// which change when SQLite restarts the log; the number of log frames copied into the file; and the number of
// frames whose copying has begun.
constexpr int salt_at = 32, copied_at = 96, being_copied_at = 128;
constexpr int shared_region_bytes = 32768, copy_lock = 1;

/// SQLite's file object of the main database; null if it does not support shared memory.
sqlite3_file* main_file(sqlite3* database) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(database, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return file && file->pMethods && file->pMethods->iVersion >= 2 ? file : nullptr;
}

bool keeps_a_log(sqlite3* database) {
  std::string mode;
  const auto take = [](void* out, int, char** values, char**) {
    *static_cast<std::string*>(out) = values[0];
    return 0;
  };
  sqlite3_exec(database, "PRAGMA journal_mode", take, &mode, nullptr);
  return mode == "wal";
}

/// The log's shared memory, which the connection has already mapped; null if the database has no log. Without
/// a log, xShmMap() would make SQLite open the shared memory and never close it.
const volatile char* shared_memory(sqlite3* database) {
  sqlite3_file* file = main_file(database);
  if (!file || !keeps_a_log(database)) return nullptr;
  volatile void* region = nullptr;
  const int code = file->pMethods->xShmMap(file, 0, shared_region_bytes, 0, &region);
  return code == SQLITE_OK ? static_cast<const volatile char*>(region) : nullptr;
}

std::uint32_t word(const volatile char* memory, int at) {
  return *reinterpret_cast<const volatile std::uint32_t*>(memory + at);
}

}  // namespace

FileWatch::FileWatch(fs::path path, sqlite3* database) : path_(std::move(path)), database_(database) {
  const char* file = sqlite3_db_filename(database, "main");
  log_ = sqlite3_filename_wal(file);
  shared_ = std::string(file) + "-shm";
  file_id_ = id_of(path_);
  log_id_ = id_of(log_);
  shared_id_ = id_of(shared_);
  last_ = seen_now();
}

std::optional<FileWatch::Id> FileWatch::id_of(const fs::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  return Id{file.st_dev, file.st_ino};
}

std::optional<FileWatch::Look> FileWatch::seen_now() const {
  const volatile char* memory = shared_memory(database_);
  if (!memory) return {};
  // Before SQLite copies the log into the file, it marks the copy as under way in the shared memory. This
  // function reads the marks after the file's size and time, so that a change made by such a copy is always
  // marked.
  struct stat file {};
  if (::stat(path_.c_str(), &file) != 0) return {};
  Look seen;
  seen.bytes = file.st_size;
  seen.written_ns = file.st_mtim.tv_sec * 1'000'000'000LL + file.st_mtim.tv_nsec;
  seen.being_copied = word(memory, being_copied_at);
  seen.copied = word(memory, copied_at);
  for (int i = 0; i < 2; ++i) seen.salt[i] = word(memory, salt_at + 4 * i);
  return seen;
}

std::string FileWatch::trouble() {
  const auto file = id_of(path_);
  if (!file) return "was deleted or moved away while it was in use";
  if (file != file_id_) return "was replaced by another file while it was in use";
  // A connection that has left WAL mode has removed its log itself.
  if (id_of(log_) != log_id_)
    return keeps_a_log(database_) ? "lost its log " + log_.string() + " while it was in use" : "";
  if (!written_by_somebody()) return {};
  // A program that copies the log into the file has the lock copy_lock during the copy. If another program
  // has the lock now, the change may be such a copy: a later call of trouble() decides.
  const auto lock = [this](int how) {
    sqlite3_file* main = main_file(database_);
    return main && main->pMethods->xShmLock(main, copy_lock, 1, how | SQLITE_SHM_EXCLUSIVE) == SQLITE_OK;
  };
  if (!lock(SQLITE_SHM_LOCK)) return {};
  const bool foreign = written_by_somebody();
  lock(SQLITE_SHM_UNLOCK);
  return foreign ? "was written over by another program while it was in use" : "";
}

bool FileWatch::written_by_somebody() {
  const auto now = seen_now();
  if (!now) return false;
  const bool written = last_ && (now->bytes != last_->bytes || now->written_ns != last_->written_ns);
  // Another program may change the file by copying the log into it; the shared memory then changes too.
  const bool by_the_log = last_ && (now->salt[0] != last_->salt[0] || now->salt[1] != last_->salt[1] ||
                                    now->copied != last_->copied || now->being_copied != last_->being_copied);
  if (written && !by_the_log) return true;
  last_ = now;
  return false;
}

void FileWatch::take_log_away(const std::optional<fs::path>& kept) const {
  std::error_code ignored;
  if (id_of(log_) == log_id_) {
    if (kept) {
      fs::rename(log_, *kept, ignored);
    } else {
      fs::remove(log_, ignored);
    }
  }
  if (id_of(shared_) == shared_id_) fs::remove(shared_, ignored);
}

}  // namespace study
