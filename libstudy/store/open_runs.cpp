/// Functions of Store that read open runs and sessions, and that repeat or exclude trials.
#include "libstudy/store/store.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

std::vector<std::string> answered_questions(sqlite::Connection& database, std::int64_t unit) {
  Statement row(database,
                "SELECT DISTINCT q.question_id, q.code FROM response r JOIN question q USING (question_id) "
                "JOIN unit u USING (unit_id) LEFT JOIN trial t USING (trial_id) WHERE r.unit_id = ? "
                "AND r.attempt > coalesce(t.set_aside, -1) ORDER BY q.question_id");
  row.bind_all(unit);
  std::vector<std::string> ids;
  while (row.step()) ids.push_back(row.text(1));
  return ids;
}

PlannedTrial read_trial(const Statement& row, int block) {
  PlannedTrial trial;
  trial.position = static_cast<int>(row.integer(4));
  trial.block = block;
  trial.group = static_cast<int>(row.integer(5));
  trial.first = static_cast<int>(row.integer(6));
  if (!row.is_null(7)) trial.second = static_cast<int>(row.integer(7));
  trial.schedule_seed = static_cast<std::uint64_t>(row.integer(8));
  return trial;
}

std::vector<OpenUnit> open_units(sqlite::Connection& database, std::int64_t session) {
  Statement row(database,
                "SELECT u.unit_id, u.position, u.block_index, t.trial_id, t.position, t.group_index, "
                "t.first_cell, t.second_cell, t.schedule_seed, "
                "(SELECT coalesce(max(p.attempt), 0) FROM presentation p WHERE p.trial_id = t.trial_id), "
                "t.set_aside FROM unit u LEFT JOIN trial t USING (trial_id) "
                "WHERE u.session_id = ? AND u.state = 'planned' ORDER BY u.position");
  row.bind_all(session);
  std::vector<OpenUnit> units;
  while (row.step()) {
    OpenUnit unit;
    unit.id = row.integer(0);
    unit.plan.position = static_cast<int>(row.integer(1));
    unit.plan.block = static_cast<int>(row.integer(2));
    if (!row.is_null(3)) {
      unit.trial_id = row.integer(3);
      unit.trial = read_trial(row, unit.plan.block);
      unit.plan.trial = unit.trial->position;
      unit.attempts = static_cast<int>(row.integer(9));
      unit.begun = unit.attempts > row.integer(10);
    }
    unit.answered = answered_questions(database, unit.id);
    units.push_back(std::move(unit));
  }
  return units;
}

std::optional<std::string> optional_text(const Statement& row, int index) {
  if (row.is_null(index)) return {};
  return row.text(index);
}

std::optional<double> optional_real(const Statement& row, int index) {
  if (row.is_null(index)) return {};
  return row.real(index);
}

SessionPlan read_plan(const Statement& row) {
  SessionPlan plan;
  plan.participant = row.text(1);
  plan.visit = static_cast<int>(row.integer(2));
  plan.seed = static_cast<std::uint64_t>(row.integer(3));
  plan.plan.slot = static_cast<int>(row.integer(4));
  plan.test_data = row.integer(5) != 0;
  plan.observer = optional_text(row, 6);
  plan.virtual_clock = row.text(7) == "virtual";
  plan.display = row.text(8);
  plan.stimulus = row.text(9);
  plan.machine = row.text(10);
  plan.station = row.text(11);
  plan.time_zone = row.text(12);
  plan.gaze_source = row.text(13);
  plan.screen_width_mm = optional_real(row, 14);
  plan.viewing_distance_mm = optional_real(row, 15);
  plan.ptpe = optional_text(row, 16);
  plan.refresh_hz = optional_real(row, 19);
  return plan;
}

