#pragma once
/// RAII wrappers for the parts of SQLite that the store uses. Every failure is a base::Error that names the
/// database file.
///
/// While a connection is open, nothing else in this process may open and close the file: that would release
/// SQLite's locks on it.

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
  Read     ///< must exist; its content cannot be changed
};

/// Selects a database without a name: in memory, or on disk if large, deleted with its connection.
struct Temporary {};

/// Limit on the work with an untrusted file.
enum class Work { OfASchema, Any };

/// Called about once a second while another program holds a lock that is needed; `holder` names it, e.g.
/// "sqlitebrowser (process 4711)". False: waits no longer, the statement fails.
using Waiting = std::function<bool(const std::string& holder)>;

/// Another program kept the database locked for longer than the wait.
class LockedOut : public base::Error {
  using Error::Error;
};

/// The remedy for a file that SQLite cannot recover.
std::string salvage_mend(const std::filesystem::path& path);

/// One connection. Two threads may share it if each works only within Transactions, which take turns.
class Connection {
 public:
  Connection(const std::filesystem::path& path, Open how);
  /// An empty database; messages name `shown`.
  Connection(const std::filesystem::path& shown, Temporary);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// The first 100 bytes of the file, or fewer if it is shorter. As the first call, it neither uses nor
  /// changes the file's log or journal.
  std::string header();
  /// True if SQLite can read the file in place; false if it would have to write beside it and may not.
  bool can_read();
  /// If `keep`, the log stays unchanged beside the file: none of its pages is copied into the file. Default:
  /// false.
  void keep_log(bool keep);
  /// Treats the file as untrusted: until recognise() nothing can be changed and none of its views and
  /// triggers run. With Work::OfASchema, work that takes longer than reading a schema ends with a
  /// base::Error.
  void distrust(Work limit = Work::OfASchema);
  /// Trusts the file: its schema is ours.
  void recognise();
  /// From now on the file's tables, views and triggers cannot be changed and no other file can be attached.
  void seal();
  /// From now on each commit that changes rows writes the page that identifies the database
  /// (foreign_log.hpp).
  void mark_commits() { marked_ = true; }
  /// Limits the file to this many pages.
  void limit_pages(std::int64_t pages);
  /// Waits for locks as long as `waiting` returns true, instead of five seconds.
  void wait_with(Waiting waiting);
  /// Sets what the user should do after fixing a fault, for messages. Default: "give the command again".
  void go_on_with(const std::string& words) { go_on_ = words; }
  /// In WAL mode: from now on detects that the file was deleted, replaced or overwritten, and copies no
  /// commit into it. Then saves this connection's content as "<file>.rescued-<UTC time>.db" and removes the
  /// log from beside the path; that commit and all later ones throw a base::Error.
  void watch();
  /// Ends watch(). Call it before leaving WAL mode, which may remove only part of the log's files.
  void unwatch();

  /// Runs statements without result rows.
  void execute(const std::string& sql);
  /// base::Error unless all pages, rows and indices are valid. Reads the whole file.
  void check_integrity();
  /// Replaces the content by that of another database in one transaction. WAL mode fixes the page size: if it
  /// differs, `other` is rewritten and must be a temporary database. `complete` is called once no other
  /// program can write here; it may change `other` and may read the old content through another connection.
  void copy_from(Connection& other, const std::function<void()>& complete = {});
  /// First column of the first row; 0 when there is no row.
  std::int64_t integer(const std::string& sql);
  std::string text(const std::string& sql);
  std::int64_t last_row_id() const;
  /// True between the start of a transaction and its end.
  bool in_transaction() const;
  sqlite3* handle() const { return handle_; }
  /// Throws the error for SQLite's `code` on this file; returns if it is no error.
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
  int work_ = 0;                     ///< work since distrust(), in steps of the progress handler
  std::int64_t changes_before_ = 0;  ///< rows changed when the open transaction began
  std::string go_on_ = "give the command again";
  std::unique_ptr<FileWatch> watch_;
  struct Lost {
    std::string problem, mend;
  };
  std::optional<Lost> lost_;   ///< set: nothing more is written
  std::recursive_mutex turn_;  ///< of transactions; one that is over may outlive the next one's start
};

/// Bytes that are not text.
struct Blob {
  std::string_view bytes;
};

/// A prepared statement: bind_all, step, reset. Indices count from 0.
class Statement {
 public:
  Statement(Connection& connection, std::string_view sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// A value for each parameter, in their order: whole numbers of 32 or 64 bits, real ones, texts, blobs,
  /// std::nullopt for NULL, and optionals of these. std::logic_error unless there are as many as parameters.
  template <class... Values>
  Statement& bind_all(const Values&... values) {
    expect_parameters(sizeof...(values));
    int index = 0;
    (bind_at(index++, values), ...);
    return *this;
  }

  /// One value alone, for statements that are built at run time.
  Statement& bind_at(int index, std::int64_t value);
  Statement& bind_at(int index, int value) { return bind_at(index, static_cast<std::int64_t>(value)); }
  /// NaN becomes NULL.
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

  /// True if there is a row. After the last row the statement is reset; its bound values remain.
  bool step();
  /// Runs a statement without rows and returns the new row's id.
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

/// A transaction that takes the write lock at once and rolls back unless committed. It waits for another
/// thread's transaction on the same connection.
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
