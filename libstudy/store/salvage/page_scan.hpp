#pragma once
/// Reads rows from the pages of a damaged SQLite database without using its schema, its B-trees or SQLite.
/// Each page with rows is read independently, and a row is assigned to the first table whose columns it fits.
/// The command .recover of the `sqlite3` program is not used, because it needs the virtual table
/// sqlite_dbpage, which Debian's SQLite library lacks.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study::salvaging {

/// A value of SQLite's type NULL, INTEGER, REAL or TEXT.
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
  bool row_numbers = true;     ///< false: the table is WITHOUT ROWID
  int row_number_column = -1;  ///< index of the column that is the row number; -1: none
};

/// The shapes of all tables of a database.
std::vector<Shape> shapes_of(sqlite::Connection& database);

/// Calls `take` for each row of one of the `shapes` found in the file and in the committed part of its log
/// "<file>-wal"; skips free pages. use_log false: ignores the log. The rows of a table come in no particular
/// order, and a row may come twice. A missing file has no rows. Changes no file. base::Error if the file
/// cannot be read.
void scan_pages(const std::filesystem::path& file, const std::vector<Shape>& shapes,
                const std::function<void(const Shape&, Values)>& take, bool use_log = true);

}  // namespace study::salvaging
