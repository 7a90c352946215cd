#pragma once
/// RAII wrappers for the parts of SQLite that the store uses. Each failure that SQLite reports becomes a
/// base::Error that names the database file.
///
/// While a connection is open, the process must open and close the database file only through SQLite: closing
/// any other descriptor of the file would release the locks that SQLite has on it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "stats/base/error.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace study {
class FileWatch;
}

namespace study::sqlite {

/// How a database is opened.
enum class Open {
  Create,  ///< for writing; created if missing, readable by its owner only
  Write,   ///< for writing; must exist
  Read     ///< for reading only; must exist
};

/// Selects a temporary database without a file name: in memory, or on disk if large. It is deleted with its
/// connection.
struct Temporary {};

/// Limit on SQLite's work with an untrusted file. OfASchema: 10 million operations of its virtual machine,
/// far more than reading the schema of vip-study takes. Any: no limit.
enum class Work { OfASchema, Any };

/// Called about once a second while a statement waits for a lock that another program has. `holder` names
/// that program, e.g. "sqlitebrowser (process 4711)". If it returns false, the statement fails at once.
using Waiting = std::function<bool(const std::string& holder)>;

/// Error: another program had the database locked until the wait for the lock ended.
class LockedOut : public base::Error {
  using Error::Error;
};

/// Text of the remedy in error messages about a file that SQLite cannot recover.
std::string salvage_mend(const std::filesystem::path& path);

/// A connection to one database. Two threads may share a connection if both use it only within a Transaction,
/// since a thread's Transaction waits until the other thread's has ended.
class Connection {
 public:
  Connection(const std::filesystem::path& path, Open how);
  /// Makes an empty temporary database; error messages name `shown` as its file.
  Connection(const std::filesystem::path& shown, Temporary);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Lets errors name `path` instead of the file that was opened, for a temporary copy of the file at `path`.
  void show_as(const std::filesystem::path& path) { path_ = path; }

  /// The first 100 bytes of the file, or fewer if the file is shorter. Called before any other function of
  /// the connection, it neither reads nor changes the file's log or journal.
  std::string header();
  /// False if reading needs files beside the database that SQLite may not write; true in all other cases,
  /// even if the file is damaged.
  bool can_read();
  /// keep true: the write-ahead log stays beside the file, and none of its pages is copied into the file.
  /// Default: false.
  void keep_log(bool keep);
  /// Treats the file as untrusted until recognise(): forbids statements that change rows or the schema, and
  /// runs no view or trigger of the file. With Work::OfASchema, statements fail with a base::Error once all
  /// statements since this call together have exceeded the limit.
  void distrust(Work limit = Work::OfASchema);
  /// Ends distrust(). Call it once the file is known to have the schema of vip-study.
  void recognise();
  /// From now on forbids creating, altering or dropping tables, indices, views and triggers of the file, and
  /// attaching other files. Rows can still be changed, and temporary tables can still be made.
  void seal();
  /// Makes each later Transaction that changes rows also write the first page, which identifies the database
  /// (foreign_log.hpp).
  void mark_commits() { marked_ = true; }
  /// Limits the file to this many pages.
  void limit_pages(std::int64_t pages);
  /// Waits for a lock as long as `waiting` returns true. Without `waiting` (the default), waits five seconds.
  void wait_with(Waiting waiting);
  /// Sets the end of error messages: what the user should do once the fault is fixed. Default: "give the
  /// command again".
  void go_on_with(const std::string& words) { go_on_ = words; }
  /// Watches a file in WAL mode from now on. Each commit, each failed statement and the destructor check
  /// whether another program has deleted, replaced or overwritten the file or removed its log. If so, the
  /// connection saves its content as "<file>.rescued-<UTC time>.db" and removes the log; if saving fails, it
  /// renames the log to "<file>.rescued-<UTC time>.wal". The statement or commit then throws a base::Error
  /// (the destructor prints it), each later Transaction throws it again, and nothing more is written to the
  /// file.
  void watch();
  /// Ends watch(). Call it before leaving WAL mode: SQLite then removes the log, which watch() would report.
  void unwatch();

