/// Store: repeats and excludes trials.
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

void Store::repeat_trial(std::int64_t session, std::int64_t trial, const std::string& reason) {
  Transaction transaction(*database_);
  set_trial_aside(session, trial);
  if (!reason.empty()) insert_note(session, trial_unit(trial), reason);
  commit(transaction);
}

void Store::restart_block(std::int64_t session, int block, const std::string& reason) {
  Transaction transaction(*database_);
  std::vector<std::int64_t> begun;
  Statement row(*database_,
                "SELECT DISTINCT u.trial_id FROM unit u JOIN presentation p USING (trial_id) "
                "WHERE u.session_id = ? AND u.block_index = ? ORDER BY u.position");
  for (row.bind_all(session, block); row.step();) begun.push_back(row.integer(0));
  for (const std::int64_t trial : begun) set_trial_aside(session, trial);
  if (!reason.empty()) insert_note(session, {}, reason);
  commit(transaction);
}

void Store::set_trial_aside(std::int64_t session, std::int64_t trial) {
  Statement open(*database_,
                 "UPDATE trial SET state = 'planned', set_aside = (SELECT coalesce(max(attempt), 0) "
                 "FROM presentation p WHERE p.trial_id = ?1) WHERE trial_id = ?1 AND session_id = ?2 "
                 "RETURNING position");
  if (!open.bind_all(trial, session).step()) throw_no_trial();
  const std::string where = "trial " + open.text(0);
  open.reset();
  Statement(*database_, "UPDATE unit SET state = 'planned', done_utc = NULL WHERE trial_id = ?")
      .bind_all(trial)
      .run();
  Statement(*database_,
            "UPDATE session SET state = 'open', ended_utc = NULL WHERE session_id = ? AND state = 'done'")
      .bind_all(session)
      .run();
  insert_event(session, {}, "trial set aside", where, {});
}

void Store::leave_out_trial(std::int64_t session, const OpenUnit& unit, const std::string& reason) {
  Transaction transaction(*database_);
  mark_excluded(session, unit.trial_id, reason);
  mark_done(session, unit.id, base::utc_now(), {});
  // The unit is done, but the trial has no answer.
  Statement(*database_,
            "UPDATE trial SET state = 'planned' WHERE trial_id = ?1 AND NOT EXISTS (SELECT 1 FROM response "
            "r JOIN unit u USING (unit_id) WHERE u.trial_id = ?1 AND r.attempt > trial.set_aside)")
      .bind_all(unit.trial_id)
      .run();
  commit(transaction);
}

void Store::exclude_trial(std::int64_t session, std::int64_t trial, const std::string& reason) {
  if (reason.empty())
    throw base::Error("exclusion of a trial", "has no reason", "say why the analyses shall leave it out");
  Transaction transaction(*database_);
  mark_excluded(session, trial, reason);
  commit(transaction);
}

void Store::mark_excluded(std::int64_t session, std::int64_t trial, const std::string& reason) {
  Statement exclude(*database_,
                    "UPDATE trial SET excluded = ?3 WHERE trial_id = ?1 AND session_id = ?2 "
                    "RETURNING position");
  if (!exclude.bind_all(trial, session, reason).step()) throw_no_trial();
  const std::string where = "trial " + exclude.text(0);
  exclude.reset();
  insert_event(session, {}, "trial excluded", where, {});
}

void Store::throw_no_trial() const {
  throw base::Error(path_.string(), "holds no such trial of this session", "name a trial of the session");
}

bool Store::set_aside(const OpenUnit& unit, int attempt) {
  Statement row(*database_, "SELECT 1 FROM trial WHERE trial_id = ? AND set_aside >= ?");
  return row.bind_all(unit.trial_id, attempt).step();
}

std::int64_t Store::trial_unit(std::int64_t trial) {
  Statement row(*database_, "SELECT unit_id FROM unit WHERE trial_id = ?");
  return row.bind_all(trial).step() ? row.integer(0) : 0;
}

}  // namespace study
