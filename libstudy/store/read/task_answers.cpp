#include "libstudy/store/read/task_answers.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/open_study.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

bool first_format(Connection& database, std::int64_t protocol_id) {
  Statement row(database,
                "SELECT EXISTS (SELECT 1 FROM cell WHERE protocol_id = ?1) AND "
                "NOT EXISTS (SELECT 1 FROM cell WHERE protocol_id = ?1 AND method <> '')");
  row.bind_all(protocol_id).step();
  return row.integer(0) != 0;
}

void add_cells(Connection& database, std::int64_t protocol_id, Design& design) {
  Statement row(database,
                "SELECT cell, mean_fps, sd_fps, duration_s FROM cell WHERE protocol_id = ? ORDER BY cell");
  row.bind_all(protocol_id);
  while (row.step()) {
    design.cells.resize(static_cast<std::size_t>(row.integer(0)) + 1);
    design.cells.back().setting = {row.real(1), row.real(2), row.real(3)};
  }
}

/// A block that asks all questions of a protocol of the first format. In that format every question had a
/// scale and was asked after each trial.
Block trials(Connection& database, std::int64_t protocol_id) {
  Block block;
  block.kind = BlockKind::Stimulus;
  TrialStep ask;
  ask.kind = StepKind::Ask;
  Statement row(database,
                "SELECT code, wording, language, scale_min, scale_max FROM question WHERE protocol_id = ? "
                "ORDER BY question_id");
  row.bind_all(protocol_id);
  while (row.step()) {
    Question question;
    question.id = row.text(0);
    question.text = row.text(1);
    question.language = row.text(2);
    question.scale_min = static_cast<int>(row.integer(3));
    question.scale_max = static_cast<int>(row.integer(4));
    ask.asks.push_back(question.id);
    block.questions.push_back(std::move(question));
  }
  block.steps.push_back(ask);
  return block;
}

/// Parses the stored text of a protocol and applies the stored trial duration. The first format named no
/// methods and can no longer be parsed. A protocol of that format is rebuilt from the tables as far as
/// analyses need it: name, version, hash, cells without stimuli, and questions; `participants` is 0, not
/// known. where: names the database in messages. base::Error if the text of a later format cannot be parsed.
Protocol stored_protocol(Connection& database, std::int64_t protocol_id, const std::string& where) {
  Statement row(database,
                "SELECT name, version, sha256, test_data, text, trial_seconds FROM protocol WHERE "
                "protocol_id = ?");
  row.bind_all(protocol_id).step();
  if (!first_format(database, protocol_id)) {
    Protocol protocol = parse_protocol(row.text(4), where + ", protocol " + row.text(0), ProtocolUse::Stored);
    if (!row.is_null(5)) override_trial_seconds(protocol, row.real(5));
    return protocol;
  }
  Protocol protocol;
  protocol.name = row.text(0);
  protocol.version = row.text(1);
  protocol.sha256 = row.text(2);
  protocol.test_data = row.integer(3) != 0;
  protocol.participants = 0;
  add_cells(database, protocol_id, protocol.design);
  protocol.blocks.push_back(trials(database, protocol_id));
  return protocol;
}

