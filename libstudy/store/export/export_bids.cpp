#include "libstudy/store/export/export_bids.hpp"

#include <map>
#include <set>

#include "libstudy/store/export/bids_writer.hpp"
#include "libstudy/store/export/rating_table.hpp"
#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/read/run_settings.hpp"
#include "libstudy/store/refusals.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace fs = std::filesystem;
using bids::answer_of;
using bids::described;
using bids::field;
using bids::Item;
using bids::Json;
using bids::Table;
using bids::Writer;
using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* events_sql =
    "SELECT p.start_ns, p.end_ns, u.kind, t.position, p.attempt, p.interval, p.state, c.scene, c.method, "
    "c.n_star, c.mean_fps, c.sd_fps, p.frames, p.mean_fps, p.mean_arithmetic_fps, p.sd_fps, p.longest_ms, "
    "p.late_frames, p.verdict, "
    "(SELECT grade FROM evidence v WHERE v.presentation_id = p.presentation_id), t.excluded IS NOT NULL, "
    "w.counts, w.why_not, "
    "(SELECT active_fraction FROM solving v WHERE v.presentation_id = p.presentation_id), "
    "(SELECT tau_fps FROM solving v WHERE v.presentation_id = p.presentation_id), p.gaze_source, u.unit_id, "
    "t.second_cell IS NOT NULL, c.effects";
constexpr int event_values = 29;  // number of values that events_sql selects
constexpr const char* event_tables_sql =
    " FROM presentation p JOIN trial t USING (trial_id) JOIN unit u USING (trial_id) "
    "JOIN showing w USING (presentation_id) JOIN session s ON s.session_id = t.session_id "
    "JOIN cell c ON c.protocol_id = s.protocol_id AND c.cell = p.cell "
    "WHERE s.session_id = ? ORDER BY p.presentation_id";

Json event_columns() {
  return {
      {"onset",
       described("start of the stimulus, from the first of the session; after the program began "
                 "anew, as if it had gone on without a pause; n/a: imported, and the source does not tell",
                 "s")},
      {"duration",
       described("from the onset to the end of its last frame; the frames fill frames / mean_fps of "
                 "it, after the program's preparation of the first; n/a: cut short, or not recorded",
                 "s")},
      {"trial_type", described("practice, stimulus or repeat")},
      {"trial", described("order among the session's trials, from 0")},
      {"attempt", described("showing of the trial, from 1")},
      {"interval", described("0: first or only stimulus, 1: second of a pair")},
      {"state", described("played, interrupted or running")},
      {"scene", described("scene file")},
      {"method", described("how the fluid is computed")},
      {"n_star", described("particles when all are coarsest")},
      {"nominal_mean_fps", described("requested mean frame rate; 0: as fast as the method runs", "frames/s")},
      {"nominal_sd_fps", described("requested standard deviation of the frame rate", "frames/s")},
      {"frames", described("frames shown")},
      {"mean_fps", described("realised harmonic mean", "frames/s")},
      {"mean_arithmetic_fps", described("realised arithmetic mean", "frames/s")},
      {"sd_fps", described("realised population standard deviation", "frames/s")},
      {"longest_ms", described("longest interval between frames", "ms")},
      {"late_frames", described("frames beyond the protocol's bound")},
      {"verdict", described("timing: pass, degraded or fail; n/a: no schedule to judge by")},
      {"grade", described(showing_grade_meaning)},
      {"excluded", described("1: excluded by the experimenter")},
      {"counts", described(showing_counts_meaning)},
      {"why_not", described(showing_why_not_meaning)},
      {"active_fraction", described(showing_active_meaning)},
      {"tau_fps", described(showing_tau_meaning, "frames/s")},
      {"gaze_source",
       described("what the fluid followed: tracked, head (straight ahead of it), mouse, fixed, "
                 "fixation or none; n/a: not known")},
      {"effects", described("level of the factor effects: none, scene (those of its file) or a name in the "
                            "protocol; n/a: the design does not vary them")}};
}

/// An additional column of the events table of a session whose protocol has factors.
struct FactorEvent {
  std::string name, sql;
  Json meaning;
};

