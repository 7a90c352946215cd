#include "libstudy/store/refusals.hpp"

#include <array>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/backups.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;

namespace {

constexpr std::array of_showings{"gaze", "head"};
constexpr std::array all_tables{"gaze", "head", "gaze_validation"};

/// SQL condition on the rows of `table` (gaze, head or gaze_validation): their session_id is in `from`, an
/// SQL table with an optional WHERE clause.
std::string of_sessions(const std::string& table, const std::string& from) {
  const std::string sessions = "session_id IN (SELECT session_id FROM " + from + ")";
  if (table == "gaze_validation") return sessions;
  return "presentation_id IN (SELECT presentation_id FROM presentation JOIN trial USING (trial_id) WHERE " +
         sessions + ")";
}

std::string rows_of(const std::string& table, const std::string& from) {
  return table + " WHERE " + of_sessions(table, from);
}

const std::string of_person = "session WHERE person = ?1";
const std::string refused_now = "permission WHERE what = 'gaze' AND granted IS NOT 1";

std::set<std::string> persons(Connection& database, const std::string& sql) {
  std::set<std::string> found;
  for (Statement row(database, sql); row.step();) found.insert(row.text(0));
  return found;
}

/// Persons with gaze data in the sessions of `condition`, an SQL table with an optional WHERE clause.
std::set<std::string> people_with_gaze_in(Connection& database, const std::string& condition) {
  std::set<std::string> found;
  for (const std::string table : all_tables) {
    const std::string sessions = table == "gaze_validation"
                                     ? "SELECT session_id FROM gaze_validation"
                                     : "SELECT session_id FROM trial JOIN presentation p USING (trial_id) "
                                       "WHERE EXISTS (SELECT 1 FROM " +
                                           table + " g WHERE g.presentation_id = p.presentation_id)";
    found.merge(persons(database, "SELECT DISTINCT person FROM session WHERE session_id IN (" + sessions +
                                      ") AND session_id IN (SELECT session_id FROM " + condition + ")"));
  }
  return found;
}

bool any_row(Connection& database, const std::string& rows, const std::string& person) {
  Statement row(database, "SELECT 1 FROM " + rows + " LIMIT 1");
  return row.bind_all(person).step();
}

/// True if a backup, which may have any schema version, contains gaze data of a person.
bool holds_gaze(const fs::path& path, const std::string& person) {
  Connection backup(path, Open::Read);
  Statement there(backup, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = ?");
  for (const std::string table : all_tables) {
    const bool any = there.bind_all(table).step();
    there.reset();
    if (any && any_row(backup, rows_of(table, of_person), person)) return true;
  }
  return false;
}

/// Paths of the backups with gaze of a person, including backups that cannot be read.
std::vector<std::string> backups_with_gaze(const fs::path& database, const std::string& person) {
  std::vector<std::string> found;
  for (const fs::path& backup : backups_of(database)) {
    try {
      if (holds_gaze(backup, person)) found.push_back(backup.string());
    } catch (const base::Error&) {
      found.push_back(backup.string() + " (cannot be read)");
    }
  }
  return found;
}

}  // namespace

std::set<std::string> delete_refused_gaze(Connection& database) {
  std::set<std::string> found = people_with_gaze_in(database, refused_now);
  if (found.empty()) return found;
  for (const char* table : all_tables) database.execute("DELETE FROM " + rows_of(table, refused_now));
  ChorePlan(database).rewrite();
  return found;
}

void drop_unallowed_gaze(Connection& database) {
  for (const char* table : all_tables) database.execute("DELETE FROM " + rows_of(table, refused_now));
  // A refusal applies to the showings that had begun when it was recorded. These are the session's first n
  // showings; n is permission_change.showings, and NULL means all showings.
  for (const std::string table : of_showings) {
    database.execute(
        "DELETE FROM " + table +
        " WHERE presentation_id IN (SELECT p.presentation_id FROM (SELECT presentation_id, session_id, "
        "row_number() OVER (PARTITION BY session_id ORDER BY presentation_id) AS place FROM presentation "
        "JOIN trial USING (trial_id)) p JOIN permission_change c USING (session_id) WHERE c.what = 'gaze' "
        "AND c.granted = 0 AND coalesce(c.showings, p.place) >= p.place)");
  }
  // A validation belongs to no showing, so any refusal in the session deletes all validations.
  database.execute("DELETE FROM " +
                   rows_of("gaze_validation", "permission_change WHERE what = 'gaze' AND granted = 0"));
}

std::string gaze_allowed_sql(const std::string& table) {
  return of_sessions(table, "permission WHERE what = 'gaze' AND granted = 1");
}

bool is_gaze_allowed(Connection& database, std::int64_t session) {
  Statement row(database, "SELECT 1 FROM permission WHERE session_id = ? AND what = 'gaze' AND granted = 1");
  return row.bind_all(session).step();
}

std::int64_t count_gaze(Connection& database, const std::string& person) {
  Statement row(database, "SELECT count(*) FROM " + rows_of("gaze", of_person));
  return row.bind_all(person).step() ? row.integer(0) : 0;
}

GazeRows gaze_rows(Connection& database) {
  GazeRows rows;
  for (const std::string table : all_tables) {
    const std::string joins = table == "gaze_validation"
                                  ? ""
                                  : " JOIN presentation USING (presentation_id) JOIN trial USING (trial_id)";
    Statement row(database, "SELECT uid, count(*) FROM " + table + joins +
                                " JOIN session USING (session_id) GROUP BY uid");
    while (row.step()) rows[row.text(0)] += row.integer(1);
  }
  return rows;
}

std::set<std::string> people_with_less_gaze(Connection& database, const GazeRows& before) {
  GazeRows now = gaze_rows(database);
  std::set<std::string> found;
  Statement row(database, "SELECT uid, person FROM session WHERE session_id IN (SELECT session_id FROM " +
                              refused_now +
                              " UNION SELECT session_id FROM permission_change WHERE what = 'gaze' AND "
                              "granted = 0)");
  while (row.step()) {
    const auto rows = before.find(row.text(0));
    if (rows != before.end() && now[rows->first] < rows->second) found.insert(row.text(1));
  }
  return found;
}

GazeElsewhere find_gaze_elsewhere(Connection& database, const std::string& person) {
  GazeElsewhere found{backups_with_gaze(database.path(), person), {}};
  Statement row(database,
                "SELECT path || iif(host = '', '', ' on ' || host) FROM export JOIN export_person USING "
                "(export_id) WHERE person = ? ORDER BY export_id");
  for (row.bind_all(person); row.step();) found.exports.push_back(row.text(0));
  return found;
}

std::vector<std::string> name_gaze_elsewhere(Connection& database, const std::set<std::string>& people) {
  std::vector<std::string> lines;
  Statement code(database, "SELECT participant FROM session WHERE person = ? LIMIT 1");
  for (const std::string& person : people) {
    if (!code.bind_all(person).step()) continue;
    const std::string participant = code.text(0);
    code.reset();
    const GazeElsewhere found = find_gaze_elsewhere(database, person);
    for (const std::string& backup : found.backups)
      lines.push_back("backup " + backup + ": holds gaze that " + participant + " refused; delete it");
    for (const std::string& made : found.exports) {
      lines.push_back("export " + made + ": may hold gaze that " + participant +
                      " refused; delete it and its copies, or make it again");
    }
  }
  return lines;
}

}  // namespace study