std::vector<OpenSession> open_sessions(sqlite::Connection& database, std::int64_t run,
                                       std::int64_t protocol) {
  Statement row(
      database,
      "SELECT session_id, participant, visit, seed, slot, test_data, observer, clock, display, "
      "stimulus, machine, station, time_zone, gaze_source, screen_width_mm, viewing_distance_mm, "
      "ptpe, (SELECT count(*) FROM unit u WHERE u.session_id = s.session_id), "
      "(SELECT count(*) FROM unit u WHERE u.session_id = s.session_id AND u.state = 'done'), "
      "refresh_hz FROM session s WHERE run_id = ? AND protocol_id = ? AND state = 'open' AND EXISTS "
      "(SELECT 1 FROM unit u WHERE u.session_id = s.session_id AND u.state = 'planned') "
      "ORDER BY session_id");
  row.bind_all(run, protocol);
  std::vector<OpenSession> sessions;
  while (row.step()) {
    OpenSession session;
    session.id = row.integer(0);
    session.plan = read_plan(row);
    session.planned = static_cast<std::size_t>(row.integer(17));
    session.done = static_cast<std::size_t>(row.integer(18));
    session.units = open_units(database, session.id);
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace

void Store::mark_cut_presentations() {
  Transaction transaction(*database_);
  Statement cut(*database_,
                "SELECT p.presentation_id, t.session_id FROM presentation p JOIN trial t USING (trial_id) "
                "WHERE p.state = 'running'");
  while (cut.step()) {
    insert_event(cut.integer(1), cut.integer(0), "trial interrupted", "the program had ended", {});
  }
  database_->execute("UPDATE presentation SET state = 'interrupted' WHERE state = 'running'");
  commit(transaction);
}

std::vector<std::string> Store::requested_withdrawals() { return study::requested_withdrawals(*database_); }

bool Store::has_shown(std::int64_t session) {
  Statement row(*database_, "SELECT 1 FROM presentation JOIN trial USING (trial_id) WHERE session_id = ?");
  return row.bind_all(session).step();
}

bool Store::has_answers(std::int64_t session) {
  Statement row(*database_, "SELECT 1 FROM response JOIN unit USING (unit_id) WHERE session_id = ?");
  return row.bind_all(session).step();
}

std::vector<OpenRun> Store::open_runs() {
  mark_cut_presentations();
  Statement row(
      *database_,
      "SELECT DISTINCT r.run_id, r.options, p.name, p.text, p.sha256, p.trial_seconds, p.protocol_id "
      "FROM run r JOIN session s USING (run_id) JOIN protocol p USING (protocol_id) "
      "ORDER BY r.run_id, p.protocol_id");
  std::vector<OpenRun> runs;
  while (row.step()) {
    OpenRun run;
    run.id = row.integer(0);
    run.options = row.text(1);
    run.protocol_name = row.text(2);
    run.protocol_text = row.text(3);
    run.protocol_sha256 = row.text(4);
    if (!row.is_null(5)) run.trial_seconds = row.real(5);
    run.sessions = open_sessions(*database_, run.id, row.integer(6));
    if (!run.sessions.empty()) runs.push_back(std::move(run));
  }
  return runs;
}

std::vector<std::optional<StationNumber>> Store::station_numbers(const std::string& protocol_sha256) {
  Statement row(*database_,
                "SELECT DISTINCT s.station_number, s.station_count FROM session s JOIN protocol p USING "
                "(protocol_id) WHERE p.sha256 = ? AND s.test_data = p.test_data AND s.state IN ('open', "
                "'done', 'stopped') ORDER BY 1, 2");
  row.bind_all(protocol_sha256);
  std::vector<std::optional<StationNumber>> numbers;
  while (row.step()) {
    numbers.emplace_back();
    if (!row.is_null(0))
      numbers.back() = StationNumber{static_cast<int>(row.integer(0)), static_cast<int>(row.integer(1))};
  }
  return numbers;
}

std::string Store::newest_utc() {
  Statement row(*database_,
                "SELECT coalesce(max(utc), '') FROM (SELECT max(utc) AS utc FROM event UNION ALL "
                "SELECT max(started_utc) FROM run UNION ALL SELECT max(answered_utc) FROM response)");
  return row.step() ? row.text(0) : "";
}

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
  // mark_done() has also marked the trial as answered. Resets the trial's state if it has no answer that
  // counts.
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
  throw base::Error(
      path_.string(),
      "lacks the trial of this session that was to be changed, or the trial has its answer already",
      "continue with vip-study resume; if this repeats, restore a backup of it");
}

void Store::choose_cells(std::int64_t session, std::int64_t trial, int first, std::optional<int> second) {
  Transaction transaction(*database_);
  Statement row(
      *database_,
      "UPDATE trial SET first_cell = ?3, second_cell = ?4 WHERE trial_id = ?1 AND session_id = ?2 AND "
      "state = 'planned' RETURNING trial_id");
  if (!row.bind_all(trial, session, first, second).step()) throw_no_trial();
  row.reset();
  commit(transaction);
}

std::vector<TrackAnswer> Store::track_answers(std::int64_t session, const std::string& question) {
  return answers_where("t.session_id = ?1", session, question);
}

std::vector<TrackAnswer> Store::earlier_answers(std::int64_t session, const std::string& question) {
  return answers_where(
      "t.session_id IN (SELECT earlier.session_id FROM session earlier JOIN session own "
      "ON own.protocol_id = earlier.protocol_id AND own.test_data = earlier.test_data "
      "AND (own.observer IS NULL) = (earlier.observer IS NULL) "
      "WHERE own.session_id = ?1 AND earlier.session_id < own.session_id)",
      session, question);
}

/// Answers of the sessions that `condition` selects with the session's number as ?1.
std::vector<TrackAnswer> Store::answers_where(const std::string& condition, std::int64_t session,
                                              const std::string& question) {
  Statement row(
      *database_,
      "SELECT t.first_cell, t.second_cell, r.score FROM trial t JOIN unit u USING (trial_id) JOIN judgement "
      "j "
      "ON j.unit_id = u.unit_id JOIN question q ON q.question_id = j.question_id JOIN response r ON "
      "r.response_id = j.response_id WHERE " +
          condition +
          " AND u.kind = 'stimulus' AND q.code = ?2 AND "
          "j.counts AND r.score IS NOT NULL AND u.state = 'done' ORDER BY t.session_id, t.position");
  std::vector<TrackAnswer> out;
  for (row.bind_all(session, question); row.step();) {
    TrackAnswer answer{static_cast<int>(row.integer(0)), {}, static_cast<int>(row.integer(2))};
    if (!row.is_null(1)) answer.second = static_cast<int>(row.integer(1));
    out.push_back(answer);
  }
  return out;
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
