#include "libstudy/store/file/sqlite.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "libstudy/store/file/file_watch.hpp"
#include "libstudy/store/file/foreign_log.hpp"
#include "libstudy/store/file/private_file.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::sqlite {

namespace fs = std::filesystem;

namespace {

/// The identifier of a file in /proc/locks (device and inode); empty if the file does not exist.
std::string kernel_name(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  return fmt::format("{:02x}:{:02x}:{}", major(file.st_dev), minor(file.st_dev), file.st_ino);
}

/// The other programs with a write lock on a SQLite database or its shared memory, e.g. "sqlitebrowser
/// (process 4711)"; "another program" if /proc/locks lists none. Reads the list of all locks and does not
/// open the database, because closing a descriptor of it would release SQLite's locks.
std::string lock_holder(const std::filesystem::path& database) {
  const std::string file = kernel_name(database.string()), shared = kernel_name(database.string() + "-shm");
  std::set<long> holders;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, strictness, access, name;
    long process = 0;
    if (!(words >> number >> kind >> strictness >> access >> process >> name)) continue;
    const bool ours = process == ::getpid();
    if (kind == "POSIX" && access == "WRITE" && !ours && process > 0 && (name == file || name == shared))
      holders.insert(process);
  }
  std::string text;
  for (const long process : holders) {
    std::string program;
    std::ifstream comm("/proc/" + std::to_string(process) + "/comm");
    std::getline(comm, program);
    text += (text.empty() ? "" : ", ") + (program.empty() ? "a program" : program) + " (process " +
            std::to_string(process) + ")";
  }
  return text.empty() ? "another program" : text;
}

constexpr std::int64_t second_ns = 1'000'000'000, longest_wait_ns = 5 * second_ns;
constexpr std::chrono::milliseconds between_tries{20};
constexpr int pages_of_a_log = 1000;  // length at which SQLite copies the log into the file; its default

std::int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

bool writable(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return ::access(path.c_str(), W_OK) == 0 && ::access(folder.c_str(), W_OK) == 0;
}

void check_is_file(const fs::path& path, Open how) {
  std::error_code ignored;
  const fs::file_status found = fs::status(path, ignored);
  if (how != Open::Create && !fs::exists(found))
    throw base::Error(path.string(), "there is no such database", "check the path that you gave");
  if (fs::is_directory(found)) throw base::Error(path.string(), "is a folder, not a database", "name a file");
  if (fs::exists(found) && !fs::is_regular_file(found))
    throw base::Error(path.string(), "is not a regular file", "name the file that vip-study run wrote");
}

}  // namespace

Connection::Connection(const fs::path& path, Open how) : path_(path) {
  check_is_file(path, how);
  if (how == Open::Create) {
    refuse_orphaned_log(path);
    create_private(path);
  }
  // Readers also open the file for writing if they may, so that SQLite can remove the log's files at the end.
  const bool write = how != Open::Read || writable(path);
  const int code = sqlite3_open_v2(
      fs::absolute(path).c_str(), &handle_,
      SQLITE_OPEN_EXRESCODE | (write ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY), nullptr);
  if (code != SQLITE_OK) {
    const std::string message = handle_ ? sqlite3_errmsg(handle_) : "out of memory";
    const int system_error = handle_ ? sqlite3_system_errno(handle_) : 0;
    sqlite3_close_v2(std::exchange(handle_, nullptr));
    fail(code, message, system_error);
  }
  protect();
  try {
    refuse_foreign_log(path_, [this] { return header(); });
  } catch (...) {
    sqlite3_close_v2(std::exchange(handle_, nullptr));
    throw;
  }
}

Connection::Connection(const fs::path& shown, Temporary) : path_(shown) {
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXRESCODE;
  if (sqlite3_open_v2("", &handle_, flags, nullptr) != SQLITE_OK) {
    sqlite3_close_v2(std::exchange(handle_, nullptr));
    throw base::Error(path_.string(), "needs a temporary database, for which there is too little memory",
                      "close other programs, then try again");
  }
  protect();
  // Keeps the journal and temporary tables of the temporary database in memory instead of in files.
  execute("PRAGMA journal_mode = MEMORY; PRAGMA temp_store = MEMORY");
}

