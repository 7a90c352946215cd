#pragma once
/// Rows out of the pages of a damaged database, without its schema, its trees and SQLite: every leaf page is
/// read by itself, and a row belongs to the table whose columns it fits. (The `sqlite3` program's .recover
/// needs a table, sqlite_dbpage, that Debian's library is built without.)

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study::salvaging {

/// NULL, INTEGER, REAL or TEXT.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;
using Values = std::vector<Value>;

/// What the rows of a table look like on a page.
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

/// Of all tables of a database.
std::vector<Shape> shapes_of(sqlite::Connection& database);

/// Calls `take` for each row found in the file and in the committed part of its log "<file>-wal"; free pages
/// are left out as far as the first page tells which are. `use_log` false: without that log. Rows of one
/// table come in no order, some perhaps twice. A missing file has none. Nothing is changed. base::Error when
/// the file cannot be read.
void scan_pages(const std::filesystem::path& file, const std::vector<Shape>& shapes,
                const std::function<void(const Shape&, Values)>& take, bool use_log = true);

}  // namespace study::salvaging