  /// Runs statements without result rows.
  void execute(const std::string& sql);
  /// base::Error unless all pages, rows and indices are valid. Reads the whole file.
  void check_integrity();
  /// Replaces the content of this database by the content of `other`, in one transaction. A database in WAL
  /// mode cannot change its page size. If this database is in WAL mode and the page sizes differ, copy_from()
  /// rewrites `other` with the page size of this database, so `other` must then be a temporary database.
  /// copy_from() calls `complete` once this database is locked against other writers, before the copy.
  /// `complete` may change `other`, and may read the old content through another connection.
  void copy_from(Connection& other, const std::function<void()>& complete = {});
  /// The first column of the query's first row; 0 (integer) or an empty text (text) if there is no row.
  std::int64_t integer(const std::string& sql);
  std::string text(const std::string& sql);
  std::int64_t last_row_id() const;
  /// True between the start of a transaction and its end.
  bool in_transaction() const;
  sqlite3* handle() const { return handle_; }
  /// Throws a base::Error if SQLite's result `code` is an error.
  void check(int code);

 private:
  friend class Transaction;
  void protect();
  static int authorise(void* connection, int action, const char* first, const char* second,
                       const char* schema, const char* inner);
  static int grow_tired(void* connection);
  bool allows(int action, const char* first, const char* second, const char* schema, const char* inner) const;
  static int wait(void* connection, int tries);
  [[noreturn]] void fail(int code, const std::string& message, int system_error) const;
  void begin();
  void commit();
  [[noreturn]] void abandon(const std::string& trouble);
  void save_as(const std::filesystem::path& path);

  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
  Waiting waiting_;
  std::int64_t wait_began_ns_ = 0, told_ns_ = 0;
  bool limited_ = false, marked_ = false;
  enum class Trust { Free, Unknown, Sealed };
  Trust trust_ = Trust::Free;
  int work_ = 0;                     ///< calls of SQLite's progress handler since distrust()
  std::int64_t changes_before_ = 0;  ///< rows that the connection had changed before the open transaction
  std::string go_on_ = "give the command again";
  std::unique_ptr<FileWatch> watch_;
  struct Lost {
    std::string problem, mend;
  };
  std::optional<Lost> lost_;  ///< set once another program changed the file: nothing more is written
  /// locked by each Transaction; recursive, because a thread may begin a Transaction while its last
  /// Transaction, already committed, still exists
  std::recursive_mutex turn_;
};

/// A value of SQLite's type BLOB: bytes that are not text.
struct Blob {
  std::string_view bytes;
};

/// A prepared statement. To run it, call bind_all(), then step() until it returns false. Parameter and column
/// indices count from 0.
class Statement {
 public:
  Statement(Connection& connection, std::string_view sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Binds one value to each parameter, in order. Values are integers of 32 or 64 bits, doubles, texts,
  /// blobs, std::nullopt for NULL, or optionals of these. std::logic_error if the number of values differs
  /// from the number of parameters.
  template <class... Values>
  Statement& bind_all(const Values&... values) {
    expect_parameters(sizeof...(values));
    int index = 0;
    (bind_at(index++, values), ...);
    return *this;
  }

  /// Binds one value to the parameter `index`, for statements that are built at run time.
  Statement& bind_at(int index, std::int64_t value);
  Statement& bind_at(int index, int value) { return bind_at(index, static_cast<std::int64_t>(value)); }
  /// Binds a double; NaN is stored as NULL.
  Statement& bind_at(int index, double value);
  Statement& bind_at(int index, std::string_view value);
  Statement& bind_at(int index, const std::string& value) { return bind_at(index, std::string_view(value)); }
  Statement& bind_at(int index, const char* value) { return bind_at(index, std::string_view(value)); }
  Statement& bind_at(int index, Blob value);
  Statement& bind_at(int index, std::nullopt_t);
  /// Binds a column of another statement's row.
  Statement& bind_from(int index, const Statement& row, int column);
  template <class Value>
  Statement& bind_at(int index, const std::optional<Value>& value) {
    return value ? bind_at(index, *value) : bind_at(index, std::nullopt);
  }

  /// Fetches the next row of the result. Returns true if there is one. After the last row the statement is
  /// reset, but its bound values remain.
  bool step();
  /// Runs the statement to its end. Returns the row number of the connection's last INSERT.
  std::int64_t run();
  void reset();

  int columns() const;
  std::string column_name(int index) const;
  bool is_null(int index) const;
  bool is_real(int index) const;
  bool is_text(int index) const;
  std::int64_t integer(int index) const;
  double real(int index) const;
  std::string text(int index) const;
  std::string blob(int index) const;

 private:
  void expect_parameters(std::size_t given) const;

  Connection* connection_;
  sqlite3_stmt* handle_ = nullptr;
};

/// A transaction that takes the database's write lock at its start and rolls back unless committed. Its
/// constructor waits until no other thread has a Transaction on the same connection.
class Transaction {
 public:
  explicit Transaction(Connection& connection);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Connection* connection_;
  std::lock_guard<std::recursive_mutex> turn_;
  bool open_ = true;
};

}  // namespace study::sqlite