constexpr const char* task_sessions_sql =
    "SELECT session_id, participant, visit, coalesce(observer, ''), test_data, "
    "iif(state = 'open' AND started_utc IS NULL AND NOT EXISTS (SELECT 1 FROM unit u WHERE u.session_id = "
    "session.session_id AND u.state <> 'planned'), 'planned', state), "
    "coalesce((SELECT min(p.gaze_source) FROM presentation p JOIN trial t USING (trial_id) WHERE "
    "t.session_id = session.session_id AND p.state = 'played' AND p.gaze_source <> session.gaze_source), "
    "gaze_source), station, display, coalesce((SELECT min(r.answered_utc) FROM unit u JOIN response r USING "
    "(unit_id) WHERE u.session_id = session.session_id), iif(imported_from IS NULL, NULL, started_utc)), "
    "(SELECT group_concat(angles, '; ') FROM (SELECT DISTINCT "
    "iif(f.framing_id IS NULL, 'not known', printf('camera %.4g degrees, eye ', camera_angle_deg) || "
    "iif(visual_angle_deg IS NULL, 'not known', printf('%.4g degrees, ratio %.2f', visual_angle_deg, "
    "angle_ratio))) AS angles FROM trial t JOIN presentation p USING (trial_id) LEFT JOIN framing f USING "
    "(framing_id) WHERE t.session_id = session.session_id AND p.state = 'played' AND display <> 'none' "
    "ORDER BY 1)), (SELECT group_concat(kind, ' and ') FROM (SELECT "
    "DISTINCT kind FROM event e WHERE e.session_id = session.session_id AND kind IN (?2, ?3) ORDER BY 1)), "
    "(SELECT group_concat(words, '; ') FROM (SELECT scene || ': ' || group_concat(printf('%dx%d px at %.4g "
    "degrees by %s', width_px, height_px, camera_angle_deg, coalesce(renderer, 'a renderer not known')), "
    "' and ') AS words FROM framing f WHERE f.session_id = session.session_id GROUP BY scene HAVING "
    "count(DISTINCT cells) > 1 ORDER BY scene)), stimulus, (SELECT detail FROM event e WHERE e.session_id = "
    "session.session_id AND kind = ?4 ORDER BY event_id DESC LIMIT 1), "
    "max(coalesce(not_before_utc, ''), (SELECT started_utc FROM run r WHERE r.run_id = session.run_id)), "
    "uid, "
    "coalesce(imported_from, ''), coalesce(source_sha256, ''), "
    "(SELECT group_concat(device, ' and ') FROM (SELECT DISTINCT device FROM tracker_clock k WHERE "
    "k.session_id = session.session_id ORDER BY 1)) "
    "FROM session WHERE protocol_id = ?1 ORDER BY participant, visit";

constexpr const char* trials_sql =
    "SELECT t.trial_id, u.unit_id, t.position, u.kind, t.first_cell, t.second_cell, t.excluded, w.attempt "
    "FROM trial t JOIN unit u USING (trial_id) LEFT JOIN trial_showing w USING (trial_id) "
    "WHERE t.session_id = ? ORDER BY t.position";

constexpr const char* showing_sql =
    "SELECT verdict, (SELECT grade FROM evidence v WHERE v.presentation_id = presentation.presentation_id), "
    "reason, frames, mean_fps, mean_arithmetic_fps, sd_fps, longest_ms, late_frames, "
    "(SELECT active_fraction FROM solving v WHERE v.presentation_id = presentation.presentation_id), "
    "(SELECT tau_fps FROM solving v WHERE v.presentation_id = presentation.presentation_id) "
    "FROM presentation WHERE trial_id = ? AND attempt = ? AND interval = ? AND state = 'played'";

std::string answers_sql() {
  std::string scored;
  for (const AnswerKindTraits& traits : answer_kinds())
    if (traits.scored) scored += (scored.empty() ? "'" : ", '") + std::string(traits.stored_word()) + "'";
  return "SELECT q.code, r.score, r.response_time_s FROM judgement j JOIN question q USING (question_id) "
         "LEFT JOIN response r USING (response_id) "
         "WHERE j.unit_id = ? AND q.kind IN (" +
         scored + ") AND q.personal = 0 ORDER BY j.place";
}

constexpr const char* catches_sql =
    "SELECT q.code, r.score FROM unit u JOIN ask k ON k.block = u.block AND k.protocol_id = ?2 "
    "JOIN question q ON q.question_id = k.question_id "
    "LEFT JOIN response r ON r.unit_id = u.unit_id AND r.question_id = q.question_id "
    "WHERE u.session_id = ?1 AND u.kind = 'catch' ORDER BY u.position, k.place";

/// Appends an item to a list unless the list has it. Returns true if it was appended.
bool add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) != list.end()) return false;
  list.push_back(item);
  return true;
}

class Reader {
 public:
  Reader(Connection& database, std::int64_t protocol_id, const Protocol& protocol)
      : database_(database),
        protocol_id_(protocol_id),
        protocol_(protocol),
        session_(database, task_sessions_sql),
        trial_(database, trials_sql),
        showing_(database, showing_sql),
        answer_(database, answers_sql()),
        catch_(database, catches_sql) {}

  std::vector<TaskSession> sessions() {
    std::vector<TaskSession> out;
    session_.bind_all(protocol_id_, std::string(mirror_event), std::string(revealed_event),
                      std::string(frame_costs_event));
    while (session_.step()) {
      out.push_back({.participant = session_.text(1),
                     .visit = static_cast<int>(session_.integer(2)),
                     .observer = session_.text(3),
                     .test_data = session_.integer(4) != 0 || protocol_.test_data,
                     .state = session_.text(5),
                     .gaze_source = session_.text(6),
                     .station = session_.text(7),
                     .display = session_.text(8),
                     .trials = trials(session_.integer(0)),
                     .catches = catches(session_.integer(0)),
                     .first_answer_utc = session_.text(9),
                     .angles = session_.text(10),
                     .unblinded = session_.text(11),
                     .mixed_pictures = session_.text(12),
                     .stimulus = session_.text(13),
                     .settings = run_settings(database_, session_.integer(0)),
                     .frame_costs = frame_costs(),
                     .not_before_utc = session_.text(15),
                     .tracker = session_.text(19),
                     .uid = session_.text(16),
                     .imported_from = session_.text(17),
                     .source_sha256 = session_.text(18)});
    }
    return out;
  }

