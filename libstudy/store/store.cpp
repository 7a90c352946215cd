#include "libstudy/store/store.hpp"

#include <regex>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/beside.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/database.hpp"
#include "libstudy/store/names.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// A time relative to another; nothing when it is not known.
std::optional<std::int64_t> after(std::int64_t time_ns, std::int64_t origin_ns) {
  if (time_ns < 0) return {};
  return time_ns - origin_ns;
}

std::optional<std::string> particles_text(const std::vector<std::int64_t>& particles) {
  if (particles.empty()) return {};
  std::string text;
  for (const auto count : particles) text += (text.empty() ? "" : " ") + std::to_string(count);
  return text;
}

/// Columns 10 to 23 of a frame; what nobody measured is NULL.
void bind_facts(Statement& insert, const FrameFacts& facts) {
  insert.bind(10, particles_text(facts.particles_by_level));
  for (int column = 11; column <= 23; ++column) insert.bind_null(column);
  if (const auto& t = facts.tolerance) {
    insert.bind(11, t->active_fraction).bind(12, t->tau_fps).bind(13, t->beta);
    insert.bind(14, t->mu_fps).bind(15, t->delta_fps);
  }
  if (const auto& g = facts.guards) {
    insert.bind(16, g->speed_limited).bind(17, g->coincident_pairs).bind(18, g->not_finite);
    insert.bind(19, g->neighbours_dropped).bind(20, g->wall_projected).bind(21, g->nozzle_waited);
    insert.bind(22, g->saliency_not_finite).bind(23, g->gaze_lost);
  }
}

const char* state_name(EarlyEnd how) {
  if (how == EarlyEnd::NotEligible) return "not eligible";
  return how == EarlyEnd::Stopped ? "stopped" : "dropped out";
}

std::optional<std::string> words_of(const Answer& answer) {
  if (answer.words.empty()) return {};
  return answer.words;
}

}  // namespace

void check_participant_code(const std::string& code) {
  static const std::regex pattern("[A-Za-z0-9][A-Za-z0-9_-]{0,31}");
  if (code.size() > 32 || !std::regex_match(code, pattern)) {
    throw base::Error("participant '" + base::shortened(code) + "'", "is not a participant code",
                      "use 1 to 32 letters, digits, _ or -, a letter or digit first, and never a name");
  }
}

struct Store::Statements {
  explicit Statements(sqlite::Connection& database)
      : frame(database,
              "INSERT INTO frame VALUES "
              "(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        event(database,
              "INSERT INTO event (session_id, presentation_id, utc, clock_ns, kind, detail) VALUES "
              "(?,?,?,?,?,?)"),
        begin(database,
              "INSERT INTO presentation (trial_id, attempt, interval, cell, state, started_utc, start_ns) "
              "VALUES (?,?,?,?,'running',?,?)"),
        end(database,
            "UPDATE presentation SET state = 'played', end_ns = ?, verdict = ?, grade = ?, reason = ?, "
            "frames = ?, mean_fps = ?, mean_arithmetic_fps = ?, sd_fps = ?, p95_ms = ?, longest_ms = ?, "
            "shortest_ms = ?, lag1 = ?, late_frames = ?, worst_late_ms = ? WHERE presentation_id = ?"),
        // No answer to what is personal, done, of another session or answered since it was last set aside.
        response(database,
                 "INSERT INTO response (unit_id, attempt, question_id, score, words, response_time_s, "
                 "answered_utc) SELECT u.unit_id, ?3, q.question_id, ?5, ?6, ?7, ?8 "
                 "FROM unit u JOIN session s USING (session_id) JOIN question q USING (protocol_id) "
                 "LEFT JOIN trial t USING (trial_id) WHERE s.session_id = ?1 AND u.unit_id = ?2 "
                 "AND q.code = ?4 AND q.personal = 0 AND u.state = 'planned' AND NOT EXISTS "
                 "(SELECT 1 FROM response r WHERE r.unit_id = u.unit_id AND r.question_id = q.question_id "
                 "AND r.attempt > coalesce(t.set_aside, -1)) RETURNING response_id") {}
  Statement frame, event, begin, end, response;
};

