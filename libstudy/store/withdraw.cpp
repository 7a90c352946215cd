#include "libstudy/store/withdraw.hpp"

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/database.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/writer_lock.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// What depends on a session, children first; `gone` lists the sessions.
constexpr const char* delete_sessions =
    "DELETE FROM event WHERE session_id IN temp.gone;"
    "DELETE FROM note WHERE session_id IN temp.gone;"
    "DELETE FROM response WHERE unit_id IN (SELECT unit_id FROM unit WHERE session_id IN temp.gone);"
    "DELETE FROM frame WHERE presentation_id IN (SELECT presentation_id FROM presentation "
    "JOIN trial USING (trial_id) WHERE session_id IN temp.gone);"
    "DELETE FROM presentation WHERE trial_id IN (SELECT trial_id FROM trial WHERE session_id IN temp.gone);"
    "DELETE FROM unit WHERE session_id IN temp.gone;"
    "DELETE FROM trial WHERE session_id IN temp.gone;"
    "DELETE FROM session WHERE session_id IN temp.gone;"
    "DELETE FROM run WHERE run_id NOT IN (SELECT run_id FROM session);";

/// The same in schema 1, where answers belong to trials and there are no pages.
constexpr const char* delete_sessions_1 =
    "DELETE FROM event WHERE session_id IN temp.gone;"
    "DELETE FROM response WHERE trial_id IN (SELECT trial_id FROM trial WHERE session_id IN temp.gone);"
    "DELETE FROM frame WHERE presentation_id IN (SELECT presentation_id FROM presentation "
    "JOIN trial USING (trial_id) WHERE session_id IN temp.gone);"
    "DELETE FROM presentation WHERE trial_id IN (SELECT trial_id FROM trial WHERE session_id IN temp.gone);"
    "DELETE FROM trial WHERE session_id IN temp.gone;"
    "DELETE FROM session WHERE session_id IN temp.gone;"
    "DELETE FROM run WHERE run_id NOT IN (SELECT run_id FROM session);";

struct Leaver {
  std::string person, code;
};

/// None when nobody of that code was ever here.
std::vector<Leaver> find(Connection& database, const std::string& participant) {
  Statement row(database,
                "SELECT person, code FROM session WHERE participant = ?1 UNION "
                "SELECT person, code FROM tombstone WHERE participant = ?1");
  row.bind(0, participant);
  std::vector<Leaver> found;
  while (row.step()) found.push_back({row.text(0), row.text(1)});
  return found;
}

std::vector<std::string> texts(Connection& database, const char* sql, const std::string& person) {
  Statement row(database, sql);
  row.bind(0, person);
  std::vector<std::string> found;
  while (row.step()) found.push_back(row.text(0));
  return found;
}

std::int64_t count(Connection& database, const char* sql, const std::string& person) {
  Statement row(database, sql);
  return row.bind(0, person).step() ? row.integer(0) : 0;
}

}  // namespace

Withdrawal take_stock(Connection& database, const std::string& person) {
  Withdrawal done;
  done.sessions = count(database, "SELECT count(*) FROM session WHERE person = ?", person);
  done.answers =
      count(database,
            "SELECT count(*) FROM response JOIN unit USING (unit_id) JOIN session USING (session_id) "
            "WHERE person = ?",
            person);
  done.frames = count(database,
                      "SELECT count(*) FROM frame JOIN presentation USING (presentation_id) "
                      "JOIN trial USING (trial_id) JOIN session USING (session_id) WHERE person = ?",
                      person);
  done.stations = texts(
      database, "SELECT DISTINCT station FROM session WHERE person = ? AND station <> '' ORDER BY 1", person);
  // An export from before the first session holds nothing of it.
  done.exports = texts(database,
                       "SELECT DISTINCT detail FROM event WHERE kind = 'export' AND utc >= coalesce("
                       "(SELECT min(r.started_utc) FROM run r JOIN session s USING (run_id) "
                       "WHERE s.person = ?), '') ORDER BY 1",
                       person);
  return done;
}

