#pragma once
/// The few things of SQLite that the store uses, with owners for its handles. Every failure is a base::Error
/// that names the database file.
///
/// While a connection is open, nothing else in this process may open and close the file: that would take away
/// the locks which SQLite holds on it.

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
  Create,  ///< for writing; made when missing, for its owner only
  Write,   ///< for writing; must exist
  Read     ///< must exist; nothing that it holds can be changed
};

/// Chooses a database without a name: in memory, on the disk where it is large, gone with its connection.
struct Temporary {};

/// How much may be done with a file that may be anybody's.
enum class Work { OfASchema, Any };

/// Called about once a second while another program holds a lock that is needed; `holder` names it, e.g.
/// "sqlitebrowser (process 4711)". False: waits no longer, the statement fails.
using Waiting = std::function<bool(const std::string& holder)>;

/// Another program kept the database locked for longer than was waited.
class LockedOut : public base::Error {
  using Error::Error;
};

/// What to do about a file that SQLite itself cannot make whole again.
std::string salvage_mend(const std::filesystem::path& path);

/// One connection. Two threads may share it where each keeps to Transactions, which take turns.
class Connection {
 public:
  Connection(const std::filesystem::path& path, Open how);
  /// Empty; messages name `shown`.
  Connection(const std::filesystem::path& shown, Temporary);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// The first 100 bytes, or as many as there are. Asked before anything else, nothing of the file, its log
  /// or its journal has been used or changed by then.
  std::string header();
  /// Whether SQLite can read it where it stands; not where it would have to write beside it and may not.
  bool can_read();
  /// Whether a log stays beside the file as it is, so that no page of it is copied into the file. At first:
  /// no.
  void keep_log(bool keep);
  /// The file may be anybody's: until recognise() nothing is changed, no view and no trigger of it is run,
  /// and with Work::OfASchema what takes longer than the reading of a schema is ended with a base::Error.
  void distrust(Work limit = Work::OfASchema);
  /// The schema is ours.
  void recognise();
  /// From now on tables, views and triggers of the file stay as they are, and no other file is attached.
  void seal();
  /// From now on each commit that changes rows says in its pages of which database it is (foreign_log.hpp).
  void mark_commits() { marked_ = true; }
  /// Lets the file grow to so many pages.
  void limit_pages(std::int64_t pages);
  /// Waits for locks as long as `waiting` says, and not for five seconds.
  void wait_with(Waiting waiting);
  /// What the user is to do once a fault is mended, for messages. At first: "give the command again".
  void go_on_with(const std::string& words) { go_on_ = words; }
  /// In WAL mode: from now on no commit is copied into a file that was deleted, replaced or written over.
  /// What stands in this connection is then saved as "<file>.rescued-<UTC time>.db", the log is taken away
  /// from beside the path, and that commit and all later ones are a base::Error.
  void watch();
  /// Ends it. Before the log is given up: a log that could be given up by half cannot be watched.
  void unwatch();

  /// Runs statements that give no rows.
  void execute(const std::string& sql);
  /// base::Error unless all pages, rows and indices are sound. Reads the whole file.
  void check_integrity();
  /// Takes over all that stands in another database, in one transaction; what stood here is gone. A log fixes
  /// the size of pages: where it differs, `other` is written anew, and must be a temporary one. `complete` is
  /// called once nobody else can write here any more, and may change `other`; it reads what stood here
  /// through another connection.
  void copy_from(Connection& other, const std::function<void()>& complete = {});
  /// First column of the first row; 0 when there is no row.
  std::int64_t integer(const std::string& sql);
  std::string text(const std::string& sql);
  std::int64_t last_row_id() const;
  /// True between the start of a transaction and its end.
  bool in_transaction() const;
  sqlite3* handle() const { return handle_; }
  /// Throws what `code` of SQLite means for this file; returns when it is none.
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
  int work_ = 0;                     ///< done since distrust(), in steps of the progress handler
  std::int64_t changes_before_ = 0;  ///< rows changed when the open transaction began
  std::string go_on_ = "give the command again";
  std::unique_ptr<FileWatch> watch_;
  struct Lost {
    std::string problem, mend;
  };
  std::optional<Lost> lost_;   ///< nothing more is written
  std::recursive_mutex turn_;  ///< of transactions; one that is over may still stand above the next
};

/// Bytes that are no text.
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

  /// One value alone, where the statement is not known beforehand.
  Statement& bind_at(int index, std::int64_t value);
  Statement& bind_at(int index, int value) { return bind_at(index, static_cast<std::int64_t>(value)); }
  /// Not a number becomes NULL.
  Statement& bind_at(int index, double value);
  Statement& bind_at(int index, std::string_view value);
  Statement& bind_at(int index, const std::string& value) { return bind_at(index, std::string_view(value)); }
  Statement& bind_at(int index, const char* value) { return bind_at(index, std::string_view(value)); }
  Statement& bind_at(int index, Blob value);
  Statement& bind_at(int index, std::nullopt_t);
  /// The value of a column of another statement's row.
  Statement& bind_from(int index, const Statement& row, int column);
  template <class Value>
  Statement& bind_at(int index, const std::optional<Value>& value) {
    return value ? bind_at(index, *value) : bind_at(index, std::nullopt);
  }

  /// True when there is a row. After the last one the statement is reset and its values are kept.
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

/// A transaction that takes the write lock at once and is undone unless committed. It waits for that of
/// another thread on the same connection.
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
