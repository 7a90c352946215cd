#include "libstudy/store/central/central_schema.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "stats/base/error.hpp"

namespace study::central {

using sqlite::Connection;
using sqlite::Statement;

namespace {

// Tables that never leave a station: registers of its own exports, work that it has to do, slots that the
// centre reserved for it, and events without a session, which belong to no table here.
const std::set<std::string> local_tables{"export", "export_person", "chore", "reserved_slot"};
const std::map<std::string, Scope> roots{{"session", Scope::Session},
                                         {"protocol", Scope::Protocol},
                                         {"run", Scope::Run},
                                         {"tombstone", Scope::Person},
                                         {"label", Scope::Person}};

/// A table whose row numbers become a name that is the same in every copy.
struct Natural {
  std::string id;      ///< column with the row number, here and in tables that refer to it
  std::string column;  ///< column with the name
  std::string name;    ///< the name's column at the centre
};
const std::map<std::string, Natural> naturals{{"session", {"session_id", "uid", "session_uid"}},
                                              {"run", {"run_id", "uid", "run_uid"}},
                                              {"protocol", {"protocol_id", "sha256", "protocol_sha256"}},
                                              {"question", {"question_id", "code", "question_code"}}};

[[noreturn]] void refuse_central(const std::string& place, const std::string& problem) {
  throw base::Error(place, problem,
                    "say in libstudy/store/central/central_schema.cpp what becomes of it at the centre");
}

struct LocalColumn {
  std::string name, type;
  bool not_null = false;
  int key = 0;  ///< place in the primary key, from 1; 0: not in it
};
struct LocalTable {
  std::string name, sql;
  std::vector<LocalColumn> columns;
  std::map<std::string, std::string> parents;  ///< table that a column refers to, by column
  std::vector<std::vector<std::string>> uniques;
};
using LocalTables = std::map<std::string, LocalTable>;

LocalTable read_table(Connection& database, const std::string& name, const std::string& sql) {
  LocalTable table{name, sql, {}, {}, {}};
  Statement column(database, "SELECT name, type, \"notnull\", pk FROM pragma_table_info(?)");
  for (column.bind_all(name); column.step();) {
    const int key = static_cast<int>(column.integer(3));
    table.columns.push_back({column.text(0), column.text(1), column.integer(2) != 0 || key > 0, key});
  }
  Statement parent(database, "SELECT \"from\", \"table\" FROM pragma_foreign_key_list(?)");
  for (parent.bind_all(name); parent.step();) table.parents[parent.text(0)] = parent.text(1);
  Statement index(database, "SELECT name FROM pragma_index_list(?) WHERE origin = 'u' ORDER BY name");
  Statement part(database, "SELECT name FROM pragma_index_info(?) ORDER BY seqno");
  for (index.bind_all(name); index.step();) {
    auto& columns = table.uniques.emplace_back();
    for (part.bind_all(index.text(0)); part.step();) columns.push_back(part.text(0));
  }
  return table;
}

LocalTables read_tables() {
  const auto database = make_temporary_database("the schema");
  LocalTables found;
  for (const auto& [key, object] : schema_of(*database)) {
    if (key.first == "table" && !local_tables.contains(key.second))
      found.emplace(key.second, read_table(*database, key.second, object.sql));
  }
  return found;
}

Scope scope_of(const LocalTables& tables, const std::string& name) {
  if (const auto root = roots.find(name); root != roots.end()) return root->second;
  std::optional<Scope> found;
  for (const auto& [column, parent] : tables.at(name).parents) {
    const Scope scope = scope_of(tables, parent);
    if (!found || scope == Scope::Session) found = scope;
  }
  if (!found) refuse_central("table " + name, "belongs to no session, protocol or person");
  return *found;
}

std::string central_type(const std::string& place, const std::string& type) {
  static const std::map<std::string, std::string> types{
      {"INTEGER", "bigint"}, {"REAL", "double precision"}, {"TEXT", "text"}};
  const auto found = types.find(type);
  if (found == types.end()) refuse_central(place, "has the type " + type);
  return found->second;
}

class TableMaker {
 public:
  TableMaker(const LocalTables& tables, const std::string& name)
      : all_(tables), local_(tables.at(name)), scope_(scope_of(tables, name)) {}