 private:
  std::vector<FrameCosts> frame_costs() const {
    if (session_.is_null(14)) return {};
    return parse_frame_costs(session_.text(14), database_.path().string());
  }

  std::vector<TaskTrial> trials(std::int64_t session) {
    std::vector<TaskTrial> out;
    trial_.bind_all(session);
    while (trial_.step()) {
      const std::int64_t attempt = trial_.integer(7);
      TaskTrial trial;
      trial.position = static_cast<int>(trial_.integer(2));
      trial.kind = trial_.text(3);
      trial.first = showing(trial_.integer(0), attempt, 0, trial_.integer(4));
      if (!trial_.is_null(5)) trial.second = showing(trial_.integer(0), attempt, 1, trial_.integer(5));
      if (!trial_.is_null(6)) trial.excluded = trial_.text(6);
      trial.answers = answers(trial_.integer(1));
      if (trial.kind == "repeat") trial.repeats = original(out, trial);
      out.push_back(std::move(trial));
    }
    return out;
  }

  TaskShowing showing(std::int64_t trial, std::int64_t attempt, int interval, std::int64_t cell) {
    TaskShowing out;
    const Cell& planned = protocol_.design.cells.at(static_cast<std::size_t>(cell));
    out.cell = static_cast<int>(cell);
    out.what = planned.stimulus;
    out.nominal = planned.setting;
    showing_.reset();
    showing_.bind_all(trial, attempt, interval);
    out.played = showing_.step();
    if (!out.played) return out;
    if (!showing_.is_null(0)) out.verdict = verdict_of(showing_.text(0));
    out.framed = !showing_.is_null(1);
    if (out.framed) out.grade = grade_of(showing_.text(1));
    out.reason = showing_.text(2);
    out.realised = {static_cast<std::size_t>(showing_.integer(3)), showing_.real(4), showing_.real(5),
                    showing_.real(6)};
    out.longest_ms = showing_.real(7);
    out.late = showing_.integer(8);
    if (!showing_.is_null(9)) out.active_fraction = showing_.real(9);
    if (!showing_.is_null(10)) out.tau_fps = showing_.real(10);
    return out;
  }

  std::vector<TaskAnswer> answers(std::int64_t unit) {
    std::vector<TaskAnswer> out;
    answer_.bind_all(unit);
    while (answer_.step()) {
      out.push_back({answer_.text(0), {}});
      if (answer_.is_null(1)) continue;
      out.back().score = static_cast<int>(answer_.integer(1));
      if (!answer_.is_null(2)) out.back().response_time_s = answer_.real(2);
    }
    return out;
  }

  std::vector<CatchAnswer> catches(std::int64_t session) {
    std::vector<CatchAnswer> out;
    catch_.bind_all(session, protocol_id_);
    while (catch_.step()) {
      const std::optional<int> expected = expected_of(catch_.text(0));
      if (!expected) continue;
      out.push_back({catch_.text(0), *expected, {}});
      if (!catch_.is_null(1)) out.back().score = static_cast<int>(catch_.integer(1));
    }
    return out;
  }

  std::optional<int> expected_of(const std::string& code) const {
    for (const auto& [block, question] : all_questions(protocol_)) {
      if (question->id == code) return question->expect;
    }
    return {};
  }

  static bool same_stimulus(const TaskShowing& a, const TaskShowing& b) {
    return a.what == b.what && a.nominal.mean == b.nominal.mean && a.nominal.sd == b.nominal.sd;
  }

  static std::optional<int> original(const std::vector<TaskTrial>& before, const TaskTrial& repeat) {
    for (const TaskTrial& trial : before) {
      const bool same_second = trial.second.has_value() == repeat.second.has_value() &&
                               (!trial.second || same_stimulus(*trial.second, *repeat.second));
      if (trial.kind == "stimulus" && same_stimulus(trial.first, repeat.first) && same_second)
        return trial.position;
    }
    return {};
  }

