#pragma once
/// Rows of the database as lines of the journal of answers, and back.

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
  bool answers = true;           ///< a change must be on disk before its commit
  const char* context = "";      ///< readable columns that say what a row belongs to ...
  const char* joins = "";        ///< ... and the joins to their tables
};

/// All journalled tables, parents first: all but frames, slots, gaze, exports and chores. Only withdrawals
/// delete rows of these tables.
std::span<const Table> tables();
/// Returns the journalled table with this name, or null if the journal leaves the table out.
const Table* find_table(const std::string& name);

/// A row in the journal: a JSON object on one line, {"table": name, column: value, ..., "of": {participant,
/// session, trial, unit, block, question}}; "of" has what the table's `context` selects. Equal rows make
/// equal lines.
struct Row {
  const Table* table = nullptr;
  std::string key;  ///< of this row, unique in its table
  std::string line;
};

/// Calls `take` for each row of a table in the database, ordered by key.
void each_row(sqlite::Connection& database, const Table& table, const std::function<void(Row)>& take);
/// The same for some rows; missing ones are skipped. No rows for tables without row numbers.
void each_row(sqlite::Connection& database, const Table& table, std::span<const std::int64_t> row_ids,
              const std::function<void(Row)>& take);
/// The same for the rows of a protocol in question, ask or cell.
void each_row_of_protocol(sqlite::Connection& database, const Table& table, std::int64_t protocol_id,
                          const std::function<void(Row)>& take);
/// The row as the database has it now; none if it is missing.
std::optional<Row> stands_as(sqlite::Connection& database, const Row& row);

/// Maximum nesting of JSON in a line; a deeper line is not a journal line.
inline constexpr int most_levels = 8;

/// Parses a line; none if it is not a row of a journalled table.
std::optional<Row> read_row(const std::string& line);
/// The value of a column as text; empty for NULL and for a missing column.
std::string column(const Row& row, const std::string& name);

enum class Put { Insert, Replace };
/// Writes a row into the database. False if a row with that key or a conflicting row exists (Insert), or if a
/// value does not fit its column.
bool put(sqlite::Connection& database, const Row& row, Put how);

}  // namespace study::journal
