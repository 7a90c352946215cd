#pragma once
/// The schema that this program's steps make, compared with the one that stands in a file. Whoever can write
/// a database can also put views, triggers and columns into it, which would run or be copied as if they were
/// ours.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/database.hpp"
#include "libstudy/store/sqlite.hpp"

namespace study {

/// The database has other tables, columns, indexes, views or triggers than its version of the schema.
class ForeignSchema : public base::Error {
  using Error::Error;
};

/// A table, index, view or trigger: what it belongs to, and its SQL without comments and line breaks.
struct SchemaObject {
  std::string table, sql;
  bool operator==(const SchemaObject&) const = default;
};
/// By type ("table", "index", "view", "trigger") and name.
using Schema = std::map<std::pair<std::string, std::string>, SchemaObject>;

/// The SQL with each comment and each run of white space as one space, but for what stands in quotes: the
/// texts of two versions of a step may differ in comments.
std::string without_comments(const std::string& sql);

/// What stands in a database.
Schema schema_of(sqlite::Connection& database);

/// ForeignSchema, which names the first difference, unless the database has exactly what the first `version`
/// of `steps` make.
void check_schema(sqlite::Connection& database, const SchemaSteps& steps, std::int64_t version);

/// Columns of a table of the newest schema in their order, as the program's own steps make them.
const std::vector<std::string>& columns_of(const std::string& table);

/// The names as SQL lists them, each in quotes and behind `prefix`, as "x." for those of table x: SQLite
/// takes a bare name in quotes for a text where there is no such column.
std::string listed(const std::vector<std::string>& columns, const std::string& prefix = "");

/// A temporary database of the schema `version` with the rows of `foreign`: its tables of the same names and,
/// of these, the columns of the same names. What else stands there is left out, and is listed in `left_out`.
/// base::Error where a table or a column is missing, or a row does not fit.
std::unique_ptr<sqlite::Connection> without_foreign_parts(sqlite::Connection& foreign,
                                                          const SchemaSteps& steps, std::int64_t version,
                                                          std::vector<std::string>& left_out);

/// A name from a file as it may be printed: no more than 60 letters, digits and signs of ASCII.
std::string printable(const std::string& name);

}  // namespace study
