#pragma once
/// Compares the schema of this program's steps with that of a file. Anyone who can write a database can add
/// views, triggers and columns, which would run or be copied as if they were ours.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The database has other tables, columns, indexes, views or triggers than its version of the schema.
class ForeignSchema : public base::Error {
  using Error::Error;
};

/// A table, index, view or trigger: its table, and its SQL without comments and line breaks.
struct SchemaObject {
  std::string table, sql;
  bool operator==(const SchemaObject&) const = default;
};
/// By type ("table", "index", "view", "trigger") and name.
using Schema = std::map<std::pair<std::string, std::string>, SchemaObject>;

/// The SQL with each comment and run of white space outside quotes replaced by one space: two versions of a
/// step may differ in comments.
std::string without_comments(const std::string& sql);

/// The schema of a database.
Schema schema_of(sqlite::Connection& database);

/// Throws ForeignSchema with the first difference unless the database has exactly the schema of the first
/// `version` of `steps`.
void check_schema(sqlite::Connection& database, const SchemaSteps& steps, std::int64_t version);

/// Columns of a table of the newest schema, in order.
const std::vector<std::string>& columns_of(const std::string& table);

/// The names as an SQL list, each quoted and with `prefix`, e.g. "x." for table x: SQLite reads an unprefixed
/// quoted name as a string if there is no such column.
std::string listed(const std::vector<std::string>& columns, const std::string& prefix = "");

/// A temporary database of schema `version` with the rows of `foreign` in tables and columns of the same
/// names. Lists all other parts of `foreign` in `left_out`. base::Error if a table or a column is missing, or
/// a row does not fit.
std::unique_ptr<sqlite::Connection> without_foreign_parts(sqlite::Connection& foreign,
                                                          const SchemaSteps& steps, std::int64_t version,
                                                          std::vector<std::string>& left_out);

/// A printable form of a name from a file: at most 60 ASCII letters, digits and signs.
std::string printable(const std::string& name);

}  // namespace study
