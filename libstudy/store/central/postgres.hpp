#pragma once
/// RAII wrappers for the parts of libpq that the store uses, for the central database of a lab (PostgreSQL).
/// Each failure becomes a pg::Failure, which names the service and the message of the server.
///
/// A connection is named by a service, a section of libpq's service file (~/.pg_service.conf, or the file
/// that PGSERVICEFILE names). That section holds host, database, role and TLS options; the password stands in
/// libpq's password file. So no secret stands on a command line.
///
///   pg::Connection central("lab");
///   pg::Transaction transaction(central);
///   central.run("INSERT INTO vip.note (words) VALUES ($1)", {"hello"});
///   transaction.commit();

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stats/base/error.hpp"

namespace study::pg {

/// A value in PostgreSQL's text form; none: NULL.
using Field = std::optional<std::string>;
using Row = std::vector<Field>;

/// The text form of a number; a double keeps all its bits.
std::string text_of(std::int64_t value);
std::string text_of(double value);

/// `row` as a line of COPY's text format, at the end of `out`: a text for digests that no other row gives.
void append_line(const Row& row, std::string& out);

/// One column of rows as the text of an array, for a parameter such as $1::text[].
std::string array_of(const std::vector<Row>& rows, std::size_t column);

/// A column of Connection::insert().
struct ColumnType {
  std::string name, type;
};

/// Why a statement or a connection failed.
class Failure : public base::Error {
 public:
  Failure(const std::string& service, const std::string& problem, const std::string& mend,
          std::string sqlstate, bool lost)
      : Error("service " + service, problem, mend), sqlstate_(std::move(sqlstate)), lost_(lost) {}
  /// PostgreSQL's five characters, such as 23505 for a row that stands there already; empty: no answer came.
  const std::string& sqlstate() const { return sqlstate_; }
  /// True if the connection ended or could not be made: the same command can succeed later.
  bool lost() const { return lost_; }

 private:
  std::string sqlstate_;
  bool lost_;
};

/// base::Error unless `service` is a plain name of letters, digits, ".", "_" and "-". Refuses connection
/// strings and addresses, because they can contain passwords, which other users of the computer would see.
void check_service_name(const std::string& service);

/// The rows that a statement gives. Rows and columns count from 0.
class Rows {
 public:
  int size() const { return static_cast<int>(rows_.size()); }
  const Field& at(int row, int column) const;
  /// The value of a column that is never NULL: std::logic_error if it is.
  const std::string& text(int row, int column) const;
  std::int64_t integer(int row, int column) const;
  /// Number of rows that an INSERT, UPDATE or DELETE changed.
  std::int64_t changed() const { return changed_; }

 private:
  friend class Connection;
  std::vector<Row> rows_;
  std::int64_t changed_ = 0;
};

/// A connection to the database of a service. One thread uses it at a time.
class Connection {
 public:
  /// Connects within the connect_timeout of service or environment; default: 10 s. If the network is cut
  /// later, a waiting statement fails after about 30 s, unless service or environment say otherwise
  /// (tcp_user_timeout, keepalives_idle). Failure if no connection is made.
  explicit Connection(const std::string& service);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const std::string& service() const { return service_; }
  /// Runs one statement with the parameters $1, $2, ...
  Rows run(const std::string& sql, const std::vector<Field>& values = {});
  /// Runs several statements without parameters, in one transaction unless they hold BEGIN or COMMIT.
  void script(const std::string& sql);
  /// Inserts rows in one statement, a row's values in the order of `columns`. `table` stands in the SQL as it
  /// is; tail: SQL after the rows, such as ON CONFLICT DO NOTHING. Returns the number of rows inserted. Rows
  /// travel as one array for each column, because COPY does not serve tables with row level security.
  std::int64_t insert(const std::string& table, const std::vector<ColumnType>& columns,
                      const std::vector<Row>& rows, const std::string& tail = "");
  /// Runs "COPY ... TO STDOUT": calls `take` for each row. If `take` throws, the connection ends.
  void copy_out(const std::string& sql, const std::function<void(const Row&)>& take);
  /// Asks the server to end the statement that another thread waits for, which then fails with sqlstate
  /// 57014. The only function that another thread may call.
  void cancel() const;
  /// Bytes of values that run() and insert() sent since the connection was made.
  std::int64_t bytes_sent() const { return bytes_sent_; }

 private:
  struct Link;
  struct Answer;
  [[noreturn]] void fail() const;
  Answer check(Answer answer) const;

  std::string service_;
  std::unique_ptr<Link> link_;
  std::int64_t bytes_sent_ = 0;
};

/// A transaction that rolls back unless committed.
class Transaction {
 public:
  explicit Transaction(Connection& connection, const std::string& begin = "BEGIN");
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Connection* connection_;
  bool open_ = true;
};

/// `name` as an SQL name, and `text` as an SQL literal, for statements that take no parameters.
std::string quoted_name(const std::string& name);
std::string quoted_text(const std::string& text);

}  // namespace study::pg
