#include "libstudy/store/store.hpp"

#include <array>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/settling.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Statement;
using sqlite::Transaction;

/// The SQL statements of a Store that run for every frame, event, showing or answer, prepared once.
struct Store::Statements {
  explicit Statements(sqlite::Connection& database)
      : frame(database,
              "INSERT INTO frame VALUES "
              "(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        event(database,
              "INSERT INTO event (session_id, presentation_id, utc, clock_ns, kind, detail) VALUES "
              "(?,?,?,?,?,?)"),
        begin(database,
              "INSERT INTO presentation (trial_id, attempt, interval, cell, state, started_utc, start_ns, "
              "framing_id, gaze_source) SELECT ?1, ?2, ?3, ?4, 'running', ?5, ?6, (SELECT max(f.framing_id) "
              "FROM "
              "trial t JOIN framing f USING (session_id) WHERE t.trial_id = ?1 AND "
              "instr(' ' || f.cells || ' ', ' ' || ?4 || ' ')), coalesce(?7, (SELECT gaze_source FROM trial "
              "JOIN session USING (session_id) WHERE trial_id = ?1))"),
        end(database,
            "UPDATE presentation SET state = 'played', end_ns = ?, verdict = ?, grade = ?, reason = ?, "
            "frames = ?, mean_fps = ?, mean_arithmetic_fps = ?, sd_fps = ?, p95_ms = ?, longest_ms = ?, "
            "shortest_ms = ?, lag1 = ?, late_frames = ?, worst_late_ms = ?, "
            "p99_ms = ?, hitches = ?, animation_error_ms = ? WHERE presentation_id = ?"),
        // Inserts no answer if the question is personal, the unit is done or of another session, or the
        // question was answered since the trial was last set aside.
        response(database,
                 "INSERT INTO response (unit_id, attempt, question_id, score, words, response_time_s, "
                 "answered_utc, input) SELECT u.unit_id, ?3, q.question_id, ?5, ?6, ?7, ?8, ?9 "
                 "FROM unit u JOIN session s USING (session_id) JOIN question q USING (protocol_id) "
                 "LEFT JOIN trial t USING (trial_id) WHERE s.session_id = ?1 AND u.unit_id = ?2 "
                 "AND q.code = ?4 AND q.personal = 0 AND u.state = 'planned' AND NOT EXISTS "
                 "(SELECT 1 FROM response r WHERE r.unit_id = u.unit_id AND r.question_id = q.question_id "
                 "AND r.attempt > coalesce(t.set_aside, -1)) RETURNING response_id") {}
  sqlite::Statement frame, event, begin, end, response;
};

namespace {

const char* state_name(EarlyEnd how) {
  if (how == EarlyEnd::Refused) return "refused";
  if (how == EarlyEnd::NotEligible) return "not eligible";
  return how == EarlyEnd::Stopped ? "stopped" : "dropped out";
}

std::optional<std::string> input_name(const std::optional<AnswerInput>& input) {
  constexpr std::array names{"keyboard", "mouse", "gamepad", "ray", "stick", "dwell", "observer"};
  if (!input) return {};
  return names.at(static_cast<std::size_t>(*input));
}

std::optional<std::string> words_of(const Answer& answer) {
  if (answer.words.empty()) return {};
  return answer.words;
}

/// A time relative to origin_ns; none if the time is not known (negative).
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

/// The member of an optional group of a frame's facts; none if the frame lacks the group.
template <class Part, class Value>
std::optional<Value> part(const std::optional<Part>& whole, Value Part::*member) {
  if (!whole) return {};
  return (*whole).*member;
}
template <class Part, class Value>
std::optional<Value> part(const std::optional<Part>& whole, std::optional<Value> Part::*member) {
  if (!whole) return {};
  return (*whole).*member;
}

}  // namespace

Store::Store(const fs::path& path, sqlite::Open how, std::int64_t max_pages, const sqlite::Waiting& waiting)
    : path_(real_file(path)), lock_(std::in_place, path_, how) {
  database_ = open_database(path_, how, read_schema_steps(), max_pages, waiting);
  left_ = settle_before_writing(*database_);
  const auto cleaned = clean_up(*database_).left;
  left_.insert(left_.end(), cleaned.begin(), cleaned.end());
  for (const std::string& participant : study::requested_withdrawals(*database_)) {
    const auto left = withdraw(*database_, participant).beside.left;
    left_.insert(left_.end(), left.begin(), left.end());
  }
  statements_ = std::make_unique<Statements>(*database_);
  journal_ = std::make_unique<AnswerJournal>(*database_);
  // A new database may already have a run: settle() inserted it from the journal that an earlier database at
  // this path left.
  if (!lock_->made() || database_->integer("SELECT EXISTS (SELECT 1 FROM run)") == 1) keep_file();
}

// C++ destroys members in reverse order, so lock_ is released after SQLite has closed the file.
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

void Store::tell_of_journal(const std::function<void(const std::string&)>& tell) {
  journal_->tell_with(tell);
}

void Store::require_journal() { journal_->require_written(); }

void Store::keep_file() {
  lock_->keep();
  database_->go_on_with("run vip-study resume --db " + path_.string() + "; all answers given are kept");
}

void Store::commit(Transaction& transaction) {
  if (given_up_) {
    throw sqlite::LockedOut(path_.string(), "was locked by another program; nothing more is written now",
                            "close that program, then run vip-study resume --db " + path_.string());
  }
  journal_->write();
  transaction.commit();
  if (lock_) journal_->kept();
}

