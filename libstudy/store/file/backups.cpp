#include "libstudy/store/file/backups.hpp"

#include <unistd.h>

#include <algorithm>

#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// Rows of a table that are deleted together with a session. The table temp.gone lists the sessions to
/// delete.
struct Dependant {
  const char* table;
  const char* rows;                    ///< SQL condition that selects the rows
  std::int64_t since = 1, until = 99;  ///< first and last schema version in which the condition is valid
};

constexpr const char* of_session = "session_id IN temp.gone";
constexpr const char* of_trial = "trial_id IN (SELECT trial_id FROM trial WHERE session_id IN temp.gone)";
constexpr const char* of_presentation =
    "presentation_id IN (SELECT presentation_id FROM presentation JOIN trial USING (trial_id) "
    "WHERE session_id IN temp.gone)";

/// In the order of deletion: child tables before their parent tables.
constexpr Dependant dependants[] = {
    {"permission_change", of_session, 3},
    {"marker", of_session, 10},
    {"tracker_clock", of_session, 11},
    {"light", of_presentation, 12},
    {"gaze_validation", of_session, 5},
    {"gaze", of_presentation, 3},
    {"head", of_presentation, 5},
    {"slot", of_presentation, 5},
    {"event", of_session},
    {"note", of_session, 2},
    {"response", of_trial, 1, 1},
    {"response", "unit_id IN (SELECT unit_id FROM unit WHERE session_id IN temp.gone)", 2},
    {"frame", of_presentation},
    {"presentation", of_trial},
    {"framing", of_session, 4},
    {"headset", of_session, 5},
    {"ipd", of_session, 5},
    {"unit", of_session, 2},
    {"trial", of_session},
    {"session", of_session},
    {"run", "run_id NOT IN (SELECT run_id FROM session)"},
};

void delete_sessions(Connection& database, std::int64_t version) {
  for (const Dependant& dependant : dependants) {
    if (version < dependant.since || version > dependant.until) continue;
    database.execute(std::string("DELETE FROM ") + dependant.table + " WHERE " + dependant.rows);
  }
}

void list_sessions(Connection& database, const std::vector<std::int64_t>& sessions) {
  database.execute(
      "PRAGMA secure_delete = ON; CREATE TEMP TABLE IF NOT EXISTS gone (session_id INTEGER PRIMARY KEY);"
      "DELETE FROM temp.gone");
  Statement insert(database, "INSERT INTO temp.gone VALUES (?)");
  for (const std::int64_t session : sessions) insert.bind_all(session).run();
}

std::vector<std::int64_t> sessions_of(Connection& database, const std::string& person) {
  Statement row(database, "SELECT session_id FROM session WHERE person = ?");
  std::vector<std::int64_t> sessions;
  for (row.bind_all(person); row.step();) sessions.push_back(row.integer(0));
  return sessions;
}

/// The sessions of a person in a backup of schema 1. This schema has no column for persons, so the sessions
/// are looked up in an upgraded copy, which has the same session numbers.
std::vector<std::int64_t> sessions_in_schema_1(const fs::path& backup, const std::string& person) {
  const auto upgraded = open_database(backup, Open::Read, read_schema_steps());
  return sessions_of(*upgraded, person);
}

/// Deletes sessions from a backup of schema 1, which has no tombstones. A trigger forbids the deletion of
/// events, so the transaction drops the trigger and makes it again.
void bury_in_schema_1(Connection& backup, const std::vector<std::int64_t>& sessions) {
  const std::string trigger = backup.text("SELECT sql FROM sqlite_schema WHERE name = 'event_is_kept'");
  Transaction transaction(backup);
  list_sessions(backup, sessions);
  backup.execute("DROP TRIGGER event_is_kept");
  delete_sessions(backup, 1);
  backup.execute(trigger);
  transaction.commit();
}

void bury_later(Connection& backup, const std::string& person, std::int64_t version) {
  Transaction transaction(backup);
  bury(backup, person, version);
  if (version >= 3) {
    Statement(backup, "DELETE FROM export_person WHERE person = ?").bind_all(person).run();
    Statement(backup, "DELETE FROM chore WHERE person = ?").bind_all(person).run();
  }
  transaction.commit();
}

bool is_buried(Connection& backup, const std::string& person) {
  Statement stone(backup, "SELECT 1 FROM tombstone WHERE person = ?");
  return stone.bind_all(person).step();
}

}  // namespace

std::vector<fs::path> backups_of(const fs::path& database) {
  const fs::path file = fs::absolute(real_file(database));
  std::vector<fs::path> backups;
  for (const auto& entry : fs::directory_iterator(file.parent_path())) {
    const std::string name = entry.path().filename().string();
    const bool upgraded = name.starts_with(file.filename().string() + ".v") && name.ends_with(".bak");
    if (upgraded || name.starts_with(file.filename().string() + ".rescued-")) backups.push_back(entry.path());
  }
  std::sort(backups.begin(), backups.end());
  return backups;
}

bool delete_from_backup(const fs::path& path, const std::string& person) {
  Connection backup(path, Open::Write);
  backup.distrust();
  const auto version = backup.integer("PRAGMA user_version");
  if (backup.integer("PRAGMA application_id") != database_application_id || version < 1 ||
      version > static_cast<std::int64_t>(read_schema_steps().size()))
    throw base::Error(path.string(), "has a backup's name but is not a database of this vip-study",
                      "move it to another folder if it holds no people's data");
  check_schema(backup, read_schema_steps(), version);
  backup.recognise();
  backup.text("PRAGMA journal_mode = DELETE");
  backup.execute("PRAGMA foreign_keys = ON; PRAGMA temp_store = MEMORY");
  const auto sessions = version == 1 ? sessions_in_schema_1(path, person) : sessions_of(backup, person);
  if (version == 1 && !sessions.empty()) bury_in_schema_1(backup, sessions);
  if (version > 1 && !sessions.empty()) bury_later(backup, person, version);
  // An earlier deletion may have been interrupted before VACUUM. A tombstone shows an earlier deletion. A
  // backup of schema 1 has no tombstones, so VACUUM runs whenever that backup is writable.
  if (sessions.empty() && !(version == 1 ? ::access(path.c_str(), W_OK) == 0 : is_buried(backup, person)))
    return false;
  backup.execute("VACUUM");
  return !sessions.empty();
}

void bury(Connection& database, const std::string& person, std::int64_t version) {
  list_sessions(database, sessions_of(database, person));
  Statement(database,
            "INSERT OR IGNORE INTO tombstone SELECT person, participant, code, station, ? FROM session "
            "JOIN run USING (run_id) WHERE person = ? ORDER BY run.started_utc, session.uid LIMIT 1")
      .bind_all(base::utc_now(), person)
      .run();
  if (version >= 7)
    Statement(database, "DELETE FROM label WHERE kind = 'person' AND owner = ?").bind_all(person).run();
  delete_sessions(database, version);
}

}  // namespace study
