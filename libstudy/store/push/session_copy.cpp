#include "libstudy/store/push/session_copy.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "libstudy/store/permissions.hpp"
#include "stats/base/file.hpp"

namespace study::pushing {

using central::Table;
using pg::Field;
using pg::Row;
using sqlite::Connection;
using sqlite::Statement;

namespace {

Field field_of(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  if (row.is_real(column)) return pg::text_of(row.real(column));
  if (row.is_text(column)) return row.text(column);
  return pg::text_of(row.integer(column));
}

std::int64_t number_of(const Field& field) { return field ? std::stoll(*field) : 0; }

void take_larger(Field& mine, const Field& other) {
  if (other && (!mine || number_of(mine) < number_of(other))) mine = other;
}

}  // namespace

std::vector<LocalSession> read_sessions(Connection& file) {
  std::vector<LocalSession> sessions;
  Statement row(file,
                "SELECT s.session_id, s.run_id, s.protocol_id, s.uid, s.person, s.code, p.sha256, s.visit "
                "FROM session s JOIN run r USING (run_id) JOIN protocol p USING (protocol_id) "
                "ORDER BY r.started_utc, r.uid, s.session_id");
  while (row.step()) {
    sessions.push_back({.id = row.integer(0),
                        .run_id = row.integer(1),
                        .protocol_id = row.integer(2),
                        .uid = row.text(3),
                        .person = row.text(4),
                        .code = row.text(5),
                        .protocol_sha256 = row.text(6),
                        .visit = row.integer(7)});
  }
  return sessions;
}

TableRows read_rows(Connection& file, const Table& table, std::int64_t id, const std::string& uid) {
  Statement row(file, central::select_sql(table));
  if (table.scope == central::Scope::Session)
    row.bind_all(id, uid);
  else if (table.scope != central::Scope::Person)
    row.bind_all(id);
  TableRows found{&table, {}};
  while (row.step()) {
    Row& values = found.rows.emplace_back();
    values.reserve(table.columns.size());
    for (int i = 0; i < row.columns(); ++i) values.push_back(field_of(row, i));
  }
  return found;
}

std::string digest_of(const std::vector<TableRows>& tables) {
  std::string text;
  for (const TableRows& one : tables) {
    text += one.table->name + "\n";
    for (const Row& row : one.rows) pg::append_line(row, text);
  }
  return base::sha256_hex(text);
}

std::size_t place_of(const Table& table, const std::string& column) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const central::Column& one) { return one.name == column; });
  return static_cast<std::size_t>(found - table.columns.begin());
}

namespace {

/// By column: the number in the session of each row number of the file.
using Numbers = std::map<std::string, std::map<std::string, std::string>>;

/// Adds the numbers of a table's rows, if it has row numbers.
void add_numbers(const TableRows& rows, Numbers& numbers) {
  const std::string column = rows.table->name + "_id";
  const std::size_t place = place_of(*rows.table, column);
  if (place == rows.table->columns.size()) return;
  auto& known = numbers[column];
  for (const Row& row : rows.rows) known.emplace(*row[place], pg::text_of(std::int64_t(known.size()) + 1));
}

/// Replaces row numbers. One of a row that the session does not have becomes negative, so that the centre
/// refuses it.
void renumber(TableRows& rows, const Numbers& numbers) {
  for (std::size_t i = 0; i < rows.table->columns.size(); ++i) {
    const auto known = numbers.find(rows.table->columns[i].name);
    if (known == numbers.end()) continue;
    for (Row& row : rows.rows) {
      if (!row[i]) continue;
      const auto number = known->second.find(*row[i]);
      row[i] = number == known->second.end() ? "-" + *row[i] : number->second;
    }
  }
}

/// Parts the changes of permissions from the other events.
void part_events(TableRows rows, Core& core) {
  const Table& table = *rows.table;
  const std::size_t kind = place_of(table, "kind"), utc = place_of(table, "utc"),
                    clock = place_of(table, "clock_ns"), detail = place_of(table, "detail");
  const auto first = std::stable_partition(rows.rows.begin(), rows.rows.end(),
                                           [&](const Row& row) { return row[kind] != permission_event; });
  core.change_events = {&table, {std::make_move_iterator(first), std::make_move_iterator(rows.rows.end())}};
  rows.rows.erase(first, rows.rows.end());
  for (const Row& row : rows.rows) core.log.push_back({row[utc], row[clock], row[kind], row[detail]});
  core.tables.push_back(std::move(rows));
}

/// Notes which presentations there are. Returns how many of them have ended.
std::int64_t look_at_showings(const TableRows& rows, Core& core) {
  const std::size_t id = place_of(*rows.table, "presentation_id"), state = place_of(*rows.table, "state");
  std::int64_t ended = 0;
  for (const Row& row : rows.rows) {
    core.showings.push_back({number_of(row[id]), static_cast<std::int64_t>(core.showings.size()) + 1});
    if (row[state] != "running") ++ended;
  }
  return ended;
}

}  // namespace