/// The additional columns for a session's protocol with factors: the level of each factor, the timing
/// profile, p99_ms, hitches and animation_error_ms. Empty if the protocol has no factors.
std::vector<FactorEvent> factor_events(Connection& database, const LabelledSession& session,
                                       const Json& columns) {
  std::set<std::string> taken{"timing", "p99_ms", "hitches", "animation_error_ms"};
  for (const auto& [name, meaning] : columns.items()) taken.insert(name);
  std::vector<FactorEvent> out;
  for (const FactorColumn& one :
       factor_columns(database, "session.session_id = " + std::to_string(session.id), taken))
    out.push_back({one.name, one.level_sql("c"), described("level of the factor " + one.factor)});
  if (out.empty()) return out;
  out.push_back({"timing", "c.timing", described("requested timing profile in words")});
  out.push_back({"p99_ms", "p.p99_ms", described("99th percentile of the intervals between frames", "ms")});
  out.push_back({"hitches", "p.hitches", described("intervals longer than 1.5 times the median interval")});
  out.push_back({"animation_error_ms", "p.animation_error_ms",
                 described("mean absolute difference between the step of the simulated time and the interval "
                           "of a frame; n/a: content followed frames instead of time",
                           "ms")});
  return out;
}

Table event_rows(Connection& database, std::int64_t session, const std::vector<Item>& asked,
                 const std::vector<FactorEvent>& factors, const Json& columns) {
  Table rows(1);
  for (const auto& [name, meaning] : columns.items()) rows[0].push_back(name);
  std::string more;
  for (const FactorEvent& one : factors) more += ", " + one.sql;
  Statement row(database, events_sql + more + event_tables_sql);
  row.bind_all(session);
  bids::SessionTime time;
  while (row.step()) {
    std::optional<std::int64_t> end_ns;
    if (!row.is_null(1)) end_ns = row.integer(1);
    std::vector<std::string> line{"n/a", "n/a"};
    if (!row.is_null(0)) {
      const std::int64_t onset_ns = time.onset_of(row.integer(0), end_ns);
      line = {bids::seconds(onset_ns), end_ns ? bids::seconds(time.end_ns() - onset_ns) : "n/a"};
    }
    for (int i = 2; i <= 25; ++i) line.push_back(field(row, i));
    line.push_back(field(row, event_values - 1));
    for (int i = 0; i < static_cast<int>(factors.size()); ++i) line.push_back(field(row, event_values + i));
    const bool judged = row.integer(5) == row.integer(27);
    for (const Item& item : asked) {
      auto [score, seconds] = judged ? answer_of(database, row.integer(26), item.id, row.integer(4))
                                     : std::pair<std::string, std::string>{"n/a", "n/a"};
      line.push_back(score);
      line.push_back(seconds);
    }
    rows.push_back(std::move(line));
  }
  return rows;
}

void write_events(Connection& database, const LabelledSession& session, Writer& writer) {
  auto asked = bids::items(database, session.id, "u.trial_id IS NOT NULL");
  Json columns = event_columns();
  const auto factors = factor_events(database, session, columns);
  for (const FactorEvent& one : factors) columns[one.name] = one.meaning;
  for (Item& item : asked) {
    while (columns.contains(item.code)) item.code = "answer_" + item.code;
    columns[item.code] = bids::question_column(item);
    columns[item.code + "_response_time"] = described("from question to answer", "s");
  }
  const std::string stem = bids::stem_of(session) + "_events";
  writer.table(stem + ".tsv", event_rows(database, session.id, asked, factors, columns));
  Statement screen(
      database,
      "SELECT refresh_hz, screen_width_mm, viewing_distance_mm, machine, program_version, display "
      "FROM session JOIN run USING (run_id) WHERE session_id = ?");
  screen.bind_all(session.id).step();
  Json presentation{{"OperatingSystem", screen.text(3)},
                    {"SoftwareName", "vip-study"},
                    {"SoftwareVersion", screen.text(4)}};
  if (!screen.is_null(0)) presentation["ScreenRefreshRate"] = screen.real(0);
  if (!screen.is_null(2)) presentation["ScreenDistance"] = screen.real(2) / 1000;
  if (int width = 0, height = 0; std::sscanf(screen.text(5).c_str(), "window %dx%d", &width, &height) == 2) {
    presentation["ScreenOrigin"] = {"top", "left"};
    presentation["ScreenResolution"] = {width, height};
    if (!screen.is_null(1)) {
      const double width_m = screen.real(1) / 1000;
      presentation["ScreenSize"] = {width_m, width_m * height / width};
    }
  }
  if (Json worn = bids::headset_of(database, session.id); !worn.empty())
    presentation["HeadMountedDisplay"] = std::move(worn);
  columns["StimulusPresentation"] = presentation;
  writer.json(stem + ".json", columns);
}