  Table make() {
    table_.name = local_.name;
    table_.scope = scope_;
    table_.large = is_large(local_);
    if (scope_ == Scope::Session)
      add({"session_uid", "text", true, local_.name == "session" ? "uid" : "session_id", "?2"});
    for (const LocalColumn& column : local_.columns) add_column(column);
    add_keys();
    add_checks();
    table_.rows = table_.large ? "x.presentation_id = ?1" : rows_of(local_.name);
    return std::move(table_);
  }

 private:
  static bool is_large(const LocalTable& table) {
    const auto parent = table.parents.find("presentation_id");
    const auto keys = std::count_if(table.columns.begin(), table.columns.end(),
                                    [](const LocalColumn& column) { return column.key > 0; });
    return parent != table.parents.end() && table.columns.front().name == "presentation_id" &&
           table.columns.front().key == 1 && keys > 1;
  }

  void add(Column column) {
    const auto same = std::find_if(table_.columns.begin(), table_.columns.end(),
                                   [&](const Column& one) { return one.name == column.name; });
    if (column.name == "sender") refuse_central("table " + local_.name, "has a column sender");
    if (same == table_.columns.end()) table_.columns.push_back(std::move(column));
  }

  /// Adds the columns that stand for a column of SQLite, and notes their names.
  void add_column(const LocalColumn& column) {
    const std::string place = "column " + local_.name + "." + column.name;
    std::vector<std::string>& names = names_[column.name];
    const auto own = naturals.find(local_.name);
    const auto parent = local_.parents.find(column.name);
    const auto natural = parent == local_.parents.end() ? naturals.end() : naturals.find(parent->second);
    if (own != naturals.end() && column.name == own->second.id) {  // the natural name stands for it
      names = {own->second.name};
    } else if (own != naturals.end() && column.name == own->second.column) {
      names = {own->second.name};
      add({own->second.name, "text", true, column.name,
           local_.name == "session" ? "?2" : "x." + column.name});
    } else if (natural != naturals.end() && natural->first == "session") {
      names = {"session_uid"};
    } else if (natural != naturals.end()) {
      const Natural& name = natural->second;
      const std::string from = " FROM " + natural->first + " n";
      const std::string where = " WHERE n." + name.id + " = x." + column.name + ")";
      if (natural->first == "question") {
        names.emplace_back("protocol_sha256");
        add({"protocol_sha256", "text", column.not_null, column.name,
             "(SELECT p.sha256" + from + " JOIN protocol p USING (protocol_id)" + where});
      }
      names.push_back(name.name);
      add({name.name, "text", column.not_null, column.name, "(SELECT n." + name.column + from + where});
    } else {
      names = {column.name};
      add({column.name, central_type(place, column.type), column.not_null, column.name,
           "x.\"" + column.name + "\""});
    }
  }

  void append(std::vector<std::string>& list, const std::string& column) const {
    for (const std::string& name : names_.at(column)) {
      if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
    }
  }

  void add_keys() {
    if (scope_ == Scope::Session) table_.key = {"session_uid"};
    std::vector<LocalColumn> keys = local_.columns;
    std::erase_if(keys, [](const LocalColumn& column) { return column.key == 0; });
    std::sort(keys.begin(), keys.end(),
              [](const LocalColumn& a, const LocalColumn& b) { return a.key < b.key; });
    if (local_.name == "question") append(table_.key, "protocol_id");
    for (const LocalColumn& column : keys) append(table_.key, column.name);
    // What is unique in one file, such as a participant code, need not be so among all sessions.
    for (const auto& unique : scope_ == Scope::Session && local_.name != "session"
                                  ? local_.uniques
                                  : std::vector<std::vector<std::string>>{}) {
      std::vector<std::string> names{"session_uid"};
      for (const std::string& column : unique) append(names, column);
      table_.uniques.push_back(names);
    }
    for (const auto& [column, parent] : local_.parents) {
      Reference reference{{}, parent, {}};
      const LocalTable& other = all_.at(parent);
      if (scope_of(all_, parent) == Scope::Session) reference.columns = {"session_uid"};
      append(reference.columns, column);
      if (const auto natural = naturals.find(parent); natural != naturals.end()) {
        if (parent == "question") reference.keys = {"protocol_sha256"};
        reference.keys.push_back(natural->second.name);
      } else {
        if (other.columns.front().key != 1)
          refuse_central("table " + parent, "is referred to and has no row number");
        reference.keys = {"session_uid", other.columns.front().name};
      }
      table_.references.push_back(std::move(reference));
    }
  }

