/// Function of Store that writes imported sessions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// An identity that every import of the same source gives, so that copies of the data are recognised.
std::string identity(const std::string& words) { return base::sha256_hex("import " + words).substr(0, 32); }

int stimulus_block(const Protocol& protocol) {
  const auto found = std::find_if(protocol.blocks.begin(), protocol.blocks.end(),
                                  [](const Block& block) { return block.kind == BlockKind::Stimulus; });
  return static_cast<int>(found - protocol.blocks.begin());
}

/// Position of each trial's group of cells, in the order in which the session met the groups.
std::vector<int> groups_of(const Protocol& protocol, const ImportedSession& session) {
  const auto groups = cell_groups(protocol.design);
  std::map<std::size_t, int> met;
  std::vector<int> out;
  for (const ImportedTrial& trial : session.trials) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<int>& cells) {
      return std::find(cells.begin(), cells.end(), trial.showings.front().cell) != cells.end();
    });
    out.push_back(
        met.try_emplace(static_cast<std::size_t>(group - groups.begin()), static_cast<int>(met.size()))
            .first->second);
  }
  return out;
}

/// The session's trials as a plan. It has no pages, because the protocol's pages were not shown.
SessionPlan plan_of(const Protocol& protocol, const ImportedSession& session, const ImportTerms& terms) {
  SessionPlan plan;
  plan.participant = session.participant;
  plan.visit = session.visit;
  plan.test_data = session.test_data || protocol.test_data;
  plan.observer = session.observer;
  plan.virtual_clock = session.observer.has_value();
  plan.display = plan.stimulus = "shown elsewhere, by " + terms.tool;
  plan.machine = plan.time_zone = "not recorded";
  plan.station = "imported";
  const int block = stimulus_block(protocol);
  const std::vector<int> groups = groups_of(protocol, session);
  for (std::size_t i = 0; i < session.trials.size(); ++i) {
    const int position = static_cast<int>(i);
    plan.plan.units.push_back({position, block, position});
    const std::vector<int> cells = session.trials[i].cells();
    std::optional<int> second;
    if (cells.size() > 1) second = cells[1];
    plan.plan.trials.push_back({position, block, groups[i], cells[0], second, 0});
  }
  return plan;
}

/// Relative error of the length of a frame log from which on its trial fails.
constexpr double most_length_error = 0.05;

/// Timing of a trial with a frame log. A pattern of intervals, such as hitches, is described, not judged: two
/// moments do not decide whether it was shown.
TimingVerdict verdict_of_log(const Protocol& protocol, const ImportedShowing& showing,
                             const PlayedTrial& played) {
  const FpsSetting& setting = protocol.design.cells.at(static_cast<std::size_t>(showing.cell)).setting;
  const TimingGrade grade = grade_of_log(*showing.frames);
  if (setting.mean <= 0 || has_pattern(setting)) return describe_trial(played, grade);
  TimingVerdict out = judge_trial(setting, protocol.pacing, played, protocol.timing, grade);
  const double logged_s = 1e-9 * static_cast<double>(played.end_ns);
  if (std::abs(logged_s - setting.duration_s) > most_length_error * setting.duration_s) {
    out.verdict = Verdict::Fail;
    out.reason += (out.reason.empty() ? "" : "; ") +
                  fmt::format("the log lasts {:.4g} s, the trial {:.4g} s", logged_s, setting.duration_s);
  }
  return out;
}

std::optional<std::int64_t> known_ns(std::int64_t time_ns) {
  if (time_ns < 0) return {};
  return time_ns;
}

}  // namespace

void Store::insert_imported_showing(const Protocol& protocol, const ImportedShowing& showing, int interval,
                                    std::int64_t session, std::int64_t trial_id) {
  PlayedTrial played;
  std::optional<TimingVerdict> timing;
  if (showing.frames) {
    played = played_of_log(*showing.frames);
    timing = verdict_of_log(protocol, showing, played);
  }
  std::optional<std::int64_t> end_ns;
  if (timing && showing.at_ns) end_ns = *showing.at_ns + played.end_ns;
  const std::int64_t presentation =
      Statement(*database_,
                "INSERT INTO presentation (trial_id, attempt, interval, cell, state, start_ns, end_ns, "
                "mean_fps, mean_arithmetic_fps, sd_fps, gaze_source) VALUES (?,1,?,?,'played',?,?,?,?,?,"
                "'none')")
          .bind_all(trial_id, interval, showing.cell, showing.at_ns, end_ns, showing.stated.mean,
                    showing.stated.mean_arithmetic, showing.stated.sd)
          .run();
  if (!timing) return;
  std::optional<std::string> judged, reason;
  if (timing->nominal.mean > 0) {
    judged = verdict_name(timing->verdict);
    reason = timing->reason;
  }
  Statement(*database_,
            "UPDATE presentation SET verdict = ?, grade = ?, reason = ?, frames = ?, mean_fps = ?, "
            "mean_arithmetic_fps = ?, sd_fps = ?, p95_ms = ?, longest_ms = ?, shortest_ms = ?, lag1 = ?, "
            "p99_ms = ?, hitches = ? WHERE presentation_id = ?")
      .bind_all(judged, grade_name(timing->grade), reason, static_cast<std::int64_t>(timing->realised.frames),
                timing->realised.mean, timing->realised.mean_arithmetic, timing->realised.sd, timing->p95_ms,
                timing->longest_ms, timing->shortest_ms, timing->lag1, timing->p99_ms, timing->hitches,
                presentation)
      .run();
  Statement insert(*database_,
                   "INSERT INTO frame (presentation_id, frame_index, scheduled_ns, submitted_ns, "
                   "actual_display_ns) VALUES (?,?,?,?,?)");
  for (const FrameRecord& frame : played.frames) {
    const bool shown = frame.times.actual_display_ns >= 0;
    insert
        .bind_all(presentation, frame.index, frame.scheduled_ns,
                  known_ns(shown ? -1 : frame.times.submitted_ns - frame.scheduled_ns),
                  known_ns(shown ? frame.times.actual_display_ns - frame.scheduled_ns : -1))
        .run();
  }
  insert_event(session, presentation, "frames imported", "SHA-256 of the log " + showing.frames_sha256, {});
}

