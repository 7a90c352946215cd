#pragma once
/// The tables of the central database, derived from the schema of the stations' SQLite files, and the SQL
/// that makes them. So the numbered steps of the schema (libstudy/store/sql) define both.
///
/// Row numbers that differ between files become what is the same in every copy:
///
///   column of SQLite   is at the centre
///   session_id         session_uid: session.uid
///   run_id             run_uid: run.uid
///   protocol_id        protocol_sha256: protocol.sha256
///   question_id        protocol_sha256 and question_code: question.code
///
/// Each row below a session begins with session_uid; its other row numbers count from 1 in the session
/// (push/session_copy.hpp). Each table has the column `sender`: the role that sent the row. It is a part of
/// every key, so that a station can neither replace the rows of another nor add rows to its sessions.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace study::central {

/// Which rows of a file belong together.
enum class Scope {
  Session,   ///< rows of one session, and the row of the session itself
  Protocol,  ///< rows of one protocol, and the row of the protocol itself
  Run,       ///< commands that planned sessions
  Person     ///< rows about people: tombstones, labels of exports
};

/// A column of a table at the centre. `sender` has none of these.
struct Column {
  std::string name;  ///< at the centre
  std::string type;  ///< PostgreSQL's type
  bool not_null = false;
  std::string local;  ///< column of SQLite with the value, or with the row number of the row that has it
  /// SQL of SQLite for the value in a row x of the table; of session_uid: "?2", the caller's text
  std::string read;
};

/// A foreign key at the centre, without `sender`, which both sides have.
struct Reference {
  std::vector<std::string> columns;
  std::string table;
  std::vector<std::string> keys;
};

/// A table of the centre, with the SQLite table of the same name.
struct Table {
  std::string name;
  Scope scope = Scope::Session;
  /// True for tables whose rows are many for each presentation, such as frame: they are sent in parts.
  bool large = false;
  std::vector<Column> columns;
  std::vector<std::string> key;                   ///< columns of the primary key, without `sender`
  std::vector<std::vector<std::string>> uniques;  ///< further keys within a session, without `sender`
  std::vector<Reference> references;
  std::vector<std::string> checks;  ///< conditions in PostgreSQL's SQL
  /// SQL condition of SQLite on rows x of the table. Session: ?1 is a session_id; of large tables a
  /// presentation_id. Protocol: ?1 is a protocol_id. Run: ?1 is a run_id. Person: "1".
  std::string rows;
};

/// The tables of the centre for this program's schema, in the order of their names. base::Error if the schema
/// has something that has no counterpart yet: a table without a place (list it in central_schema.cpp), a
/// type, or an expression of a CHECK.
const std::vector<Table>& tables();
const Table& table(const std::string& name);
/// The same tables, each after those that it refers to.
std::vector<const Table*> in_order();

/// The schema number of this program, which the central database must have too.
std::int64_t schema_number();

/// The query of SQLite for the rows of a table (Table::rows), in the order of its columns and its key.
std::string select_sql(const Table& table);
/// The columns as an SQL list of quoted names.
std::string column_list(const Table& table);

/// A CHECK of SQLite as PostgreSQL's SQL. renamed: names at the centre of the table's columns, by their names
/// in SQLite. base::Error with `place` if the expression has something that the translation does not know.
std::string translated_check(const std::string& expression,
                             const std::vector<std::pair<std::string, std::string>>& renamed,
                             const std::string& place);

/// Names of the roles that own no rows but carry the rights: "<database>_station", "<database>_lab_reader"
/// and "<database>_shared_reader". Roles are common to all databases of a server, their names are not.
struct Groups {
  explicit Groups(const std::string& database);
  std::string station, lab_reader, shared_reader;
};

/// The statements that make the schemas vip, lab and shared of an empty database.
std::string make_sql(const Groups& groups);
/// The statements that make everything but tables again: CHECKs, functions, triggers, policies, rights and
/// views. They may run again; an upgrade does so after it added tables and columns.
std::string remake_sql(const Groups& groups);
/// CREATE TABLE with keys and references.
std::string table_sql(const Table& table);
/// The type of a column with NOT NULL where it has that.
std::string column_sql(const Column& column);

}  // namespace study::central
