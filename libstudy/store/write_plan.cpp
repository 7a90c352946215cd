/// Functions of Store that write a run (protocol, sessions, units and trials) before the first trial is
/// shown.
#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string>

#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/pattern.hpp"
#include "stats/base/text.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string folded(const std::string& code) {
  std::string letters;
  for (const char c : code)
    if (std::isalnum(static_cast<unsigned char>(c)))
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

/// The code without the leading zeros of each number in it.
std::string without_zeros(const std::string& code) {
  std::string out;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const bool begins =
        code[i] == '0' && (i == 0 || !is_digit(code[i - 1]) || out.empty() || !is_digit(out.back()));
    if (begins && i + 1 < code.size() && is_digit(code[i + 1])) continue;
    out += code[i];
  }
  return out;
}

/// True if R, pandas, spreadsheets or BIDS would read the code as a missing value: NA, n-a, NaN, null, none,
/// nil, missing or undefined, in upper or lower case.
bool reads_as_missing(const std::string& code) {
  constexpr std::array words{"na", "nan", "null", "none", "nil", "missing", "undefined"};
  return std::find(words.begin(), words.end(), folded(code)) != words.end();
}

/// True if two codes differ only in case, punctuation or leading zeros of a number: P01, p01, P-01, P1.
bool are_alike(const std::string& one, const std::string& other) {
  return folded(one) == folded(other) || folded(without_zeros(one)) == folded(without_zeros(other));
}

/// base::Error if a new code reads as a missing value, or is alike (are_alike()) to another code in the
/// database, also to that of a withdrawn person. A code that is in the database already is accepted.
void check_new_code(sqlite::Connection& database, const std::string& code) {
  sqlite::Statement known(database, "SELECT 1 FROM session WHERE participant = ?");
  if (known.bind_all(code).step()) return;
  const std::string place = database.path().string();
  if (reads_as_missing(code)) {
    throw base::Error(place, "participant " + code + " reads as a missing value in other programs",
                      "give another code, such as P01");
  }
  sqlite::Statement row(database,
                        "SELECT participant FROM session UNION SELECT participant FROM tombstone ORDER BY 1");
  while (row.step()) {
    const std::string other = row.text(0);
    if (other == code || !are_alike(other, code)) continue;
    throw base::Error(
        place,
        "participant " + code + " differs from " + other +
            " only in case, punctuation or leading zeros, and people and other programs confuse them",
        "write " + other + " if it is the same person, or give another code");
  }
}

std::int64_t as_signed(std::uint64_t value) { return static_cast<std::int64_t>(value); }

std::string anchors_text(const Question& question) {
  std::string text;
  for (const auto& [score, words] : question.anchors) {
    text += (text.empty() ? "" : "\n") + std::to_string(score) + " = " + words;
  }
  return text;
}

void add_questions(sqlite::Connection& database, std::int64_t protocol_id, const Protocol& protocol) {
  Statement insert(database,
                   "INSERT INTO question (protocol_id, code, wording, language, kind, scale_min, scale_max, "
                   "anchors, personal) VALUES (?,?,?,?,?,?,?,?,?)");
  std::set<std::string> written;  // ids of written questions; blocks that ask the same question share its row
  for (const auto& [block, question] : all_questions(protocol)) {
    if (!written.insert(question->id).second) continue;
    insert
        .bind_all(protocol_id, question->id, question->text, question->language,
                  traits_of(question->kind).stored_word(), question->scale_min, question->scale_max,
                  anchors_text(*question), question->personal ? 1 : 0)
        .run();
  }
}

/// Ids of the questions that a block asks, in the steps of its trials or on its page.
std::vector<std::string> asked_by(const Block& block) {
  std::vector<std::string> ids;
  for (const TrialStep& step : block.steps) ids.insert(ids.end(), step.asks.begin(), step.asks.end());
  if (!has_trials(block.kind)) {
    for (const Question& question : block.questions) ids.push_back(question.id);
  }
  return ids;
}

void add_asks(sqlite::Connection& database, std::int64_t protocol_id, const Protocol& protocol) {
  Statement insert(database,
                   "INSERT INTO ask (protocol_id, block, place, question_id) SELECT protocol_id, ?, ?, "
                   "question_id FROM question WHERE protocol_id = ? AND code = ?");
  for (const Block& block : protocol.blocks) {
    int place = 0;
    for (const std::string& id : asked_by(block)) insert.bind_all(block.id, place++, protocol_id, id).run();
  }
}

/// One line "factor = level" for each factor of the design; empty if the design has no factors.
std::string levels_text(const Design& design, const Cell& cell) {
  std::string out;
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    out += (i > 0 ? "\n" : "") + design.factors[i].name + " = " + level_name(design, cell, i);
  return out;
}

