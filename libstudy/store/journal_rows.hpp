#pragma once
/// Rows of the database as lines of the journal of answers, and back.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study::journal {

/// A table that the journal follows.
struct Table {
  const char* name;
  std::vector<std::string> key;  ///< columns that tell its rows apart
  bool answers = true;           ///< a change of it counts: on the disk before its commit
  const char* context = "";      ///< columns that say in words what a row belongs to ...
  const char* joins = "";        ///< ... and the tables in which they stand
};

/// All that counts, parents first: everything but frames, gaze, exports and what is still to be cleaned up.
/// Rows of these tables are deleted by withdrawal alone.
std::span<const Table> tables();
/// Null: a table that is not followed.
const Table* find_table(const std::string& name);

/// A row as it stands in the journal: a JSON object of one line, {"table": name, column: value, ...,
/// "of": {participant, session, unit, block, question}}. Equal rows make equal lines.
struct Row {
  const Table* table = nullptr;
  std::string key;  ///< of this row among those of the table
  std::string line;
};

/// Rows of a table as they stand in the database, by their keys.
void each_row(sqlite::Connection& database, const Table& table, const std::function<void(Row)>& take);
/// The same for some rows; which are gone are left out. Tables without row numbers: none.
void each_row(sqlite::Connection& database, const Table& table, std::span<const std::int64_t> row_ids,
              const std::function<void(Row)>& take);
/// Rows of a table that belong to a protocol: question, ask, cell.
void each_row_of_protocol(sqlite::Connection& database, const Table& table, std::int64_t protocol_id,
                          const std::function<void(Row)>& take);
/// The row as the database has it now; none: it is not there.
std::optional<Row> stands_as(sqlite::Connection& database, const Row& row);

/// Levels of JSON in a line; a deeper one is none of a journal.
inline constexpr int most_levels = 8;

/// None: not a line of a row that this program follows.
std::optional<Row> read_row(const std::string& line);
/// The value of a column as text; empty for NULL and for a column that is not there.
std::string column(const Row& row, const std::string& name);

enum class Put { Insert, Replace };
/// Writes a row into the database. False: a row of that key, or one that excludes it, stands there (Insert),
/// or a value is not what the column takes.
bool put(sqlite::Connection& database, const Row& row, Put how);

}  // namespace study::journal