Json session_columns() {
  return {
      {"acq_time", described("first stimulus, UTC")},
      {"protocol", described("name in the protocol file")},
      {"protocol_version", described("version in the protocol file")},
      {"protocol_sha256", described("SHA-256 of the protocol")},
      {"visit", described("visit of the participant under the protocol")},
      {"test_data", described("1: never pooled with real data")},
      {"observer", described("simulated observer that answered; n/a: a person")},
      {"station", described("where it was recorded")},
      {"gaze_source", described("tracked, head, mouse, fixed, fixation or none, as planned")},
      {"state", described("open, done, or how it ended early")},
      {"imported_from", described("program that recorded the session elsewhere; n/a: it was recorded here")},
      {"source_sha256", described("SHA-256 of the file from which its answers were imported")},
      {"setting_sha256", described(setting_sha256_meaning)}};
}

/// Codes of the simulated participants, for whom an observer model answered.
std::set<std::string> simulated_people(Connection& database, std::span<const LabelledSession> sessions) {
  std::set<std::string> out;
  Statement row(database, "SELECT observer IS NOT NULL FROM session WHERE session_id = ?");
  for (const LabelledSession& session : sessions) {
    row.reset();
    row.bind_all(session.id).step();
    if (row.integer(0) != 0) out.insert(session.participant);
  }
  return out;
}

void write_people(Connection& database, const std::vector<LabelledSession>& sessions, Writer& writer) {
  Table people{{"participant_id", "code", "simulated"}};
  const auto simulated = simulated_people(database, sessions);
  std::map<std::string, Table> visits;
  for (const LabelledSession& session : sessions) {
    const std::string sub = "sub-" + session.subject;
    auto [rows, fresh] = visits.try_emplace(sub);
    if (fresh) {
      people.push_back(
          {sub, field(session.participant), simulated.contains(session.participant) ? "1" : "0"});
      rows->second = {{"session_id", "acq_time", "protocol", "protocol_version", "protocol_sha256", "visit",
                       "test_data", "observer", "station", "gaze_source", "state", "imported_from",
                       "source_sha256", "setting_sha256"}};
    }
    Statement row(
        database,
        "SELECT session.started_utc, p.name, p.version, p.sha256, session.visit, session.test_data "
        "OR p.test_data, "
        "session.observer, session.station, session.gaze_source, session.state, session.imported_from, "
        "session.source_sha256, " +
            std::string(setting_sha256_sql) +
            " FROM session JOIN protocol p USING (protocol_id) WHERE session.session_id = ?");
    row.bind_all(session.id).step();
    std::vector<std::string> line{"ses-" + session.session};
    for (int i = 0; i < 13; ++i) line.push_back(field(row, i));
    rows->second.push_back(std::move(line));
  }
  writer.table("participants.tsv", people);
  writer.json(
      "participants.json",
      {{"code", described("participant code in the study's database")},
       {"simulated", described("1: a simulated observer answered, so that nothing here is of a person; "
                               "0: a person answered")}});
  for (const auto& [sub, rows] : visits) {
    writer.table(sub + "/" + sub + "_sessions.tsv", rows);
    writer.json(sub + "/" + sub + "_sessions.json", session_columns());
  }
}