void add_cells(sqlite::Connection& database, std::int64_t protocol_id, const Protocol& protocol) {
  Statement insert(
      database,
      "INSERT INTO cell VALUES (?,?,?,?,?,?,?,?,nullif(?,''),nullif(?,''),nullif(?,''),nullif(?,''),"
      "nullif(?,''))");
  int index = 0;
  for (const Cell& cell : protocol.design.cells) {
    std::string set;
    for (const EffectSet& one : protocol.design.effects)
      if (one.name == cell.stimulus.effects) set = one.words;
    insert
        .bind_all(protocol_id, index++, cell.stimulus.scene, cell.stimulus.method, cell.stimulus.n_star,
                  cell.setting.mean, cell.setting.sd, cell.setting.duration_s, cell.stimulus.effects, set,
                  levels_text(protocol.design, cell),
                  cell.setting.profile ? profile_text(*cell.setting.profile) : "", cell.stimulus.surface)
        .run();
  }
}

/// Inserts the trials of a plan; returns their row numbers in the order of the trials' positions.
std::vector<std::int64_t> add_trials(sqlite::Connection& database, std::int64_t session, const Plan& plan) {
  Statement insert(database,
                   "INSERT INTO trial (session_id, position, group_index, first_cell, second_cell, "
                   "schedule_seed, state, set_aside) VALUES (?,?,?,?,?,?,'planned',0)");
  std::vector<std::int64_t> rows;
  for (const PlannedTrial& trial : plan.trials) {
    insert.bind_all(session, trial.position, trial.group, trial.first, trial.second,
                    as_signed(trial.schedule_seed));
    rows.push_back(insert.run());
  }
  return rows;
}

void add_units(sqlite::Connection& database, std::int64_t session, const Protocol& protocol,
               const Plan& plan) {
  const auto trials = add_trials(database, session, plan);
  Statement insert(database,
                   "INSERT INTO unit (session_id, position, block, block_index, kind, trial_id, state) "
                   "VALUES (?,?,?,?,?,?,'planned')");
  for (const PlannedUnit& unit : plan.units) {
    const Block& block = protocol.blocks.at(static_cast<std::size_t>(unit.block));
    std::optional<std::int64_t> trial;
    if (unit.trial) trial = trials.at(static_cast<std::size_t>(*unit.trial));
    insert.bind_all(session, unit.position, block.id, unit.block, block_kind_name(block.kind), trial).run();
  }
}

std::string listed(const std::vector<int>& cells) {
  std::string out;
  for (const int cell : cells) out += (out.empty() ? "" : " ") + std::to_string(cell);
  return out;
}

/// Inserts each framing unless the session's last row for its cells is equal. All cells of a framing share a
/// row, so the last row with the first cell is the row to compare.
void insert_framing(sqlite::Connection& database, std::int64_t session,
                    const std::vector<SceneFraming>& framing) {
  Statement insert(
      database,
      "INSERT INTO framing (session_id, scene, width_px, height_px, shown_width_px, "
      "shown_height_px, camera_angle_deg, visual_angle_deg, angle_ratio, cells, copied, renderer) "
      "SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?8 / ?7, ?9, nullif(?10, ''), nullif(?11, '') WHERE NOT "
      "EXISTS (SELECT 1 FROM framing WHERE framing_id = (SELECT max(framing_id) FROM framing WHERE "
      "session_id = ?1 AND instr(' ' || cells || ' ', ' ' || ?12 || ' ')) AND (scene, width_px, height_px, "
      "shown_width_px, shown_height_px, camera_angle_deg, visual_angle_deg, cells, copied, renderer) IS (?2, "
      "?3, ?4, ?5, ?6, ?7, ?8, ?9, nullif(?10, ''), nullif(?11, '')))");
  for (const SceneFraming& one : framing) {
    insert
        .bind_all(session, one.scene, one.width_px, one.height_px, one.shown_width_px, one.shown_height_px,
                  one.camera_angle_deg, one.visual_angle_deg, listed(one.cells), listed(one.copied),
                  one.renderer, one.cells.empty() ? -1 : one.cells.front())
        .run();
  }
}

}  // namespace

void check_participant_code(const std::string& code) {
  static const base::Pattern pattern("[A-Za-z0-9][A-Za-z0-9_-]{0,31}");
  if (code.size() > 32 || !pattern.match(code)) {
    throw base::Error("participant '" + base::shortened(code) + "'", "is not a participant code",
                      "use 1 to 32 letters, digits, _ or -, a letter or digit first, and never a name");
  }
}

std::int64_t Store::add_run(const RunPlan& run) {
  Transaction transaction(*database_);
  const std::string not_before_utc = newest_utc();
  const std::int64_t protocol_id = find_or_add_protocol(run);
  const std::int64_t run_id = insert_run(run.options);
  for (const SessionPlan& plan : run.sessions)
    add_session(run_id, protocol_id, run.protocol, plan, not_before_utc);
  give_labels(*database_);
  commit(transaction);
  keep_file();
  return run_id;
}

std::int64_t Store::insert_run(const std::string& options) {
  return Statement(*database_,
                   "INSERT INTO run (uid, started_utc, program_version, options) "
                   "VALUES (lower(hex(randomblob(16))),?,?,?)")
      .bind_all(base::utc_now(), base::version(), options)
      .run();
}