  Connection& database_;
  std::int64_t protocol_id_;
  const Protocol& protocol_;
  Statement session_, trial_, showing_, answer_, catch_;
};

/// The questions with scores that the protocol's trials ask, each once.
std::vector<Question> trial_questions(const Protocol& protocol) {
  std::vector<Question> out;
  std::set<std::string> asked, known;
  for (const Block& block : protocol.blocks) {
    for (const TrialStep& step : block.steps) asked.insert(step.asks.begin(), step.asks.end());
  }
  for (const auto& [block, question] : all_questions(protocol)) {
    if (traits_of(question->kind).scored && asked.contains(question->id) && known.insert(question->id).second)
      out.push_back(*question);
  }
  return out;
}

/// The questions with scores on pages of kind demographics, screening and question that no trial asks.
std::vector<Question> questions_about_people(const Protocol& protocol) {
  std::set<std::string> asked;
  for (const Block& block : protocol.blocks)
    for (const TrialStep& step : block.steps) asked.insert(step.asks.begin(), step.asks.end());
  std::vector<Question> out;
  for (const auto& [block, question] : all_questions(protocol)) {
    const BlockKind kind = protocol.blocks.at(static_cast<std::size_t>(block)).kind;
    const bool page =
        kind == BlockKind::Demographics || kind == BlockKind::Screening || kind == BlockKind::Question;
    if (page && traits_of(question->kind).scored && !asked.contains(question->id)) out.push_back(*question);
  }
  return out;
}

/// Adds to `out` the answers to protocol.about_people that are not personal and so are in the database. An
/// answer becomes text: the words of a choice, the number of any other score.
void add_stored(Connection& database, const TaskProtocol& protocol, std::vector<PersonalEntry>& out) {
  Statement row(
      database,
      "SELECT s.participant, r.score FROM response r JOIN question q USING (question_id) JOIN unit u "
      "USING (unit_id) JOIN session s USING (session_id) JOIN protocol p ON p.protocol_id = "
      "s.protocol_id WHERE p.sha256 = ? AND q.code = ? AND "
      "r.score IS NOT NULL ORDER BY s.participant, s.visit");
  for (const Question& question : protocol.about_people) {
    if (question.personal) continue;
    row.reset();
    for (row.bind_all(protocol.sha256, question.id); row.step();) {
      std::string answer = std::to_string(row.integer(1));
      for (const auto& [score, words] : question.anchors)
        if (traits_of(question.kind).labelled && score == row.integer(1)) answer = words;
      out.push_back({row.text(0), question.id, question.text, answer});
    }
  }
}

TaskProtocol describe(const Protocol& protocol) {
  TaskProtocol out;
  out.name = protocol.name;
  out.version = protocol.version;
  out.sha256 = protocol.sha256;
  out.pairs = protocol.design.pairs;
  out.participants = protocol.participants;
  out.content_step_s = protocol.content.content_step_s;
  out.questions = trial_questions(protocol);
  out.about_people = questions_about_people(protocol);
  out.effects = protocol.design.effects;
  out.paint_temperature = protocol.design.paint_temperature;
  for (const Cell& cell : protocol.design.cells) {
    add_once(out.scenes, cell.stimulus.scene);
    if (add_once(out.methods, treatment_name(cell.stimulus)) && !out.effects.empty())
      out.treatments.push_back({"", cell.stimulus.method, "", cell.stimulus.effects});
    add_once(out.n_stars, cell.stimulus.n_star);
  }
  return out;
}

}  // namespace

TaskStudy read_tasks(const StudyFile& file) {
  auto [database, lacking] = open_study(file);
  TaskStudy study;
  study.lacking = std::move(lacking);
  study.withdrawn = static_cast<int>(database->integer("SELECT count(*) FROM tombstone"));
  Statement row(*database, "SELECT protocol_id FROM protocol ORDER BY protocol_id");
  while (row.step()) {
    const auto protocol =
        std::make_shared<const Protocol>(stored_protocol(*database, row.integer(0), file.path.string()));
    TaskProtocol out = describe(*protocol);
    out.sessions = Reader(*database, row.integer(0), *protocol).sessions();
    out.whole = protocol;
    study.protocols.push_back(std::move(out));
  }
  return study;
}

void read_about_people(const StudyFile& file, TaskStudy& study) {
  study.about_people = read_personal(file.path);
  const auto database = open_study(file).database;
  for (const TaskProtocol& protocol : study.protocols) add_stored(*database, protocol, study.about_people);
}

}  // namespace study