std::int64_t Store::begin_presentation(std::int64_t session, std::int64_t trial, int attempt, int interval,
                                       int cell, std::int64_t start_ns,
                                       const std::optional<std::string>& gaze_source) {
  Transaction transaction(*database_);
  const std::string now = base::utc_now();
  Statement& begin = statements_->begin;
  const std::int64_t id = begin.bind_all(trial, attempt, interval, cell, now, start_ns, gaze_source).run();
  Statement(*database_, "UPDATE session SET started_utc = ? WHERE session_id = ? AND started_utc IS NULL")
      .bind_all(now, session)
      .run();
  insert_event(session, id, "trial shown",
               "attempt " + std::to_string(attempt) + ", interval " + std::to_string(interval), start_ns);
  commit(transaction);
  return id;
}

void Store::end_presentation(std::int64_t presentation, std::int64_t start_ns, std::int64_t end_ns,
                             std::span<const FrameRecord> frames, const TimingVerdict& verdict) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  Statement& end = statements_->end;
  std::optional<std::string> judged, reason;
  if (verdict.nominal.mean > 0 || verdict.cut) {
    judged = verdict_name(verdict.verdict);
    reason = verdict.reason;
  }
  end.bind_all(end_ns, judged, grade_name(verdict.grade), reason,
               static_cast<std::int64_t>(verdict.realised.frames), verdict.realised.mean,
               verdict.realised.mean_arithmetic, verdict.realised.sd, verdict.p95_ms, verdict.longest_ms,
               verdict.shortest_ms, verdict.lag1, verdict.late, verdict.worst_late_ms, verdict.p99_ms,
               verdict.hitches, verdict.animation_error_ms, presentation)
      .run();
  commit(transaction);
}

void Store::interrupt_presentation(std::int64_t session, std::int64_t presentation, const std::string& why,
                                   std::int64_t clock_ns) {
  Transaction transaction(*database_);
  Statement(*database_, "UPDATE presentation SET state = 'interrupted' WHERE presentation_id = ?")
      .bind_all(presentation)
      .run();
  insert_event(session, presentation, "trial interrupted", why, clock_ns);
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
    insert.bind_all(session, unit.id, attempt, kept.question, answer.score, words_of(answer),
                    kept.answer.response_time_s, now, input_name(kept.answer.input));
    const bool taken = insert.step();
    insert.reset();
    if (!taken) {
      throw base::Error(
          path_.string(),
          "takes no answer to question '" + kept.question +
              "' here: the question is unknown, personal or already answered, or its page is done",
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
  if (!done.bind_all(now, unit, session).step())
    throw base::Error(path_.string(),
                      "has no unit " + std::to_string(unit) + " of session " + std::to_string(session),
                      "restore a backup of it");
  const std::string where = "unit " + done.text(0);
  done.reset();
  Statement(*database_,
            "UPDATE trial SET state = 'answered' WHERE trial_id = "
            "(SELECT trial_id FROM unit WHERE unit_id = ?)")
      .bind_all(unit)
      .run();
  Statement(*database_,
            "UPDATE session SET state = 'done', ended_utc = ?2 WHERE session_id = ?1 AND state = 'open' "
            "AND NOT EXISTS (SELECT 1 FROM unit u WHERE u.session_id = ?1 AND u.state = 'planned')")
      .bind_all(session, now)
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
      .bind_all(state_name(ending.how), base::utc_now(), session)
      .run();
  insert_event(session, {}, "ended early", state_name(ending.how), clock_ns);
  if (!ending.reason.empty()) insert_note(session, {}, ending.reason);
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
      .bind_all(session, unit, base::utc_now(), words)
      .run();
}

void Store::insert_event(std::optional<std::int64_t> session, std::optional<std::int64_t> presentation,
                         const std::string& kind, const std::string& detail,
                         std::optional<std::int64_t> clock_ns) {
  Statement& insert = statements_->event;
  insert.bind_all(session, presentation, base::utc_now(), clock_ns, kind, detail).run();
}

void Store::log(std::optional<std::int64_t> session, const std::string& kind, const std::string& detail,
                std::optional<std::int64_t> clock_ns) {
  Transaction transaction(*database_);
  insert_event(session, {}, kind, detail, clock_ns);
  commit(transaction);
}

void Store::insert_frames(std::int64_t presentation, std::int64_t start_ns,
                          std::span<const FrameRecord> frames) {
  Statement& insert = statements_->frame;
  for (const FrameRecord& frame : frames) {
    const std::int64_t due = frame.scheduled_ns;
    const FrameFacts& facts = frame.facts;
    insert
        .bind_all(
            presentation, frame.index, frame.content_step, facts.simulation_time_s, due - start_ns,
            after(frame.times.submitted_ns, due), after(frame.times.gpu_done_ns, due),
            after(frame.times.predicted_display_ns, due), after(frame.times.actual_display_ns, due),
            frame.late ? 1 : 0, particles_text(facts.particles_by_level),
            part(facts.tolerance, &FrameTolerance::active_fraction),
            part(facts.tolerance, &FrameTolerance::tau_fps), part(facts.tolerance, &FrameTolerance::beta),
            part(facts.tolerance, &FrameTolerance::mu_fps), part(facts.tolerance, &FrameTolerance::delta_fps),
            part(facts.guards, &FrameGuards::speed_limited),
            part(facts.guards, &FrameGuards::coincident_pairs), part(facts.guards, &FrameGuards::not_finite),
            part(facts.guards, &FrameGuards::neighbours_dropped),
            part(facts.guards, &FrameGuards::wall_projected), part(facts.guards, &FrameGuards::nozzle_waited),
            part(facts.guards, &FrameGuards::saliency_not_finite),
            part(facts.guards, &FrameGuards::gaze_lost))
        .run();
  }
}

void Store::add_frames(std::int64_t presentation, std::int64_t start_ns,
                       std::span<const FrameRecord> frames) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  commit(transaction);
}

}  // namespace study