void Store::insert_imported_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                                    const ImportTerms& terms, const ImportedSession& imported) {
  const std::int64_t session =
      add_session(run_id, protocol_id, protocol, plan_of(protocol, imported, terms), "");
  Statement(*database_,
            "UPDATE session SET uid = ?2, person = ?3, state = ?4, started_utc = ?5, imported_from = ?6, "
            "source_sha256 = ?7 WHERE session_id = ?1")
      .bind_all(session,
                identity(imported.source_sha256 + " " + protocol.sha256 + " " + imported.participant + " " +
                         std::to_string(imported.visit)),
                identity(imported.first_source_sha256 + " " + imported.participant),
                imported.complete ? "done" : terms.incomplete, imported.started_utc, terms.tool,
                imported.source_sha256)
      .run();
  insert_event(session, {}, imported_event,
               "from " + terms.tool + ", SHA-256 of the source " + imported.source_sha256 +
                   ", of the mapping " + terms.mapping_sha256,
               {});
  Statement row(*database_, "SELECT unit_id, trial_id FROM unit WHERE session_id = ? ORDER BY position");
  row.bind_all(session);
  Statement answer(
      *database_,
      "INSERT INTO response (unit_id, attempt, question_id, score, response_time_s, answered_utc, "
      "input) SELECT ?1, 1, question_id, ?4, ?5, ?6, ?7 FROM question WHERE protocol_id = ?2 AND "
      "code = ?3");
  std::optional<std::string> input;
  if (imported.observer) input = "observer";
  for (const ImportedTrial& trial : imported.trials) {
    row.step();
    for (int interval = 0; const ImportedShowing& showing : trial.showings)
      insert_imported_showing(protocol, showing, interval++, session, row.integer(1));
    for (const ImportedAnswer& one : trial.answers)
      answer
          .bind_all(row.integer(0), protocol_id, one.question, one.score, one.response_time_s, trial.utc,
                    input)
          .run();
  }
  row.reset();
  Statement(*database_, "UPDATE unit SET state = 'done' WHERE session_id = ?").bind_all(session).run();
  Statement(*database_, "UPDATE trial SET state = 'answered' WHERE session_id = ?").bind_all(session).run();
  const std::string now = base::utc_now();
  record_permission(*database_, session, "sharing", terms.sharing, now);
  insert_event(session, {}, permission_event,
               std::string("sharing ") + (terms.sharing ? "allowed" : "refused") + ", as the mapping says",
               {});
}

void Store::refuse_imported(const ImportedSession& session) {
  Statement again(*database_, "SELECT participant FROM session WHERE source_sha256 = ?");
  if (again.bind_all(session.source_sha256).step())
    throw base::Error(path_.string(),
                      "holds the source of participant " + session.participant + " already (SHA-256 " +
                          session.source_sha256 + ")",
                      "import each file once");
  Statement known(*database_, "SELECT 1 FROM session WHERE participant = ?");
  if (known.bind_all(session.participant).step())
    throw base::Error(path_.string(),
                      "has a participant " + session.participant +
                          " already, and whether it is the same person is not known",
                      "import all files of a person in one command, or import into a new database and join "
                      "the two with vip-study merge, which keeps the people apart");
}

void Store::add_import(const Protocol& protocol, const ImportTerms& terms,
                       const std::vector<ImportedSession>& sessions) {
  Transaction transaction(*database_);
  for (const ImportedSession& session : sessions) refuse_imported(session);
  RunPlan run;
  run.protocol = protocol;
  run.options = terms.options;
  const std::int64_t protocol_id = find_or_add_protocol(run);
  const std::int64_t run_id = insert_run(run.options);
  for (const ImportedSession& session : sessions)
    insert_imported_session(run_id, protocol_id, protocol, terms, session);
  give_labels(*database_);
  commit(transaction);
  keep_file();
}

}  // namespace study