Store::Store(const fs::path& path, sqlite::Open how, std::int64_t max_pages, const sqlite::Waiting& waiting)
    : path_(real_file(path)), lock_(std::in_place, path_, how) {
  database_ = open_database(path_, how, read_schema_steps(), max_pages, waiting);
  left_ = clean_up(*database_).left;
  statements_ = std::make_unique<Statements>(*database_);
  journal_ = std::make_unique<AnswerJournal>(*database_);
  // A new database may have a plan: the journal's, whose commit was under way when an earlier one was given
  // up.
  if (!lock_->made() || database_->integer("SELECT EXISTS (SELECT 1 FROM run)") == 1) keep_file();
}

// Members go in the reverse of their order: the lock is given back after SQLite has closed the file.
Store::~Store() {
  if (lock_ && lock_->made()) journal_->remove_if_blank();
}

Store::Store(Store& locked)
    : path_(locked.path_), database_(std::make_unique<sqlite::Connection>(path_, sqlite::Temporary{})) {
  database_->copy_from(*locked.database_);
  statements_ = std::make_unique<Statements>(*database_);
  journal_ = std::make_unique<AnswerJournal>(*database_);
}

void Store::make(const std::function<void(Store&)>& change) {
  try {
    change(*this);
  } catch (const sqlite::LockedOut&) {
    const std::lock_guard guard(copying_);
    given_up_ = true;
    if (!copy_) copy_.reset(new Store(*this));
    change(*copy_);
    throw;
  }
}

void Store::keep_file() {
  lock_->keep();
  database_->go_on_with("run vip-study resume --db " + path_.string() + "; all answers given are kept");
}

void Store::commit(Transaction& transaction) {
  if (given_up_) {
    throw sqlite::LockedOut(path_.string(), "was locked by another program; nothing more is written now",
                            "run vip-study resume --db " + path_.string());
  }
  journal_->write();
  transaction.commit();
  if (lock_) journal_->kept();
}

std::int64_t Store::begin_presentation(std::int64_t session, std::int64_t trial, int attempt, int interval,
                                       int cell, std::int64_t start_ns) {
  Transaction transaction(*database_);
  const std::string now = base::utc_now();
  Statement& begin = statements_->begin;
  begin.bind(0, trial).bind(1, attempt).bind(2, interval).bind(3, cell).bind(4, now).bind(5, start_ns);
  const std::int64_t id = begin.run();
  Statement(*database_, "UPDATE session SET started_utc = ? WHERE session_id = ? AND started_utc IS NULL")
      .bind(0, now)
      .bind(1, session)
      .run();
  insert_event(session, id, "trial shown",
               "attempt " + std::to_string(attempt) + ", interval " + std::to_string(interval), start_ns);
  commit(transaction);
  return id;
}

void Store::insert_frames(std::int64_t presentation, std::int64_t start_ns,
                          std::span<const FrameRecord> frames) {
  Statement& insert = statements_->frame;
  for (const FrameRecord& frame : frames) {
    const std::int64_t due = frame.scheduled_ns;
    insert.bind(0, presentation).bind(1, frame.index).bind(2, frame.content_step);
    insert.bind(3, frame.facts.simulation_time_s).bind(4, due - start_ns);
    insert.bind(5, after(frame.times.submitted_ns, due)).bind(6, after(frame.times.gpu_done_ns, due));
    insert.bind(7, after(frame.times.predicted_display_ns, due))
        .bind(8, after(frame.times.actual_display_ns, due));
    insert.bind(9, frame.late ? 1 : 0);
    bind_facts(insert, frame.facts);
    insert.run();
  }
}

void Store::add_frames(std::int64_t presentation, std::int64_t start_ns,
                       std::span<const FrameRecord> frames) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  commit(transaction);
}

void Store::end_presentation(std::int64_t presentation, std::int64_t start_ns, std::int64_t end_ns,
                             std::span<const FrameRecord> frames, const TimingVerdict& verdict) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  Statement& end = statements_->end;
  end.bind(0, end_ns).bind_null(1).bind(2, grade_name(verdict.grade)).bind_null(3);
  if (verdict.nominal.mean > 0) end.bind(1, verdict_name(verdict.verdict)).bind(3, verdict.reason);
  end.bind(4, static_cast<std::int64_t>(verdict.realised.frames));
  end.bind(5, verdict.realised.mean).bind(6, verdict.realised.mean_arithmetic).bind(7, verdict.realised.sd);
  end.bind(8, verdict.p95_ms)
      .bind(9, verdict.longest_ms)
      .bind(10, verdict.shortest_ms)
      .bind(11, verdict.lag1);
  end.bind(12, verdict.late).bind(13, verdict.worst_late_ms).bind(14, presentation);
  end.run();
  commit(transaction);
}

