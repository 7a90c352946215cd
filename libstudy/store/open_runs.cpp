/// What a database says is left to do.
#include "libstudy/store/store.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

std::vector<OpenTrial> open_trials(sqlite::Connection& database, std::int64_t session) {
  Statement row(database,
                "SELECT t.trial_id, t.position, t.setting, t.schedule_seed, "
                "(SELECT count(*) FROM presentation p WHERE p.trial_id = t.trial_id) "
                "FROM trial t WHERE t.session_id = ? AND t.state = 'planned' ORDER BY t.position");
  row.bind(0, session);
  std::vector<OpenTrial> trials;
  while (row.step()) {
    OpenTrial trial;
    trial.id = row.integer(0);
    trial.plan.position = static_cast<int>(row.integer(1));
    trial.plan.setting = static_cast<int>(row.integer(2));
    trial.plan.schedule_seed = static_cast<std::uint64_t>(row.integer(3));
    trial.attempts = static_cast<int>(row.integer(4));
    trials.push_back(trial);
  }
  return trials;
}

std::optional<std::string> optional_text(const Statement& row, int index) {
  if (row.is_null(index)) return {};
  return row.text(index);
}

std::vector<OpenSession> open_sessions(sqlite::Connection& database, std::int64_t run,
                                       std::int64_t protocol) {
  Statement row(database,
                "SELECT session_id, participant, visit, seed, test_data, observer, clock, display, stimulus, "
                "machine, time_zone, ptpe, (SELECT count(*) FROM trial t WHERE t.session_id = s.session_id), "
                "(SELECT count(*) FROM trial t WHERE t.session_id = s.session_id AND t.state = 'answered') "
                "FROM session s WHERE run_id = ? AND protocol_id = ? AND EXISTS (SELECT 1 FROM trial t "
                "WHERE t.session_id = s.session_id AND t.state = 'planned') ORDER BY session_id");
  row.bind(0, run).bind(1, protocol);
  std::vector<OpenSession> sessions;
  while (row.step()) {
    OpenSession session;
    session.id = row.integer(0);
    SessionPlan& plan = session.plan;
    plan.participant = row.text(1);
    plan.visit = static_cast<int>(row.integer(2));
    plan.seed = static_cast<std::uint64_t>(row.integer(3));
    plan.test_data = row.integer(4) != 0;
    plan.observer = optional_text(row, 5);
    plan.virtual_clock = row.text(6) == "virtual";
    plan.display = row.text(7);
    plan.stimulus = row.text(8);
    plan.machine = row.text(9);
    plan.time_zone = row.text(10);
    plan.ptpe = optional_text(row, 11);
    session.planned = static_cast<std::size_t>(row.integer(12));
    session.answered = static_cast<std::size_t>(row.integer(13));
    session.trials = open_trials(database, session.id);
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
  transaction.commit();
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

}  // namespace study
