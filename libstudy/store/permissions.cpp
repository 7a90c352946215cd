#include "libstudy/store/permissions.hpp"

#include <array>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/backups.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/database.hpp"
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

/// What is recorded only of who allows gaze, the gaze itself first; ?1 is the person.
constexpr std::array gaze_of_person{
    "gaze WHERE presentation_id IN (SELECT presentation_id FROM presentation JOIN trial USING (trial_id) "
    "JOIN session USING (session_id) WHERE person = ?1)",
    "head WHERE presentation_id IN (SELECT presentation_id FROM presentation JOIN trial USING (trial_id) "
    "JOIN session USING (session_id) WHERE person = ?1)",
    "gaze_validation WHERE session_id IN (SELECT session_id FROM session WHERE person = ?1)"};

std::string person_of(Connection& database, const std::string& participant) {
  Statement here(database, "SELECT person FROM session WHERE participant = ?");
  if (here.bind_all(participant).step()) return here.text(0);
  Statement gone(database, "SELECT 1 FROM tombstone WHERE participant = ?");
  const bool withdrew = gone.bind_all(participant).step();
  throw base::Error(database.path().string(),
                    withdrew ? "participant " + participant + " withdrew: nothing of theirs is left"
                             : "knows no participant " + participant,
                    "vip-study status lists the codes");
}

std::optional<bool> granted(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  return row.integer(column) != 0;
}

void write_change(Connection& database, const std::string& person, const char* what, bool allowed) {
  const std::string now = base::utc_now();
  Statement(database,
            "INSERT INTO permission_change (session_id, what, granted, utc) "
            "SELECT session_id, ?2, ?3, ?4 FROM session WHERE person = ?1 ORDER BY session_id")
      .bind_all(person, what, allowed ? 1 : 0, now)
      .run();
  Statement(database,
            "INSERT INTO event (session_id, utc, kind, detail) "
            "SELECT session_id, ?2, ?3, ?4 FROM session WHERE person = ?1 ORDER BY session_id")
      .bind_all(person, now, permission_event, std::string(what) + (allowed ? " allowed" : " refused"))
      .run();
}

void write_changes(Connection& database, const std::string& person, const PermissionWish& wish) {
  AnswerJournal journal(database);
  Transaction transaction(database);
  if (wish.gaze) write_change(database, person, "gaze", *wish.gaze);
  if (wish.sharing) write_change(database, person, "sharing", *wish.sharing);
  if (wish.gaze && !*wish.gaze) {
    for (const char* rows : gaze_of_person)
      Statement(database, std::string("DELETE FROM ") + rows).bind_all(person).run();
    ChorePlan(database).rewrite();
  }
  journal.write();
  transaction.commit();
  journal.kept();
  journal.require_written();
}

std::int64_t count_rows(Connection& database, const std::string& rows, const std::string& person) {
  Statement row(database, "SELECT count(*) FROM " + rows);
  return row.bind_all(person).step() ? row.integer(0) : 0;
}

/// Of any schema.
bool holds_gaze(const fs::path& path, const std::string& person) {
  Connection backup(path, Open::Read);
  Statement there(backup, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = ?");
  for (const std::string rows : gaze_of_person) {
    const bool any = there.bind_all(rows.substr(0, rows.find(' '))).step();
    there.reset();
    if (any && count_rows(backup, rows, person) > 0) return true;
  }
  return false;
}

/// One that cannot be read may hold it.
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

/// Of a person. The register does not tell which of them were made with gaze.
std::vector<std::string> exports_of(Connection& database, const std::string& person, bool public_only) {
  Statement row(database,
                "SELECT path || iif(host = '', '', ' on ' || host) FROM export JOIN export_person USING "
                "(export_id) WHERE person = ?1 AND (NOT ?2 OR kind IN ('bids', 'psych-ds', 'unknown')) "
                "ORDER BY export_id");
  row.bind_all(person, public_only ? 1 : 0);
  std::vector<std::string> found;
  while (row.step()) found.push_back(row.text(0));
  return found;
}

}  // namespace