Core read_core(Connection& file, const LocalSession& session) {
  Core core;
  std::vector<TableRows> all;
  Numbers numbers;
  for (const Table* table : central::in_order()) {
    if (table->scope != central::Scope::Session || table->large) continue;
    all.push_back(read_rows(file, *table, session.id, session.uid));
    add_numbers(all.back(), numbers);
    if (table->name == "presentation") core.progress += look_at_showings(all.back(), core);
  }
  for (TableRows& rows : all) renumber(rows, numbers);
  core.sha256 = digest_of(all);
  for (TableRows& rows : all) {
    if (rows.table->name == "permission_change")
      core.changes = std::move(rows);
    else if (rows.table->name == "event")
      part_events(std::move(rows), core);
    else
      core.tables.push_back(std::move(rows));
  }
  for (const TableRows& rows : core.tables) core.progress += static_cast<std::int64_t>(rows.rows.size());
  return core;
}

TableRows read_large(Connection& file, const Table& table, const LocalSession& session,
                     const Showing& showing) {
  TableRows rows = read_rows(file, table, showing.id, session.uid);
  renumber(rows, {{"presentation_id", {{pg::text_of(showing.id), pg::text_of(showing.number)}}}});
  return rows;
}

std::int64_t count_large(Connection& file, const Table& table, const Showing& showing) {
  Statement row(file, "SELECT count(*) FROM \"" + table.name + "\" x WHERE " + table.rows);
  row.bind_all(showing.id).step();
  return row.integer(0);
}

std::string log_digest(const std::vector<Row>& log, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) pg::append_line(log[i], text);
  return base::sha256_hex(text);
}

bool join_changes(TableRows& base, const TableRows& other) {
  const Table& table = *base.table;
  const std::size_t id = place_of(table, "permission_change_id");
  const std::vector<std::size_t> same{place_of(table, "what"), place_of(table, "utc"),
                                      place_of(table, "granted"), place_of(table, "uid")};
  const std::vector<std::size_t> growing{place_of(table, "turn"), place_of(table, "answers"),
                                         place_of(table, "showings"), place_of(table, "superseded")};
  const auto key = [&](const Row& row) {
    return std::tuple(row[same[0]], row[same[1]], row[same[2]], row[same[3]]);
  };
  const std::vector<Row> before = base.rows;
  std::int64_t next = 1;
  for (const Row& row : base.rows) next = std::max(next, number_of(row[id]) + 1);
  for (const Row& row : other.rows) {
    const auto mine = std::find_if(base.rows.begin(), base.rows.end(),
                                   [&](const Row& one) { return key(one) == key(row); });
    if (mine == base.rows.end()) {
      base.rows.push_back(row);
      base.rows.back()[id] = pg::text_of(next++);
    } else {
      for (const std::size_t place : growing) take_larger((*mine)[place], row[place]);
    }
  }
  return base.rows != before;
}

bool join_change_events(TableRows& base, const TableRows& other, std::int64_t next) {
  const Table& table = *base.table;
  const std::size_t id = place_of(table, "event_id"), utc = place_of(table, "utc"),
                    detail = place_of(table, "detail");
  std::set<std::pair<Field, Field>> known;
  for (const Row& row : base.rows) known.emplace(row[utc], row[detail]);
  bool added = false;
  for (const Row& row : other.rows) {
    if (!known.emplace(row[utc], row[detail]).second) continue;
    base.rows.push_back(row);
    base.rows.back()[id] = pg::text_of(next++);
    added = true;
  }
  return added;
}

}  // namespace study::pushing