namespace {

bool is_backup(const fs::path& file, const fs::path& database) {
  const std::string name = file.filename().string();
  return name.starts_with(database.filename().string() + ".v") && name.ends_with(".bak");
}

/// Schema 1 knows no tombstone and keeps its log whatever happens: the trigger steps aside in the
/// transaction.
void bury_in_schema_1(Connection& backup, const std::string& participant, const std::string& code) {
  const std::string trigger = backup.text("SELECT sql FROM sqlite_schema WHERE name = 'event_is_kept'");
  Transaction transaction(backup);
  Statement(backup, "INSERT INTO temp.gone SELECT session_id FROM session WHERE participant IN (?, ?)")
      .bind(0, participant)
      .bind(1, code)
      .run();
  backup.execute("DROP TRIGGER event_is_kept");
  backup.execute(delete_sessions_1);
  backup.execute(trigger);
  transaction.commit();
}

/// False: the participant does not stand in it.
bool scrub_backup(const fs::path& path, const std::string& participant, const std::string& code) {
  Connection backup(path, Open::Write);
  const auto version = backup.integer("PRAGMA user_version");
  if (backup.integer("PRAGMA application_id") != database_application_id || version < 1 || version > 2)
    throw base::Error(path.string(), "is not a backup that this program knows", "delete it");
  backup.text("PRAGMA journal_mode = DELETE");
  backup.execute("PRAGMA foreign_keys = ON; PRAGMA temp_store = MEMORY");
  Statement stands(backup, "SELECT count(*) FROM session WHERE participant IN (?, ?)");
  if (!stands.bind(0, participant).bind(1, code).step() || stands.integer(0) == 0) return false;
  stands.reset();
  if (version == 1) {
    backup.execute("PRAGMA secure_delete = ON; CREATE TEMP TABLE gone (session_id INTEGER PRIMARY KEY)");
    bury_in_schema_1(backup, participant, code);
  } else {
    std::vector<Leaver> leavers = find(backup, participant);
    if (leavers.empty()) leavers = find(backup, code);
    Transaction transaction(backup);
    for (const Leaver& leaver : leavers) bury(backup, leaver.person);
    transaction.commit();
  }
  backup.execute("VACUUM");
  return true;
}

}  // namespace

void bury(Connection& database, const std::string& person) {
  database.execute(
      "PRAGMA secure_delete = ON; CREATE TEMP TABLE IF NOT EXISTS gone (session_id INTEGER PRIMARY KEY);"
      "DELETE FROM temp.gone");
  Statement(database, "INSERT INTO temp.gone SELECT session_id FROM session WHERE person = ?")
      .bind(0, person)
      .run();
  Statement(database,
            "INSERT OR IGNORE INTO tombstone SELECT person, participant, code, station, ? FROM session "
            "JOIN run USING (run_id) WHERE person = ? ORDER BY run.started_utc, session.uid LIMIT 1")
      .bind(0, base::utc_now())
      .bind(1, person)
      .run();
  database.execute(delete_sessions);
}

void rewrite(Connection& database) {
  const auto empty_log = [&] {
    if (database.integer("PRAGMA wal_checkpoint(TRUNCATE)") == 0) return;
    throw base::Error(database.path().string(), "its log cannot be emptied: another program reads it",
                      "close that program and do this again");
  };
  empty_log();
  database.execute("VACUUM");
  empty_log();
}

void scrub_beside(const fs::path& database, const std::string& participant, const std::string& code,
                  Withdrawal& done) {
  for (const auto& entry : fs::directory_iterator(fs::absolute(database).parent_path())) {
    if (!is_backup(entry.path(), database)) continue;
    try {
      if (scrub_backup(entry.path(), participant, code)) done.scrubbed.push_back(entry.path());
    } catch (const base::Error& error) {
      done.failed.emplace_back(error.what());
    }
  }
  const fs::path personal = PersonalFile::beside(database);
  std::error_code ignored;
  if (!fs::exists(personal, ignored)) return;
  PersonalFile(database).forget(participant);
  done.scrubbed.push_back(personal);
}

Withdrawal withdraw(const fs::path& path, const std::string& participant) {
  const WriterLock lock(path);
  const auto database = open_database(path, Open::Write, read_schema_steps());
  database->execute("PRAGMA temp_store = MEMORY");
  const auto found = find(*database, participant);
  if (found.empty()) {
    throw base::Error(path.string(), "knows no participant " + participant,
                      "vip-study status lists the codes");
  }
  Withdrawal done = take_stock(*database, found.front().person);
  prepare_rewrite(*database, {found.front().person});
  Transaction transaction(*database);
  bury(*database, found.front().person);
  transaction.commit();
  rewrite(*database);
  rewrite_journal(*database);
  scrub_beside(path, participant, found.front().code, done);
  return done;
}

}  // namespace study