std::int64_t Store::find_or_add_protocol(const RunPlan& run) {
  const Protocol& protocol = run.protocol;
  Statement same(*database_, "SELECT protocol_id FROM protocol WHERE sha256 = ?");
  if (same.bind_all(protocol.sha256).step()) return same.integer(0);

  Statement changed(*database_,
                    "SELECT sha256 FROM protocol WHERE name = ? AND version = ? AND test_data = 0");
  if (!protocol.test_data && changed.bind_all(protocol.name, protocol.version).step()) {
    throw base::Error(database_->path().string(),
                      "protocol '" + protocol.name + "' version " + protocol.version +
                          " is stored here with another text (" + changed.text(0).substr(0, 12) + ", now " +
                          protocol.sha256.substr(0, 12) + "); a changed protocol begins a new dataset",
                      "give the changed protocol a new version, or use another database");
  }
  const std::int64_t id =
      Statement(
          *database_,
          "INSERT INTO protocol (sha256, name, version, text, trial_seconds, test_data) VALUES (?,?,?,?,?,?)")
          .bind_all(protocol.sha256, protocol.name, protocol.version, protocol.text, protocol.trial_seconds,
                    protocol.test_data ? 1 : 0)
          .run();
  add_questions(*database_, id, protocol);
  add_asks(*database_, id, protocol);
  add_cells(*database_, id, protocol);
  return id;
}

void Store::check_newcomer(std::int64_t protocol_id, const SessionPlan& plan) {
  check_participant_code(plan.participant);
  Statement present(*database_,
                    "SELECT state FROM session WHERE protocol_id = ? AND participant = ? AND visit = ?");
  if (present.bind_all(protocol_id, plan.participant, plan.visit).step()) {
    const bool open = present.text(0) == "open";
    throw base::Error(
        path_.string(),
        "participant " + plan.participant + " has visit " + std::to_string(plan.visit) +
            " of this protocol already" + (open ? "" : ", and it is over (" + present.text(0) + ")"),
        (open ? "continue with vip-study resume --db " + path_.string() + ", or give" : std::string("give")) +
            " other codes or another --visit");
  }
  check_new_code(*database_, plan.participant);
  Statement gone(*database_, "SELECT 1 FROM tombstone WHERE participant = ?");
  if (gone.bind_all(plan.participant).step()) {
    throw base::Error(
        path_.string(), "participant " + plan.participant + " withdrew from this study",
        "leave this person out, or give another code if it is another person: the code stays with "
        "the person who withdrew");
  }
}

std::int64_t Store::add_session(std::int64_t run_id, std::int64_t protocol_id, const Protocol& protocol,
                                const SessionPlan& plan, const std::string& not_before_utc) {
  check_newcomer(protocol_id, plan);
  std::optional<int> number, count;
  if (plan.station_number) {
    number = plan.station_number->number;
    count = plan.station_number->count;
  }
  Statement insert(
      *database_,
      "INSERT INTO session (uid, run_id, protocol_id, participant, code, visit, seed, slot, state, "
      "test_data, observer, clock, display, stimulus, machine, station, time_zone, gaze_source, "
      "screen_width_mm, viewing_distance_mm, ptpe, refresh_hz, station_number, station_count, "
      "not_before_utc, reservation, person) SELECT lower(hex(randomblob(16))), "
      "?1, ?2, ?3, coalesce((SELECT code FROM session WHERE participant = ?3), ?3), ?4, ?5, ?6, 'open', "
      "?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21, nullif(?22, ''), "
      "nullif(?23, ''), "
      "coalesce((SELECT person FROM session WHERE participant = ?3), lower(hex(randomblob(16))))");
  const std::int64_t session =
      insert
          .bind_all(run_id, protocol_id, plan.participant, plan.visit, as_signed(plan.seed), plan.plan.slot,
                    plan.test_data ? 1 : 0, plan.observer, plan.virtual_clock ? "virtual" : "real",
                    plan.display, plan.stimulus, plan.machine, plan.station, plan.time_zone, plan.gaze_source,
                    plan.screen_width_mm, plan.viewing_distance_mm, plan.ptpe, plan.refresh_hz, number, count,
                    not_before_utc, plan.reservation)
          .run();
  insert_framing(*database_, session, plan.framing);
  add_units(*database_, session, protocol, plan.plan);
  insert_event(session, {}, "planned", "program " + base::version(), {});
  return session;
}

void Store::add_framing(std::int64_t session, const std::vector<SceneFraming>& framing) {
  Transaction transaction(*database_);
  insert_framing(*database_, session, framing);
  commit(transaction);
}

std::vector<int> Store::taken_slots(const std::string& protocol_sha256) {
  Statement row(*database_,
                "SELECT s.slot FROM session s JOIN protocol p USING (protocol_id) WHERE p.sha256 = ? "
                "AND s.test_data = p.test_data AND s.state IN ('open', 'done', 'stopped') "
                "ORDER BY s.session_id");
  row.bind_all(protocol_sha256);
  std::vector<int> slots;
  while (row.step()) slots.push_back(static_cast<int>(row.integer(0)));
  return slots;
}

}  // namespace study
