#pragma once
/// Converts database rows to lines of the journal of answers, and lines to rows.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study::journal {

/// A table whose rows the journal records.
struct Table {
  const char* name;
  std::vector<std::string> key;  ///< columns that identify a row
  bool answers = true;           ///< true: a row must be on disk in the journal before its commit
  const char* context = "";      ///< SQL: readable columns, such as the participant, that a line adds in "of"
  const char* joins = "";        ///< SQL: joins to the tables with the columns in `context`
};

/// All tables that the journal records, parents first. It omits frames, headset slots, head poses, gaze, gaze
/// validations, exports, chores and reserved slots. Only a withdrawal or a merge deletes rows of the recorded
/// tables.
std::span<const Table> tables();
/// Returns the recorded table with this name, or null if the journal does not record the table.
const Table* find_table(const std::string& name);

/// A database row as a journal line: a JSON object, {"table": name, column: value, ..., "of": {participant,
/// session, trial, unit, block, question}}. "of" has only the columns of Table::context. Equal rows make
/// equal lines.
struct Row {
  const Table* table = nullptr;
  std::string key;  ///< values of the table's key columns as text, unique in the table
  std::string line;
};

/// Calls `take` for each row of a table in the database, ordered by key.
void each_row(sqlite::Connection& database, const Table& table, const std::function<void(Row)>& take);
/// Calls `take` for the rows with these row numbers (SQLite's rowid); skips missing rows. For a table WITHOUT
/// ROWID, `row_ids` must be empty.
void each_row(sqlite::Connection& database, const Table& table, std::span<const std::int64_t> row_ids,
              const std::function<void(Row)>& take);
/// Calls `take` for each row of one protocol. `table`: question, ask or cell.
void each_row_of_protocol(sqlite::Connection& database, const Table& table, std::int64_t protocol_id,
                          const std::function<void(Row)>& take);
/// The current database row with the table and key of `row`; none if the database lacks it.
std::optional<Row> stands_as(sqlite::Connection& database, const Row& row);

/// Deepest nesting of JSON in a journal line; a line with deeper JSON is not a journal line.
inline constexpr int most_levels = 8;

/// Parses a journal line; none if it is not a row of a recorded table with all key columns.
std::optional<Row> read_row(const std::string& line);
/// The value of a column as text; empty for NULL and for a missing column.
std::string column(const Row& row, const std::string& name);

enum class Put { Insert, Replace };
/// Writes a row into the database. Returns false if a value does not fit its column or the row violates a
/// constraint, e.g. because its parent row is missing. With Put::Insert, also returns false if a row with the
/// same key exists.
bool put(sqlite::Connection& database, const Row& row, Put how);

}  // namespace study::journal
