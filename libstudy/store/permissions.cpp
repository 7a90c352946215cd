#include "libstudy/store/permissions.hpp"

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/settling.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

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
  std::vector<std::int64_t> sessions;
  Statement row(database, "SELECT session_id FROM session WHERE person = ? ORDER BY session_id");
  for (row.bind_all(person); row.step();) sessions.push_back(row.integer(0));
  for (const std::int64_t session : sessions) record_permission(database, session, what, allowed, now);
  Statement(database,
            "INSERT INTO event (session_id, utc, kind, detail) "
            "SELECT session_id, ?2, ?3, ?4 FROM session WHERE person = ?1 ORDER BY session_id")
      .bind_all(person, now, permission_event, std::string(what) + (allowed ? " allowed" : " refused"))
      .run();
}

void write_changes(Connection& database, const std::string& person, const PermissionRequest& request) {
  AnswerJournal journal(database);
  Transaction transaction(database);
  if (request.gaze) write_change(database, person, "gaze", *request.gaze);
  if (request.sharing) write_change(database, person, "sharing", *request.sharing);
  delete_refused_gaze(database);
  journal.write();
  transaction.commit();
  journal.kept();
  journal.require_written();
}

/// Paths of registered public exports, and of exports of unknown kind, that contain a person.
std::vector<std::string> public_exports_of(Connection& database, const std::string& person) {
  Statement row(database,
                "SELECT path || iif(host = '', '', ' on ' || host) FROM export JOIN export_person USING "
                "(export_id) WHERE person = ?1 AND kind IN ('bids', 'psych-ds', 'unknown') "
                "ORDER BY export_id");
  std::vector<std::string> found;
  for (row.bind_all(person); row.step();) found.push_back(row.text(0));
  return found;
}

}  // namespace

std::vector<SessionPermission> read_permissions(const StudyFile& study, const std::string& participant) {
  const auto database = open_study(study).database;
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

GazeElsewhere find_gaze_elsewhere(const StudyFile& study, const std::string& participant) {
  const auto database = open_study(study).database;
  return find_gaze_elsewhere(*database, person_of(*database, participant));
}

PermissionChange change_permissions(const fs::path& path, const std::string& participant,
                                    const PermissionRequest& request) {
  const WriterLock lock(path);
  const auto database = open_database(path, Open::Write, read_schema_steps());
  database->execute("PRAGMA temp_store = MEMORY; PRAGMA secure_delete = ON");
  const std::string person = person_of(*database, participant);
  PermissionChange done;
  const std::int64_t before = count_gaze(*database, person);
  JournalFile journal(journal_beside(database->path()));
  std::set<std::string> others = settle(*database, journal).gaze_deleted;
  others.erase(person);
  done.left = name_gaze_elsewhere(*database, others);
  write_changes(*database, person, request);
  done.gaze_deleted = before - count_gaze(*database, person);
  const auto left = clean_up(*database).left;
  done.left.insert(done.left.end(), left.begin(), left.end());
  if (request.gaze && !*request.gaze) {
    GazeElsewhere elsewhere = find_gaze_elsewhere(*database, person);
    done.backups = std::move(elsewhere.backups);
    done.gaze_exports = std::move(elsewhere.exports);
  }
  if (request.sharing && !*request.sharing) done.exports = public_exports_of(*database, person);
  return done;
}

void record_permission(Connection& database, std::int64_t session, const std::string& what, bool allowed,
                       const std::string& utc) {
  Statement(database,
            "UPDATE permission_change SET superseded = 1 "
            "WHERE session_id = ? AND what = ? AND superseded IS NOT 1")
      .bind_all(session, what)
      .run();
  Statement(database,
            "INSERT INTO permission_change (session_id, what, granted, utc, uid, turn, answers, showings, "
            "superseded) VALUES (?1, ?2, ?3, ?4, lower(hex(randomblob(16))), "
            "(SELECT coalesce(max(turn), 0) + 1 FROM permission_change WHERE session_id = ?1), "
            "coalesce((SELECT answers FROM permission_answer WHERE session_id = ?1 AND what = ?2), 0), "
            "(SELECT count(*) FROM presentation JOIN trial USING (trial_id) WHERE session_id = ?1), 0)")
      .bind_all(session, what, allowed ? 1 : 0, utc)
      .run();
}

SharingCount count_sharing(Connection& database) {
  // The people whom an export omits (granted = 0) refused in at least one session, or were asked and did not
  // answer. The column `said` is true for people who refused.
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

}  // namespace study
