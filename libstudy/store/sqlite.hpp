#pragma once
/// The few things of SQLite that the store uses, with owners for its handles. Every failure is a base::Error
/// that names the database file.

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace study::sqlite {

/// How a database is opened.
enum class Open {
  Create,    ///< for writing; made when missing
  Write,     ///< for writing; must exist
  Read,      ///< must exist; nothing that it holds can be changed
  Untouched  ///< a look at the file alone: no lock, no log is read or replayed, nothing beside it is made
};

/// Chooses a database without a name: in memory, on the disk where it is large, gone with its connection.
struct Temporary {};

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
  /// Runs statements that give no rows.
  void execute(const std::string& sql);
  /// Takes over all that stands in another database, in one transaction; what stood here is gone.
  void copy_from(Connection& other);
  /// First column of the first row; 0 when there is no row.
  std::int64_t integer(const std::string& sql);
  std::string text(const std::string& sql);
  std::int64_t last_row_id() const;
  /// True between the start of a transaction and its end.
  bool in_transaction() const;
  sqlite3* handle() const { return handle_; }
  /// Throws what `code` of SQLite means for this file; returns when it is none.
  void check(int code) const;

 private:
  void protect();

  friend class Transaction;

  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
  std::recursive_mutex turn_;  ///< of transactions; one that is over may still stand above the next
};

/// A prepared statement: bind all, step, reset. Indices count from 0.
class Statement {
 public:
  Statement(Connection& connection, std::string_view sql);
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, int value) { return bind(index, static_cast<std::int64_t>(value)); }
  /// Not a number becomes NULL.
  Statement& bind(int index, double value);
  Statement& bind(int index, std::string_view value);
  Statement& bind(int index, const std::string& value) { return bind(index, std::string_view(value)); }
  Statement& bind(int index, const char* value) { return bind(index, std::string_view(value)); }
  Statement& bind_null(int index);
  /// The value of a column of another statement's row.
  Statement& bind_from(int index, const Statement& row, int column);
  template <class Value>
  Statement& bind(int index, const std::optional<Value>& value) {
    return value ? bind(index, *value) : bind_null(index);
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

 private:
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
