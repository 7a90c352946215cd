#pragma once
/// Reads rows from the pages of a damaged database without its schema, its trees and SQLite: every leaf page
/// is read on its own, and a row is assigned to the table whose columns it fits. (The `sqlite3` program's
/// .recover needs a table, sqlite_dbpage, that Debian's library is built without.)

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study::salvaging {

/// NULL, INTEGER, REAL or TEXT.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;
using Values = std::vector<Value>;

/// The layout of a table's rows on a page.
struct Shape {
  struct Column {
    std::string name;
    std::string type;  ///< INTEGER, REAL or TEXT
    bool may_be_null = true;
  };
  std::string table;
  std::vector<Column> columns;
  bool row_numbers = true;     ///< false: WITHOUT ROWID
  int row_number_column = -1;  ///< column that is the row number; -1: none
};

/// The shapes of all tables of a database.
std::vector<Shape> shapes_of(sqlite::Connection& database);

/// Calls `take` for each row found in the file and in the committed part of its log "<file>-wal"; skips the
/// pages of the free list. `use_log` false: ignores that log. Rows of one table come in no particular order,
/// some perhaps twice. A missing file has no rows. Changes nothing. base::Error if the file cannot be read.
void scan_pages(const std::filesystem::path& file, const std::vector<Shape>& shapes,
                const std::function<void(const Shape&, Values)>& take, bool use_log = true);

}  // namespace study::salvaging