Connection::~Connection() {
  if (watch_ && !lost_) {
    try {
      if (const std::string trouble = watch_->trouble(); !trouble.empty()) abandon(trouble);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
  }
  sqlite3_close_v2(handle_);
}

std::string Connection::header() {
  sqlite3_file* file = nullptr;
  check(sqlite3_file_control(handle_, "main", SQLITE_FCNTL_FILE_POINTER, &file));
  // Takes the size from the file system, because SQLite's xFileSize() returns 0 for a file of one byte.
  std::string header(static_cast<std::size_t>(std::min<std::uintmax_t>(fs::file_size(path_), 100)), '\0');
  if (!header.empty()) check(file->pMethods->xRead(file, header.data(), static_cast<int>(header.size()), 0));
  return header;
}

bool Connection::can_read() {
  const int code = sqlite3_exec(handle_, "SELECT 1 FROM sqlite_schema LIMIT 1", nullptr, nullptr, nullptr);
  return (code & 0xff) != SQLITE_CANTOPEN && (code & 0xff) != SQLITE_READONLY;
}

void Connection::keep_log(bool keep) {
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, keep ? 1 : 0, nullptr);
  sqlite3_wal_autocheckpoint(handle_, keep ? 0 : pages_of_a_log);
}

void Connection::limit_pages(std::int64_t pages) {
  integer("PRAGMA max_page_count = " + std::to_string(pages));
  limited_ = true;
}

void Connection::wait_with(Waiting waiting) { waiting_ = std::move(waiting); }

int Connection::wait(void* connection, int tries) {
  auto& self = *static_cast<Connection*>(connection);
  const std::int64_t now = now_ns();
  if (tries == 0) self.wait_began_ns_ = self.told_ns_ = now;
  if (!self.waiting_ && now - self.wait_began_ns_ > longest_wait_ns) return 0;
  if (self.waiting_ && now - self.told_ns_ >= second_ns) {
    self.told_ns_ = now;
    if (!self.waiting_(lock_holder(self.path_))) return 0;
  }
  std::this_thread::sleep_for(between_tries);
  return 1;
}

void Connection::check(int code) {
  if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) return;
  const std::string message = sqlite3_errmsg(handle_);
  const int system_error = sqlite3_system_errno(handle_);
  // If another program changed the file, reports that change instead of the SQLite error that it caused.
  if (watch_ && !lost_) {
    if (const std::string trouble = watch_->trouble(); !trouble.empty()) abandon(trouble);
  }
  fail(code, message, system_error);
}

void Connection::fail(int code, const std::string& message, int system_error) const {
  const std::string system = system_error ? std::string(" (") + std::strerror(system_error) + ")" : "";
  const auto error = [this](const std::string& problem, const std::string& mend) {
    return base::Error(path_.string(), problem, mend);
  };
  if (code == SQLITE_READONLY_DBMOVED)
    throw error("was deleted, moved or replaced while it was in use", "put it back, then " + go_on_);
  switch (code & 0xff) {
    case SQLITE_FULL:
      throw error("no room left in the database: " + message, std::string("free space on the disk") +
                                                                  (limited_ ? " or raise --max-pages" : "") +
                                                                  ", then " + go_on_);
    case SQLITE_IOERR:
      throw error("cannot be read or written: " + message + system,
                  "check the disk, its quota and file-size limit, then " + go_on_);
    case SQLITE_INTERRUPT:
    case SQLITE_AUTH:
    case SQLITE_TOOBIG:
      throw error("contains something that vip-study did not write: " + message,
                  "do not use this file; ask the person who made it what was changed");
    case SQLITE_NOTADB:
      throw error("is not a database of vip-study", "name the file that vip-study run wrote");
    case SQLITE_CORRUPT:
      throw error("is damaged or cut short: " + message, salvage_mend(path_));
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      throw error("cannot be opened or changed: " + message + system,
                  "use a file and a folder that you may write to");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_PROTOCOL:  // SQLite tried for ten seconds to lock the log
      throw LockedOut(path_.string(), "is locked by " + lock_holder(path_),
                      "close the file there, then " + go_on_);
    default:
      throw error("database error: " + message, "report this with the file");
  }
}

std::string salvage_mend(const fs::path& path) {
  return "restore a backup of it, or save what can be read: vip-study salvage --db " + path.string() +
         " --into NEW";
}

