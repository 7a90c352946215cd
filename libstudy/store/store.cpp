#include "libstudy/store/store.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <regex>

#include "libstudy/store/database.hpp"
#include "libstudy/store/names.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

std::int64_t as_signed(std::uint64_t value) { return static_cast<std::int64_t>(value); }

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

std::string anchors_text(const Question& question) {
  std::string text;
  for (const auto& [score, words] : question.anchors) {
    text += (text.empty() ? "" : "\n") + std::to_string(score) + " = " + words;
  }
  return text;
}

}  // namespace

void check_participant_code(const std::string& code) {
  static const std::regex pattern("[A-Za-z0-9_-]{1,32}");
  if (!std::regex_match(code, pattern)) {
    throw base::Error("participant '" + code + "'", "is not a participant code",
                      "use 1 to 32 letters, digits, _ or -, and never a name");
  }
}

/// Held on the file itself, so that it ends with the process however that ends.
class Store::Lock {
 public:
  explicit Lock(const fs::path& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (fd_ >= 0 && ::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd_);
      throw base::Error(path.string(), "another vip-study is running on this database",
                        "wait until it has ended");
    }
  }
  ~Lock() {
    if (fd_ >= 0) ::close(fd_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int fd_;
};

struct Store::Statements {
  explicit Statements(sqlite::Connection& database)
      : frame(database, "INSERT INTO frame VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        event(database,
              "INSERT INTO event (session_id, presentation_id, utc, clock_ns, kind, detail) VALUES "
              "(?,?,?,?,?,?)"),
        begin(database,
              "INSERT INTO presentation (trial_id, attempt, state, started_utc, start_ns) VALUES "
              "(?,?,'running',?,?)"),
        end(database,
            "UPDATE presentation SET state = 'played', end_ns = ?, verdict = ?, grade = ?, reason = ?, "
            "frames = ?, "
            "mean_fps = ?, mean_arithmetic_fps = ?, sd_fps = ?, p95_ms = ?, longest_ms = ?, shortest_ms = ?, "
            "lag1 = ?, late_frames = ?, worst_late_ms = ? WHERE presentation_id = ?"),
        response(
            database,
            "INSERT INTO response (trial_id, presentation_id, question_id, score, response_time_s, "
            "answered_utc) "
            "SELECT ?1, ?2, q.question_id, ?4, ?5, ?6 FROM question q JOIN session s USING (protocol_id) "
            "WHERE s.session_id = ?7 AND q.code = ?3 RETURNING response_id"),
        answered(database, "UPDATE trial SET state = 'answered' WHERE trial_id = ?"),
        ended(database,
              "UPDATE session SET ended_utc = ?2 WHERE session_id = ?1 AND NOT EXISTS "
              "(SELECT 1 FROM trial t WHERE t.session_id = ?1 AND t.state = 'planned')") {}
  Statement frame, event, begin, end, response, answered, ended;
};

Store::Store(const fs::path& path, sqlite::Open how, std::int64_t max_pages) : path_(path) {
  std::error_code ignored;
  const bool existed = fs::exists(path, ignored);
  if (existed) lock_ = std::make_unique<Lock>(path);
  const SchemaSteps steps = read_schema_steps();
  database_ = open_database(path, how, steps, max_pages);
  if (!existed) lock_ = std::make_unique<Lock>(path);
  blank_ = !existed;
  statements_ = std::make_unique<Statements>(*database_);
}

// The lock is given back after SQLite has closed the file.
Store::~Store() {
  statements_.reset();
  database_.reset();
  std::error_code ignored;
  if (blank_) fs::remove(path_, ignored);
}

std::int64_t Store::add_run(const RunPlan& run) {
  Transaction transaction(*database_);
  const std::int64_t protocol_id = find_or_add_protocol(run);
  const std::int64_t run_id =
      Statement(*database_, "INSERT INTO run (started_utc, program_version, options) VALUES (?,?,?)")
          .bind(0, base::utc_now())
          .bind(1, base::version())
          .bind(2, run.options)
          .run();
  for (const SessionPlan& plan : run.sessions) add_session(run_id, protocol_id, run.protocol, plan);
  transaction.commit();
  blank_ = false;
  return run_id;
}

std::int64_t Store::find_or_add_protocol(const RunPlan& run) {
  const Protocol& protocol = run.protocol;
  Statement same(*database_, "SELECT protocol_id FROM protocol WHERE sha256 = ?");
  if (same.bind(0, protocol.sha256).step()) return same.integer(0);

  Statement changed(*database_,
                    "SELECT sha256 FROM protocol WHERE name = ? AND version = ? AND test_data = 0");
  if (!protocol.test_data && changed.bind(0, protocol.name).bind(1, protocol.version).step()) {
    throw base::Error(database_->path().string(),
                      "protocol '" + protocol.name + "' version " + protocol.version +
                          " stands here with another text (" + changed.text(0).substr(0, 12) + ", now " +
                          protocol.sha256.substr(0, 12) + "); a changed protocol begins a new dataset",
                      "give the changed protocol a new version, or use another database");
  }
  const std::int64_t id =
      Statement(
          *database_,
          "INSERT INTO protocol (sha256, name, version, text, trial_seconds, test_data) VALUES (?,?,?,?,?,?)")
          .bind(0, protocol.sha256)
          .bind(1, protocol.name)
          .bind(2, protocol.version)
          .bind(3, protocol.text)
          .bind(4, protocol.trial_seconds)
          .bind(5, protocol.test_data ? 1 : 0)
          .run();
  const Question& question = protocol.question;
  Statement(*database_,
            "INSERT INTO question (protocol_id, code, wording, language, scale_min, scale_max, anchors) "
            "VALUES (?,?,?,?,?,?,?)")
      .bind(0, id)
      .bind(1, question.id)
      .bind(2, question.text)
      .bind(3, question.language)
      .bind(4, question.scale_min)
      .bind(5, question.scale_max)
      .bind(6, anchors_text(question))
      .run();
  return id;
}

void Store::add_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                        const SessionPlan& plan) {
  check_participant_code(plan.participant);
  Statement present(*database_,
                    "SELECT 1 FROM session WHERE protocol_id = ? AND participant = ? AND visit = ?");
  if (present.bind(0, protocol_id).bind(1, plan.participant).bind(2, plan.visit).step()) {
    throw base::Error(database_->path().string(),
                      "participant " + plan.participant + " has visit " + std::to_string(plan.visit) +
                          " of this protocol already",
                      "continue with vip-study resume --db " + database_->path().string() +
                          ", or give other codes or another --visit");
  }
  const std::int64_t session =
      Statement(
          *database_,
          "INSERT INTO session (run_id, protocol_id, participant, visit, seed, test_data, observer, clock, "
          "display, stimulus, machine, time_zone, ptpe) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)")
          .bind(0, run_id)
          .bind(1, protocol_id)
          .bind(2, plan.participant)
          .bind(3, plan.visit)
          .bind(4, as_signed(plan.seed))
          .bind(5, plan.test_data ? 1 : 0)
          .bind(6, plan.observer)
          .bind(7, plan.virtual_clock ? "virtual" : "real")
          .bind(8, plan.display)
          .bind(9, plan.stimulus)
          .bind(10, plan.machine)
          .bind(11, plan.time_zone)
          .bind(12, plan.ptpe)
          .run();
  Statement insert(
      *database_,
      "INSERT INTO trial (session_id, position, setting, practice, nominal_mean_fps, nominal_sd_fps, "
      "duration_s, schedule_seed, state) VALUES (?,?,?,0,?,?,?,?,'planned')");
  for (const PlannedTrial& trial : plan.trials) {
    const FpsSetting& setting = protocol.settings.at(static_cast<std::size_t>(trial.setting));
    insert.bind(0, session).bind(1, trial.position).bind(2, trial.setting);
    insert.bind(3, setting.mean).bind(4, setting.sd).bind(5, setting.duration_s);
    insert.bind(6, as_signed(trial.schedule_seed)).run();
  }
  insert_event(session, {}, "planned", "program " + base::version(), {});
}

