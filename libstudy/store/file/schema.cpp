#include "libstudy/store/file/schema.hpp"

#include <algorithm>
#include <mutex>

#include "stats/base/error.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr std::size_t longest_name = 60;
// Largest number of rows of sqlite_schema that are read; a crafted file may have more than any schema of
// vip-study.
constexpr std::size_t most_objects = 2000;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }

/// The position after a quoted text or name that begins at `at`.
std::size_t end_of_quoted(const std::string& sql, std::size_t at) {
  const char end = sql[at] == '[' ? ']' : sql[at];
  const std::size_t found = sql.find(end, at + 1);
  return found == std::string::npos ? sql.size() : found + 1;
}

/// The position after a comment that begins at `at`; `at` if there is none.
std::size_t end_of_comment(const std::string& sql, std::size_t at) {
  if (sql.compare(at, 2, "--") == 0) return std::min(sql.find('\n', at), sql.size());
  if (sql.compare(at, 2, "/*") != 0) return at;
  const std::size_t found = sql.find("*/", at + 2);
  return found == std::string::npos ? sql.size() : found + 2;
}

bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::string upper(std::string word) {
  for (char& c : word) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return word;
}

using Key = std::pair<std::string, std::string>;

[[noreturn]] void refuse_schema(const Connection& database, const std::string& problem,
                                const Key& extra = {}) {
  const std::string path = database.path().string();
  std::string mend =
      "make a database without this difference: vip-study salvage --db " + path + " --into NEW";
  // An index named sqlite_auto... belongs to a constraint: SQLite drops it only with its table.
  if (is_plain(extra.second) && !extra.second.starts_with("sqlite_auto")) {
    mend = "if you added it, copy the file and remove it: sqlite3 " + path + " 'DROP " + upper(extra.first) +
           " " + extra.second + "; VACUUM'; or " + mend;
  }
  throw ForeignSchema(path, problem, mend);
}

std::string article(const Key& key) { return key.first == "index" ? "an " : "a "; }

std::string named(const Key& key) { return printable(key.first) + " '" + printable(key.second) + "'"; }

std::vector<std::string> columns_in(Connection& database, const std::string& table) {
  std::vector<std::string> names;
  Statement row(database, "SELECT name FROM pragma_table_info(?)");
  for (row.bind_all(table); row.step();) names.push_back(row.text(0));
  return names;
}

SchemaSteps first_steps(const SchemaSteps& steps, std::int64_t version) {
  return {steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(version)};
}

/// The schema that these steps make; computed once for each list of steps.
const Schema& schema_after(const SchemaSteps& steps) {
  static std::mutex turn;
  static std::map<SchemaSteps, Schema> known;
  const std::lock_guard guard(turn);
  const auto [made, fresh] = known.try_emplace(steps);
  if (fresh) made->second = schema_of(*make_temporary_database("the schema", steps));
  return made->second;
}

std::map<std::string, std::vector<std::string>> own_columns() {
  const auto database = make_temporary_database("the schema");
  std::map<std::string, std::vector<std::string>> columns;
  for (const auto& [key, object] : schema_of(*database)) {
    if (key.first == "table") columns[key.second] = columns_in(*database, key.second);
  }
  return columns;
}

}  // namespace

std::string printable(const std::string& name) {
  std::string out = name.substr(0, longest_name);
  for (char& c : out) c = c < ' ' || c > '~' || c == '\'' ? '?' : c;
  return name.size() > longest_name ? out + "..." : out;
}

std::string without_comments(const std::string& sql) {
  std::string out;
  for (std::size_t at = 0; at < sql.size();) {
    std::size_t end = end_of_comment(sql, at);
    if (end > at || is_space(sql[at])) {
      if (!out.empty() && out.back() != ' ') out += ' ';
      at = end > at ? end : at + 1;
      continue;
    }
    const bool quoted = sql[at] == '\'' || sql[at] == '"' || sql[at] == '`' || sql[at] == '[';
    end = quoted ? end_of_quoted(sql, at) : at + 1;
    out.append(sql, at, end - at);
    at = end;
  }
  return out;
}

Schema schema_of(Connection& database) {
  Schema schema;
  Statement row(database, "SELECT type, name, tbl_name, sql FROM main.sqlite_schema");
  while (row.step()) {
    const Key key{row.text(0), row.text(1)};
    const SchemaObject object{row.text(2), without_comments(row.text(3))};
    if (!schema.emplace(key, object).second) refuse_schema(database, "lists the " + named(key) + " twice");
    if (schema.size() > most_objects)
      refuse_schema(database, "lists thousands of tables, indexes, views or triggers");
  }
  return schema;
}

void check_schema(Connection& database, const SchemaSteps& steps, std::int64_t version) {
  const Schema found = schema_of(database);
  const Schema& wanted = schema_after(first_steps(steps, version));
  if (found == wanted) return;
  for (const auto& [key, object] : found) {
    if (!wanted.contains(key))
      refuse_schema(database, "has " + article(key) + named(key) + " that vip-study did not make", key);
  }
  for (const auto& [key, object] : wanted) {
    const auto there = found.find(key);
    if (there == found.end()) refuse_schema(database, "lacks the " + named(key) + " of its schema");
    if (there->second != object)
      refuse_schema(database, "has the " + named(key) + " otherwise than vip-study made it");
  }
}

const std::vector<std::string>& columns_of(const std::string& table) {
  static const auto columns = own_columns();
  return columns.at(table);
}

std::string listed(const std::vector<std::string>& columns, const std::string& prefix) {
  std::string list;
  for (const std::string& column : columns)
    list.append(list.empty() ? "" : ", ").append(prefix).append("\"").append(column).append("\"");
  return list;
}

std::unique_ptr<Connection> without_foreign_parts(Connection& foreign, const SchemaSteps& steps,
                                                  std::int64_t version, std::vector<std::string>& left_out) {
  const Schema found = schema_of(foreign);
  auto own = make_temporary_database(foreign.path(), first_steps(steps, version));
  const Schema& wanted = schema_after(first_steps(steps, version));
  own->execute("PRAGMA foreign_keys = OFF");
  for (const auto& [key, object] : found) {
    if (!wanted.contains(key)) left_out.push_back(named(key));
  }
  // Reads only ordinary tables, so that no view, trigger or virtual table of `foreign` runs.
  for (const auto& [key, object] : wanted) {
    if (key.first != "table") continue;
    const auto there = found.find(key);
    if (there == found.end() || !upper(there->second.sql).starts_with("CREATE TABLE"))
      refuse_schema(foreign, "lacks the " + named(key) + " of its schema");
    if (there->second != object) left_out.push_back("changes of the " + named(key));
    const auto columns = columns_in(*own, key.second);
    std::string places;
    for (std::size_t i = 0; i < columns.size(); ++i) places += i ? ", ?" : "?";
    Statement row(foreign, "SELECT " + listed(columns, "x.") + " FROM main." + key.second + " x");
    Statement insert(*own,
                     "INSERT INTO " + key.second + " (" + listed(columns) + ") VALUES (" + places + ")");
    while (row.step()) {
      for (int i = 0; i < row.columns(); ++i) insert.bind_from(i, row, i);
      insert.run();
    }
  }
  return own;
}

}  // namespace study