void Connection::execute(const std::string& sql) {
  check(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr));
}

void Connection::check_integrity() {
  const std::string found = text("PRAGMA integrity_check(1)");
  if (found != "ok")
    throw base::Error(path_.string(), "is damaged or cut short: " + found, salvage_mend(path_));
}

void Connection::copy_from(Connection& other, const std::function<void()>& complete) {
  const std::int64_t page_bytes = integer("PRAGMA page_size");
  if (text("PRAGMA journal_mode") == "wal" && other.integer("PRAGMA page_size") != page_bytes)
    other.execute("PRAGMA page_size = " + std::to_string(page_bytes) + "; VACUUM");
  const std::unique_ptr<sqlite3_backup, int (*)(sqlite3_backup*)> copy(
      sqlite3_backup_init(handle_, "main", other.handle_, "main"), sqlite3_backup_finish);
  int code = copy ? sqlite3_backup_step(copy.get(), 0) : sqlite3_errcode(handle_);  // takes the write lock
  if (code == SQLITE_OK && complete) complete();
  if (code == SQLITE_OK) code = sqlite3_backup_step(copy.get(), -1);
  if (code != SQLITE_DONE) fail(code, sqlite3_errstr(code), sqlite3_system_errno(handle_));
}

std::int64_t Connection::integer(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string Connection::text(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.text(0) : std::string();
}

std::int64_t Connection::last_row_id() const { return sqlite3_last_insert_rowid(handle_); }

bool Connection::in_transaction() const { return sqlite3_get_autocommit(handle_) == 0; }

void Connection::unwatch() { watch_.reset(); }

void Connection::watch() {
  integer("SELECT 1 FROM sqlite_schema LIMIT 1");  // the first read makes SQLite create the log
  watch_ = std::make_unique<FileWatch>(path_, handle_);
}

void Connection::begin() {
  if (lost_) throw base::Error(path_.string(), lost_->problem, lost_->mend);
  execute("BEGIN IMMEDIATE");
  changes_before_ = sqlite3_total_changes64(handle_);
}

void Connection::commit() {
  if (marked_ && sqlite3_total_changes64(handle_) != changes_before_)
    execute("PRAGMA user_version = " + std::to_string(integer("PRAGMA user_version")));
  std::string trouble = watch_ ? watch_->trouble() : "";
  // If another program changed the file, writes the commit only to the log; abandon() copies it from there.
  if (!trouble.empty()) sqlite3_wal_autocheckpoint(handle_, 0);
  execute("COMMIT");
  if (watch_ && trouble.empty()) trouble = watch_->trouble();
  if (!trouble.empty()) abandon(trouble);
}

void Connection::abandon(const std::string& trouble) {
  if (in_transaction()) sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
  keep_log(true);
  lost_ = Lost{trouble + "; nothing more is written to it", ""};
  const std::string rescued = path_.string() + ".rescued-" + base::utc_now();
  try {
    save_as(rescued + ".db");
    watch_->take_log_away({});
    lost_->problem += "; all of its data up to now are in " + rescued + ".db";
    lost_->mend = "move away what is at " + path_.string() + " now, rename " + rescued +
                  ".db to that name, then " + go_on_;
  } catch (const base::Error& error) {
    watch_->take_log_away(rescued + ".wal");
    lost_->problem += "; its data could not be saved beside it; its log is kept as " + rescued + ".wal";
    lost_->mend = salvage_mend(path_);
  }
  throw base::Error(path_.string(), lost_->problem, lost_->mend);
}

void Connection::save_as(const fs::path& path) {
  if (!create_private(path)) throw base::Error(path.string(), "exists already", "move it to another folder");
  try {
    Connection copy(path, Open::Write);
    copy.copy_from(*this);
    copy.check_integrity();
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
}

Transaction::Transaction(Connection& connection) : connection_(&connection), turn_(connection.turn_) {
  connection.begin();
}

Transaction::~Transaction() {
  // SQLite may have rolled the transaction back already, e.g. because the disk is full.
  if (open_ && connection_->in_transaction()) {
    sqlite3_exec(connection_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  connection_->commit();
  open_ = false;
}

}  // namespace study::sqlite