void Store::interrupt_presentation(std::int64_t session, std::int64_t presentation, std::int64_t clock_ns) {
  Transaction transaction(*database_);
  Statement(*database_, "UPDATE presentation SET state = 'interrupted' WHERE presentation_id = ?")
      .bind(0, presentation)
      .run();
  insert_event(session, presentation, "trial interrupted", "stopped on request", clock_ns);
  commit(transaction);
}

void Store::answer(std::int64_t session, const OpenUnit& unit, int attempt,
                   std::span<const KeptAnswer> answers, bool last, std::int64_t clock_ns,
                   const std::optional<Ending>& ending) {
  make([&](Store& store) { store.write_answers(session, unit, attempt, answers, last, clock_ns, ending); });
}

void Store::write_answers(std::int64_t session, const OpenUnit& unit, int attempt,
                          std::span<const KeptAnswer> answers, bool last, std::int64_t clock_ns,
                          const std::optional<Ending>& ending) {
  Transaction transaction(*database_);
  const std::string now = base::utc_now();
  Statement& insert = statements_->response;
  for (const KeptAnswer& kept : answers) {
    const Answer& answer = kept.answer.answer;
    insert.bind(0, session).bind(1, unit.id).bind(2, attempt).bind(3, kept.question);
    insert.bind(4, answer.score).bind(5, words_of(answer)).bind(6, kept.answer.response_time_s);
    const bool taken = insert.bind(7, now).step();
    insert.reset();
    if (!taken) {
      throw base::Error(
          path_.string(),
          "takes no answer to question '" + kept.question + "' here: unknown, personal or answered before",
          "run vip-study resume, which asks what is open");
    }
  }
  for (const KeptAnswer& kept : answers) answer_over_change(session, kept.question, now);
  const std::string where = "unit " + std::to_string(unit.plan.position);
  if (!answers.empty()) insert_event(session, {}, "answered", where, clock_ns);
  if (ending) mark_ended(session, *ending, clock_ns);
  if (last && !set_aside(unit, attempt)) mark_done(session, unit.id, now, clock_ns);
  commit(transaction);
}

void Store::finish_unit(std::int64_t session, std::int64_t unit, std::int64_t clock_ns) {
  Transaction transaction(*database_);
  mark_done(session, unit, base::utc_now(), clock_ns);
  commit(transaction);
}

void Store::mark_done(std::int64_t session, std::int64_t unit, const std::string& now,
                      std::optional<std::int64_t> clock_ns) {
  Statement done(*database_,
                 "UPDATE unit SET state = 'done', done_utc = ? WHERE unit_id = ? AND session_id = ? "
                 "RETURNING position");
  if (!done.bind(0, now).bind(1, unit).bind(2, session).step())
    throw base::Error(path_.string(), "holds no such unit of this session", "restore a backup of it");
  const std::string where = "unit " + done.text(0);
  done.reset();
  Statement(*database_,
            "UPDATE trial SET state = 'answered' WHERE trial_id = "
            "(SELECT trial_id FROM unit WHERE unit_id = ?)")
      .bind(0, unit)
      .run();
  Statement(*database_,
            "UPDATE session SET state = 'done', ended_utc = ?2 WHERE session_id = ?1 AND state = 'open' "
            "AND NOT EXISTS (SELECT 1 FROM unit u WHERE u.session_id = ?1 AND u.state = 'planned')")
      .bind(0, session)
      .bind(1, now)
      .run();
  insert_event(session, {}, "done", where, clock_ns);
}

void Store::end_session(std::int64_t session, const Ending& ending, std::int64_t clock_ns) {
  Transaction transaction(*database_);
  mark_ended(session, ending, clock_ns);
  commit(transaction);
}

