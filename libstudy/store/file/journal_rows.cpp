#include "libstudy/store/file/journal_rows.hpp"

#include <sqlite3.h>

#include <algorithm>

#include "libstudy/store/file/schema.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"

namespace study::journal {

using Json = base::Json;
using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* of_session = "LEFT JOIN session s USING (session_id)";

const std::vector<Table> followed{
    {"protocol", {"protocol_id"}},
    {"question", {"question_id"}},
    {"ask", {"protocol_id", "block", "place"}},
    {"cell", {"protocol_id", "cell"}},
    {"run", {"run_id"}},
    {"session", {"session_id"}},
    {"framing", {"framing_id"}, false, "s.participant, s.uid AS session", of_session},
    {"headset", {"headset_id"}, false, "s.participant, s.uid AS session", of_session},
    {"ipd", {"ipd_id"}, false, "s.participant, s.uid AS session", of_session},
    {"trial", {"trial_id"}, true, "s.participant, s.uid AS session", of_session},
    {"unit", {"unit_id"}, true, "s.participant, s.uid AS session", of_session},
    {"presentation",
     {"presentation_id"},
     false,
     "s.participant, s.uid AS session, t.position AS trial",
     "LEFT JOIN trial t USING (trial_id) LEFT JOIN session s ON s.session_id = t.session_id"},
    {"response",
     {"response_id"},
     true,
     "s.participant, s.uid AS session, u.position AS unit, u.block, q.code AS question",
     "LEFT JOIN unit u USING (unit_id) LEFT JOIN session s ON s.session_id = u.session_id "
     "LEFT JOIN question q ON q.question_id = x.question_id"},
    {"note", {"note_id"}, true, "s.participant, s.uid AS session", of_session},
    {"permission_change", {"permission_change_id"}, true, "s.participant, s.uid AS session", of_session},
    {"event", {"event_id"}, false, "s.participant, s.uid AS session", of_session},
    {"tombstone", {"person"}},
    {"label", {"kind", "owner"}, false},
};

Json value_of(const Statement& row, int column) {
  if (row.is_null(column)) return nullptr;
  if (row.is_real(column)) return row.real(column);
  if (row.is_text(column)) return row.text(column);
  return row.integer(column);
}

std::string key_of(const Table& table, const Json& line) {
  std::string key;
  for (const std::string& name : table.key) {
    const auto value = line.find(name);
    if (value == line.end()) return {};
    key += (key.empty() ? "" : " ") + value->dump();
  }
  return key;
}

Row row_of(const Table& table, const Statement& statement) {
  Json line{{"table", table.name}}, of = Json::object();
  bool context = false;
  for (int i = 0; i < statement.columns(); ++i) {
    const std::string name = statement.column_name(i);
    if (name == "of")
      context = true;
    else
      (context ? of : line)[name] = value_of(statement, i);
  }
  if (!of.empty()) line["of"] = of;
  return {&table, key_of(table, line), line.dump()};
}

std::string selection(const Table& table, const std::string& condition) {
  const std::string context = table.context;
  std::string order;
  for (const std::string& name : table.key) order += (order.empty() ? "x." : ", x.") + name;
  return "SELECT " + listed(columns_of(table.name), "x.") +
         (context.empty() ? "" : ", NULL AS of, " + context) + " FROM " + table.name + " x " + table.joins +
         condition + " ORDER BY " + order;
}

void bind_value(Statement& statement, int index, const Json& value) {
  if (value.is_string())
    statement.bind_at(index, value.text());
  else if (value.is_number_float())
    statement.bind_at(index, value.get<double>());
  else if (value.is_number())
    statement.bind_at(index, value.get<std::int64_t>());
  else
    statement.bind_at(index, std::nullopt);
}

}  // namespace

std::span<const Table> tables() { return followed; }

const Table* find_table(const std::string& name) {
  const auto found =
      std::find_if(followed.begin(), followed.end(), [&](const Table& t) { return t.name == name; });
  return found == followed.end() ? nullptr : &*found;
}

void each_row(Connection& database, const Table& table, const std::function<void(Row)>& take) {
  for (Statement row(database, selection(table, "")); row.step();) take(row_of(table, row));
}

void each_row(Connection& database, const Table& table, std::span<const std::int64_t> row_ids,
              const std::function<void(Row)>& take) {
  if (row_ids.empty()) return;
  Statement row(database, selection(table, " WHERE x.rowid = ?"));
  for (const std::int64_t id : row_ids) {
    for (row.bind_all(id); row.step();) take(row_of(table, row));
  }
}

void each_row_of_protocol(Connection& database, const Table& table, std::int64_t protocol_id,
                          const std::function<void(Row)>& take) {
  Statement row(database, selection(table, " WHERE x.protocol_id = ?"));
  for (row.bind_all(protocol_id); row.step();) take(row_of(table, row));
}

std::optional<Row> stands_as(Connection& database, const Row& wanted) {
  const Table& table = *wanted.table;
  const Json line = Json::parse(wanted.line);
  std::string condition;
  for (const std::string& name : table.key)
    condition += (condition.empty() ? " WHERE x." : " AND x.") + name + " = ?";
  Statement row(database, selection(table, condition));
  for (std::size_t i = 0; i < table.key.size(); ++i)
    bind_value(row, static_cast<int>(i), line.at(table.key[i]));
  if (!row.step()) return {};
  return row_of(table, row);
}

std::optional<Row> read_row(const std::string& text) {
  const Json line = base::parse_json(text, most_levels);
  if (!line.is_object() || !line.contains("table") || !line["table"].is_string()) return {};
  const Table* table = find_table(line["table"].get<std::string>());
  if (!table) return {};
  Row row{table, key_of(*table, line), text};
  if (row.key.empty()) return {};
  return row;
}

std::string column(const Row& row, const std::string& name) {
  const Json line = Json::parse(row.line);
  const auto value = line.find(name);
  if (value == line.end() || value->is_null()) return {};
  return value->is_string() ? value->get<std::string>() : value->dump();
}

bool put(Connection& database, const Row& row, Put how) {
  const Json line = Json::parse(row.line);
  std::string names, values, changes;
  std::vector<const Json*> given;
  for (const std::string& name : columns_of(row.table->name)) {
    const auto value = line.find(name);
    if (value == line.end()) continue;
    names += (names.empty() ? "" : ", ") + name;
    values += values.empty() ? "?" : ", ?";
    changes += (changes.empty() ? "" : ", ") + name + " = excluded." + name;
    given.push_back(&*value);
  }
  std::string keys;
  for (const std::string& name : row.table->key) keys += (keys.empty() ? "" : ", ") + name;
  const bool replace = how == Put::Replace;
  Statement insert(database, std::string(replace ? "INSERT INTO " : "INSERT OR IGNORE INTO ") +
                                 row.table->name + " (" + names + ") VALUES (" + values + ")" +
                                 (replace ? " ON CONFLICT (" + keys + ") DO UPDATE SET " + changes : "") +
                                 " RETURNING 1");
  for (std::size_t i = 0; i < given.size(); ++i) bind_value(insert, static_cast<int>(i), *given[i]);
  try {
    return insert.step();
  } catch (const base::Error&) {
    const int code = sqlite3_errcode(database.handle()) & 0xff;
    if (code != SQLITE_CONSTRAINT && code != SQLITE_MISMATCH) throw;
    return false;
  }
}

}  // namespace study::journal