bool is_bids_export(const fs::path& folder) {
  const fs::path description = folder / description_file;
  std::error_code ignored;
  if (!fs::is_regular_file(description, ignored) || fs::file_size(description, ignored) > 1u << 20)
    return false;
  const auto json = base::parse_json(base::read_file(description, 1u << 20));
  return json.is_object() && json.contains("GeneratedBy") &&
         json["GeneratedBy"].dump().find("\"vip-study\"") != std::string::npos;
}

bool is_bids_name(const std::string& name) {
  static const std::set<std::string> names{description_file, "README.md", "participants.tsv",
                                           "participants.json"};
  return names.contains(name) || name.starts_with("sub-") || name.starts_with("phenotype/") ||
         name.starts_with("code/setting_");
}

constexpr ExportKind bids_kind{"bids", is_bids_export, is_bids_name};

}  // namespace

AboutDataSet about_data_set(Connection& database, std::span<const LabelledSession> sessions) {
  AboutDataSet out;
  Statement row(database,
                "SELECT p.name || ' ' || p.version FROM session JOIN protocol p USING (protocol_id) WHERE "
                "session_id = ?");
  std::set<std::string> names, people;
  for (const LabelledSession& session : sessions) {
    people.insert(session.participant);
    row.reset();
    row.bind_all(session.id).step();
    if (names.insert(row.text(0)).second) out.name += (out.name.empty() ? "" : ", ") + row.text(0);
  }
  if (out.name.empty()) out.name = "a study without sessions";
  Statement tool(database, "SELECT coalesce(imported_from, '') FROM session WHERE session_id = ?");
  std::map<std::string, int> imported;
  for (const LabelledSession& session : sessions) {
    tool.reset();
    tool.bind_all(session.id).step();
    if (!tool.text(0).empty()) ++imported[tool.text(0)];
  }
  for (const auto& [name, count] : imported)
    out.imported += (out.imported.empty() ? "" : " ") + std::to_string(count) +
                    " sessions were recorded by " + name + " and imported.";
  const auto simulated = simulated_people(database, sessions);
  if (!simulated.empty())
    out.simulated = "For " + std::to_string(simulated.size()) + " of " + std::to_string(people.size()) +
                    " participants a simulated observer answered: these data are not of people.";
  return out;
}

PublicExport export_bids(const StudyFile& study, const fs::path& folder, bool gaze) {
  open_study(study);  // throws for a damaged file before label_everybody() writes to it
  label_everybody(study.path);
  const auto database = open_to_export(study);
  database->execute("BEGIN");
  const auto sessions = shared_sessions(*database);
  const SharingCount people = count_sharing(*database);
  ExportDraft draft({study.path, bids_kind, people_of(sessions), Readers::AsUmask}, folder);
  Writer writer(draft);
  const AboutDataSet about = about_data_set(*database, sessions);
  Json generator{{"Name", "vip-study"}, {"Version", base::version()}};
  if (!about.simulated.empty()) generator["Description"] = about.simulated;
  writer.json(description_file, {{"Name", about.name},
                                 {"BIDSVersion", "1.11.0"},
                                 {"DatasetType", "raw"},
                                 {"GeneratedBy", Json::array({generator})}});
  writer.text(
      "README.md",
      std::string("# Ratings of real-time fluid\n\nBehaviour: what was shown when, how it was rated") +
          (gaze ? ", where people looked.\n" : ".\n") +
          (about.simulated.empty() ? "" : "\n" + about.simulated + "\n") +
          (about.imported.empty() ? "" : "\n" + about.imported + "\n") + "\nIn every table, " +
          formula_guard_meaning + ".\n");
  write_people(*database, sessions, writer);
  std::set<std::string> named;
  for (const LabelledSession& session : sessions) {
    write_events(*database, session, writer);
    for (const RunSetting& setting : run_settings(*database, session.id)) {
      const std::string name = "code/" + setting_file_name(setting);
      if (named.insert(name).second) writer.text(name, setting.text);
    }
    if (!gaze || !is_gaze_allowed(*database, session.id)) continue;
    bids::write_gaze(*database, session, writer);
    bids::write_motion(*database, session, writer);
  }
  bids::write_phenotypes(*database, sessions, writer);
  database->execute("COMMIT");
  draft.put_in_place();
  return {std::move(writer.files), people};
}

}  // namespace study
