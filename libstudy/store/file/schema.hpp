#pragma once
/// Compares the schema of a database file with the schema that this program makes. Anyone who can write a
/// database can add views, triggers and columns to it. Without this check the program would run or copy them
/// as if it had made them.

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
/// All objects of a schema, by type ("table", "index", "view" or "trigger") and name.
using Schema = std::map<std::pair<std::string, std::string>, SchemaObject>;

/// The SQL with each comment, and each run of white space outside quotes, replaced by one space. So schemas
/// compare as equal if only their comments differ.
std::string without_comments(const std::string& sql);

/// The schema of a database. ForeignSchema if it lists an object twice, or more than 2000 objects.
Schema schema_of(sqlite::Connection& database);

/// Throws ForeignSchema with the first difference unless the database has exactly the schema that the first
/// `version` steps make.
void check_schema(sqlite::Connection& database, const SchemaSteps& steps, std::int64_t version);

/// Columns of a table of the newest schema, in order.
const std::vector<std::string>& columns_of(const std::string& table);

/// The column names as an SQL list, each quoted and after `prefix`, e.g. "x." for table x. The prefix is
/// needed because SQLite reads a quoted name without one as a string if no column has this name.
std::string listed(const std::vector<std::string>& columns, const std::string& prefix = "");

/// Copies the parts of `foreign` that vip-study knows into a temporary database of schema `version`: the rows
/// of tables and columns with the same names. Lists all other parts of `foreign` in `left_out`. base::Error
/// if `foreign` lacks a table or a column, or if a row does not fit the schema.
std::unique_ptr<sqlite::Connection> without_foreign_parts(sqlite::Connection& foreign,
                                                          const SchemaSteps& steps, std::int64_t version,
                                                          std::vector<std::string>& left_out);

/// A name from a file in printable form: its first 60 bytes, with "?" for each apostrophe, control character
/// and non-ASCII byte, and "..." if the name is longer.
std::string printable(const std::string& name);

}  // namespace study