void Store::mark_ended(std::int64_t session, const Ending& ending, std::int64_t clock_ns) {
  Statement(*database_, "UPDATE session SET state = ?, ended_utc = ? WHERE session_id = ? AND state = 'open'")
      .bind(0, state_name(ending.how))
      .bind(1, base::utc_now())
      .bind(2, session)
      .run();
  insert_event(session, {}, "ended early", state_name(ending.how), clock_ns);
  if (!ending.reason.empty()) insert_note(session, {}, ending.reason);
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
  for (row.bind(0, session).bind(1, block); row.step();) begun.push_back(row.integer(0));
  for (const std::int64_t trial : begun) set_trial_aside(session, trial);
  if (!reason.empty()) insert_note(session, {}, reason);
  commit(transaction);
}

void Store::set_trial_aside(std::int64_t session, std::int64_t trial) {
  Statement open(*database_,
                 "UPDATE trial SET state = 'planned', set_aside = (SELECT coalesce(max(attempt), 0) "
                 "FROM presentation p WHERE p.trial_id = ?1) WHERE trial_id = ?1 AND session_id = ?2 "
                 "RETURNING position");
  if (!open.bind(0, trial).bind(1, session).step()) throw_no_trial();
  const std::string where = "trial " + open.text(0);
  open.reset();
  Statement(*database_, "UPDATE unit SET state = 'planned', done_utc = NULL WHERE trial_id = ?")
      .bind(0, trial)
      .run();
  Statement(*database_,
            "UPDATE session SET state = 'open', ended_utc = NULL WHERE session_id = ? AND state = 'done'")
      .bind(0, session)
      .run();
  insert_event(session, {}, "trial set aside", where, {});
}

void Store::leave_out_trial(std::int64_t session, const OpenUnit& unit, const std::string& reason) {
  Transaction transaction(*database_);
  mark_excluded(session, unit.trial_id, reason);
  mark_done(session, unit.id, base::utc_now(), {});
  // Done, but nobody judged it.
  Statement(*database_,
            "UPDATE trial SET state = 'planned' WHERE trial_id = ?1 AND NOT EXISTS (SELECT 1 FROM response "
            "r JOIN unit u USING (unit_id) WHERE u.trial_id = ?1 AND r.attempt > trial.set_aside)")
      .bind(0, unit.trial_id)
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
  if (!exclude.bind(0, trial).bind(1, session).bind(2, reason).step()) throw_no_trial();
  const std::string where = "trial " + exclude.text(0);
  exclude.reset();
  insert_event(session, {}, "trial excluded", where, {});
}

void Store::throw_no_trial() const {
  throw base::Error(path_.string(), "holds no such trial of this session", "name a trial of the session");
}

bool Store::set_aside(const OpenUnit& unit, int attempt) {
  Statement row(*database_, "SELECT 1 FROM trial WHERE trial_id = ? AND set_aside >= ?");
  return row.bind(0, unit.trial_id).bind(1, attempt).step();
}

std::int64_t Store::trial_unit(std::int64_t trial) {
  Statement row(*database_, "SELECT unit_id FROM unit WHERE trial_id = ?");
  return row.bind(0, trial).step() ? row.integer(0) : 0;
}

void Store::note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words) {
  make([&](Store& store) { store.write_note(session, unit, words); });
}

void Store::write_note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words) {
  Transaction transaction(*database_);
  insert_note(session, unit, words);
  insert_event(session, {}, "note", "", {});
  commit(transaction);
}

void Store::insert_note(std::int64_t session, std::optional<std::int64_t> unit, const std::string& words) {
  Statement(*database_, "INSERT INTO note (session_id, unit_id, utc, words) VALUES (?,?,?,?)")
      .bind(0, session)
      .bind(1, unit)
      .bind(2, base::utc_now())
      .bind(3, words)
      .run();
}

void Store::insert_event(std::optional<std::int64_t> session, std::optional<std::int64_t> presentation,
                         const std::string& kind, const std::string& detail,
                         std::optional<std::int64_t> clock_ns) {
  Statement& insert = statements_->event;
  insert.bind(0, session).bind(1, presentation).bind(2, base::utc_now()).bind(3, clock_ns);
  insert.bind(4, kind).bind(5, detail).run();
}

void Store::log(std::optional<std::int64_t> session, const std::string& kind, const std::string& detail,
                std::optional<std::int64_t> clock_ns) {
  Transaction transaction(*database_);
  insert_event(session, {}, kind, detail, clock_ns);
  commit(transaction);
}

}  // namespace study