std::int64_t Store::begin_presentation(std::int64_t session, std::int64_t trial, int attempt,
                                       std::int64_t start_ns) {
  Transaction transaction(*database_);
  const std::string now = base::utc_now();
  const std::int64_t id =
      statements_->begin.bind(0, trial).bind(1, attempt).bind(2, now).bind(3, start_ns).run();
  Statement(*database_, "UPDATE session SET started_utc = ? WHERE session_id = ? AND started_utc IS NULL")
      .bind(0, now)
      .bind(1, session)
      .run();
  insert_event(session, id, "trial shown", "attempt " + std::to_string(attempt), start_ns);
  transaction.commit();
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
    insert.bind(9, frame.late ? 1 : 0).bind(10, particles_text(frame.facts.particles_by_level));
    insert.bind(11, frame.facts.active_fraction).bind(12, frame.facts.tolerance);
    insert.run();
  }
}

void Store::add_frames(std::int64_t presentation, std::int64_t start_ns,
                       std::span<const FrameRecord> frames) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  transaction.commit();
}

void Store::end_presentation(std::int64_t presentation, std::int64_t start_ns, std::int64_t end_ns,
                             std::span<const FrameRecord> frames, const TimingVerdict& verdict) {
  Transaction transaction(*database_);
  insert_frames(presentation, start_ns, frames);
  Statement& end = statements_->end;
  end.bind(0, end_ns).bind(1, verdict_name(verdict.verdict)).bind(2, grade_name(verdict.grade));
  end.bind(3, verdict.reason).bind(4, static_cast<std::int64_t>(verdict.realised.frames));
  end.bind(5, verdict.realised.mean).bind(6, verdict.realised.mean_arithmetic).bind(7, verdict.realised.sd);
  end.bind(8, verdict.p95_ms)
      .bind(9, verdict.longest_ms)
      .bind(10, verdict.shortest_ms)
      .bind(11, verdict.lag1);
  end.bind(12, verdict.late).bind(13, verdict.worst_late_ms).bind(14, presentation);
  end.run();
  transaction.commit();
}

void Store::interrupt_presentation(std::int64_t session, std::int64_t presentation, std::int64_t clock_ns) {
  Transaction transaction(*database_);
  Statement(*database_, "UPDATE presentation SET state = 'interrupted' WHERE presentation_id = ?")
      .bind(0, presentation)
      .run();
  insert_event(session, presentation, "trial interrupted", "stopped on request", clock_ns);
  transaction.commit();
}

void Store::answer(std::int64_t session, std::int64_t trial, std::int64_t presentation,
                   const std::string& question, int score, double response_time_s, std::int64_t clock_ns) {
  Transaction transaction(*database_);
  const std::string now = base::utc_now();
  Statement& insert = statements_->response;
  insert.bind(0, trial).bind(1, presentation).bind(2, question).bind(3, score).bind(4, response_time_s);
  if (!insert.bind(5, now).bind(6, session).step()) {
    throw base::Error(database_->path().string(), "holds no question '" + question + "' for this session",
                      "restore a backup of it");
  }
  insert.reset();
  statements_->answered.bind(0, trial).run();
  statements_->ended.bind(0, session).bind(1, now).run();
  insert_event(session, presentation, "answered", "", clock_ns);
  transaction.commit();
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
  transaction.commit();
}

}  // namespace study