  void add_checks();

  /// Table::rows of a table of a session, a protocol or a run.
  std::string rows_of(const std::string& name) const {
    if (scope_ == Scope::Person) return "1";
    if (scope_ == Scope::Run) return "x.run_id = ?1";
    if (scope_ == Scope::Protocol) return "x.protocol_id = ?1";
    if (name == "session") return "x.session_id = ?1";
    const LocalTable& table = all_.at(name);
    for (const auto& [column, parent] : table.parents) {
      if (parent == "session") return "x." + column + " = ?1";
    }
    for (const LocalColumn& column : table.columns) {
      const auto parent = table.parents.find(column.name);
      if (!column.not_null || parent == table.parents.end() ||
          scope_of(all_, parent->second) != Scope::Session)
        continue;
      return "x." + column.name + " IN (SELECT x." + column.name + " FROM " + parent->second + " x WHERE " +
             rows_of(parent->second) + ")";
    }
    refuse_central("table " + name, "belongs to no session");
  }

  const LocalTables& all_;
  const LocalTable& local_;
  Scope scope_;
  Table table_;
  std::map<std::string, std::vector<std::string>> names_;  // at the centre, by column of SQLite
};

/// The expressions of all CHECKs in a CREATE TABLE without comments.
std::vector<std::string> checks_in(const std::string& sql) {
  std::vector<std::string> found;
  char quote = 0;
  int depth = 0;
  std::size_t begin = 0;  // of the expression; 0: outside a CHECK
  int begin_depth = 0;
  for (std::size_t i = 0; i < sql.size(); ++i) {
    if (quote != 0) {
      if (sql[i] == quote) quote = 0;
    } else if (sql[i] == '\'' || sql[i] == '"') {
      quote = sql[i];
    } else if (sql[i] == '(') {
      ++depth;
      const std::size_t word = sql.find_last_not_of(' ', i - 1);
      if (begin == 0 && word != std::string::npos && word >= 4 && sql.compare(word - 4, 5, "CHECK") == 0) {
        begin = i + 1;
        begin_depth = depth;
      }
    } else if (sql[i] == ')') {
      if (begin != 0 && depth == begin_depth) {
        found.push_back(sql.substr(begin, i - begin));
        begin = 0;
      }
      --depth;
    }
  }
  return found;
}

void TableMaker::add_checks() {
  std::vector<std::pair<std::string, std::string>> renamed;
  for (const auto& [column, names] : names_) renamed.emplace_back(column, names.back());
  for (const std::string& check : checks_in(local_.sql))
    table_.checks.push_back(translated_check(check, renamed, "table " + local_.name));
}

std::vector<Table> make_tables() {
  const LocalTables local = read_tables();
  std::vector<Table> made;
  for (const auto& [name, table] : local) made.push_back(TableMaker(local, name).make());
  return made;
}

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

}  // namespace

const std::vector<Table>& tables() {
  static const std::vector<Table> made = make_tables();
  return made;
}

const Table& table(const std::string& name) {
  const auto found =
      std::find_if(tables().begin(), tables().end(), [&](const Table& one) { return one.name == name; });
  if (found == tables().end()) refuse_central("table " + name, "is not at the centre");
  return *found;
}

std::int64_t schema_number() { return static_cast<std::int64_t>(read_schema_steps().size()); }

std::string select_sql(const Table& table) {
  std::string values, order;
  for (const Column& column : table.columns) values += (values.empty() ? "" : ", ") + column.read;
  for (const std::string& name : table.key) {
    const auto column = std::find_if(table.columns.begin(), table.columns.end(),
                                     [&](const Column& one) { return one.name == name; });
    const auto place = std::to_string(column - table.columns.begin() + 1);
    if (name != "session_uid") order += (order.empty() ? " ORDER BY " : ", ") + place;
  }
  return "SELECT " + values + " FROM " + quoted(table.name) + " x WHERE " + table.rows + order;
}

std::string column_list(const Table& table) {
  std::string list;
  for (const Column& column : table.columns) list += (list.empty() ? "" : ", ") + quoted(column.name);
  return list;
}

}  // namespace study::central