std::vector<SessionPermission> read_permissions(const fs::path& path, const std::string& participant) {
  const auto database = open_database(path, Open::Read, read_schema_steps());
  const std::string person = person_of(*database, participant);
  Statement row(*database,
                "SELECT p.name, s.visit, g.granted, h.granted FROM session s JOIN protocol p USING "
                "(protocol_id) JOIN permission g ON g.session_id = s.session_id AND g.what = 'gaze' "
                "JOIN permission h ON h.session_id = s.session_id AND h.what = 'sharing' "
                "WHERE s.person = ? ORDER BY s.session_id");
  row.bind_all(person);
  std::vector<SessionPermission> sessions;
  while (row.step())
    sessions.push_back({row.text(0), static_cast<int>(row.integer(1)), granted(row, 2), granted(row, 3)});
  return sessions;
}

PermissionChange change_permissions(const fs::path& path, const std::string& participant,
                                    const PermissionWish& wish) {
  const WriterLock lock(path);
  const auto database = open_database(path, Open::Write, read_schema_steps());
  database->execute("PRAGMA temp_store = MEMORY; PRAGMA secure_delete = ON");
  const std::string person = person_of(*database, participant);
  const bool no_gaze = wish.gaze && !*wish.gaze, no_sharing = wish.sharing && !*wish.sharing;
  PermissionChange done;
  if (no_gaze) done.gaze_deleted = count_rows(*database, gaze_of_person.front(), person);
  write_changes(*database, person, wish);
  if (no_gaze) {
    done.left = clean_up(*database).left;
    done.backups = backups_with_gaze(path, person);
    done.gaze_exports = exports_of(*database, person, false);
  }
  if (no_sharing) done.exports = exports_of(*database, person, true);
  return done;
}

SharingCount count_sharing(Connection& database) {
  // Whoever is left out said so in some session, or else was only asked.
  Statement row(
      database,
      "SELECT count(*) FILTER (WHERE h.granted = 1), count(*) FILTER (WHERE h.granted IS NULL), "
      "count(*) FILTER (WHERE h.granted = 0 AND said), count(*) FILTER (WHERE h.granted = 0 AND NOT "
      "said) FROM (SELECT granted, EXISTS (SELECT 1 FROM permission p LEFT JOIN permission_answer a "
      "USING (session_id, what) WHERE p.person = sharing.person AND p.what = 'sharing' "
      "AND p.granted = 0 AND (a.answered IS NOT NULL OR EXISTS (SELECT 1 FROM permission_change c "
      "WHERE c.session_id = p.session_id AND c.what = 'sharing'))) AS said FROM sharing) h");
  row.step();
  return {row.integer(0), row.integer(1), row.integer(2), row.integer(3)};
}

void drop_unallowed_gaze(Connection& database) {
  for (const char* table : {"gaze", "head"}) {
    database.execute(
        std::string("DELETE FROM ") + table +
        " WHERE presentation_id IN (SELECT presentation_id FROM presentation p JOIN trial t USING (trial_id) "
        "JOIN permission g ON g.session_id = t.session_id AND g.what = 'gaze' WHERE g.granted IS NOT 1 OR "
        "EXISTS (SELECT 1 FROM permission_change c WHERE c.session_id = t.session_id AND c.what = 'gaze' AND "
        "c.granted = 0 AND c.utc >= p.started_utc))");
  }
  // Of no time of day: one refusal in any copy is enough.
  database.execute(
      "DELETE FROM gaze_validation WHERE session_id IN (SELECT session_id FROM permission WHERE what = "
      "'gaze' AND granted IS NOT 1) OR session_id IN (SELECT session_id FROM permission_change WHERE what = "
      "'gaze' AND granted = 0)");
}

}  // namespace study
