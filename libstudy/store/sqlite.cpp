#include "libstudy/store/sqlite.hpp"

#include <sqlite3.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "stats/base/error.hpp"

namespace study::sqlite {

namespace {

namespace fs = std::filesystem;

constexpr int busy_timeout_ms = 5000;

/// The path as a URI: what SQLite would read as syntax is escaped.
std::string uri(const fs::path& path, const char* parameters) {
  std::string text = "file:";
  for (const char c : fs::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      char escaped[4];
      std::snprintf(escaped, sizeof escaped, "%%%02X", static_cast<unsigned char>(c));
      text += escaped;
    } else {
      text += c;
    }
  }
  return text + parameters;
}

bool writable(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  return ::access(path.c_str(), W_OK) == 0 && ::access(folder.c_str(), W_OK) == 0;
}

bool has_log(const fs::path& path) {
  std::error_code ignored;
  const auto bytes = fs::file_size(path.string() + "-wal", ignored);
  return !ignored && bytes > 0;
}

struct Advice {
  std::string problem;
  std::string mend;
};

Advice advice(int code, const std::string& message, int system_error) {
  const std::string system = system_error ? std::string(" (") + std::strerror(system_error) + ")" : "";
  switch (code & 0xff) {
    case SQLITE_FULL:
      return {"no room left in the database: " + message,
              "free space on the disk or raise --max-pages, then run vip-study resume; all answers given "
              "are kept"};
    case SQLITE_IOERR:
      return {"cannot be read or written: " + message + system,
              "check the disk, its quota and file-size limit, then run vip-study resume"};
    case SQLITE_NOTADB:
      return {"is not a database of vip-study", "name the file that vip-study run wrote"};
    case SQLITE_CORRUPT:
      return {"is damaged or cut short: " + message, "restore a backup of it"};
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return {"cannot be opened for this: " + message + system,
              "use a file and a folder that you may write to"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {"is in use by another program", "wait until it has ended"};
    default:
      return {"database error: " + message, "restore a backup of it, or report this with the file"};
  }
}

}  // namespace

Connection::Connection(const fs::path& path, Open how) : path_(path) {
  std::error_code ignored;
  if (how != Open::Create && !fs::exists(path, ignored)) {
    throw base::Error(path.string(), "there is no such database", "check the path of --db");
  }
  if (fs::is_directory(path, ignored)) {
    throw base::Error(path.string(), "is a folder, not a database", "name a file");
  }
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
    throw base::Error(path.string(), "is not a regular file", "name the file that vip-study run wrote");
  }
  // Readers take part in the log like writers where they may, so that nothing is left beside the file.
  const bool look = how == Open::Untouched || (how == Open::Read && !writable(path) && !has_log(path));
  const bool write = how == Open::Create || how == Open::Write || (how == Open::Read && writable(path));
  const int flags = SQLITE_OPEN_URI | SQLITE_OPEN_EXRESCODE |
                    (write && !look ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY) |
                    (how == Open::Create ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(uri(path, look ? "?immutable=1" : "").c_str(), &handle_, flags, nullptr);
  if (code != SQLITE_OK) {
    const std::string message = handle_ ? sqlite3_errmsg(handle_) : "out of memory";
    const int system_error = handle_ ? sqlite3_system_errno(handle_) : 0;
    sqlite3_close_v2(std::exchange(handle_, nullptr));
    const Advice told = advice(code, message, system_error);
    throw base::Error(path.string(), told.problem, told.mend);
  }
  protect();
}

Connection::Connection(const fs::path& shown, Temporary) : path_(shown) {
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_EXRESCODE;
  if (sqlite3_open_v2("", &handle_, flags, nullptr) != SQLITE_OK) {
    sqlite3_close_v2(std::exchange(handle_, nullptr));
    throw base::Error(path_.string(), "cannot be copied: out of memory", "close other programs");
  }
  protect();
}

void Connection::copy_from(Connection& other) {
  sqlite3_backup* copy = sqlite3_backup_init(handle_, "main", other.handle_, "main");
  const int code = copy ? sqlite3_backup_step(copy, -1) : sqlite3_errcode(handle_);
  sqlite3_backup_finish(copy);
  if (code != SQLITE_DONE) {
    const Advice told = advice(code, sqlite3_errmsg(handle_), 0);
    throw base::Error(path_.string(), told.problem, told.mend);
  }
}

void Connection::protect() {
  sqlite3_busy_timeout(handle_, busy_timeout_ms);
  // A file from elsewhere must not run code of its own.
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

Connection::~Connection() { sqlite3_close_v2(handle_); }

void Connection::check(int code) const {
  if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) return;
  const Advice told = advice(code, sqlite3_errmsg(handle_), sqlite3_system_errno(handle_));
  throw base::Error(path_.string(), told.problem, told.mend);
}

void Connection::execute(const std::string& sql) {
  check(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr));
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

Statement::Statement(Connection& connection, std::string_view sql) : connection_(&connection) {
  connection.check(sqlite3_prepare_v3(connection.handle(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &handle_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), handle_(std::exchange(other.handle_, nullptr)) {}

Statement& Statement::bind(int index, std::int64_t value) {
  connection_->check(sqlite3_bind_int64(handle_, index + 1, value));
  return *this;
}

Statement& Statement::bind(int index, double value) {
  if (std::isnan(value)) return bind_null(index);
  connection_->check(sqlite3_bind_double(handle_, index + 1, value));
  return *this;
}

Statement& Statement::bind(int index, std::string_view value) {
  connection_->check(sqlite3_bind_text(handle_, index + 1, value.data() ? value.data() : "",
                                       static_cast<int>(value.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_null(int index) {
  connection_->check(sqlite3_bind_null(handle_, index + 1));
  return *this;
}

Statement& Statement::bind_from(int index, const Statement& row, int column) {
  connection_->check(sqlite3_bind_value(handle_, index + 1, sqlite3_column_value(row.handle_, column)));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    sqlite3_reset(handle_);
    return false;
  }
  try {
    connection_->check(code);
  } catch (...) {
    sqlite3_reset(handle_);
    throw;
  }
  return false;
}

std::int64_t Statement::run() {
  while (step()) {
  }
  return connection_->last_row_id();
}

void Statement::reset() { sqlite3_reset(handle_); }

int Statement::columns() const { return sqlite3_column_count(handle_); }

std::string Statement::column_name(int index) const { return sqlite3_column_name(handle_, index); }

bool Statement::is_null(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_NULL; }

bool Statement::is_real(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_FLOAT; }

bool Statement::is_text(int index) const { return sqlite3_column_type(handle_, index) == SQLITE_TEXT; }

std::int64_t Statement::integer(int index) const { return sqlite3_column_int64(handle_, index); }

double Statement::real(int index) const { return sqlite3_column_double(handle_, index); }

std::string Statement::text(int index) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(handle_, index));
  return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_, index)))
               : std::string();
}

Transaction::Transaction(Connection& connection) : connection_(&connection), turn_(connection.turn_) {
  connection.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  // A full disk may already have undone it.
  if (open_ && connection_->in_transaction()) {
    sqlite3_exec(connection_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  connection_->execute("COMMIT");
  open_ = false;
}

}  // namespace study::sqlite
