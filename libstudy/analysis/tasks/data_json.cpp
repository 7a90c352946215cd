#include "libstudy/analysis/tasks/data_json.hpp"
#include "libstudy/protocol/method_claims.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace study {

namespace {

std::string counted(std::size_t n, const std::string& thing) {
  return std::to_string(n) + " " + thing + (n == 1 ? "" : "s");
}

/// Levels of the factor effects with their contents in words; empty if effects are not a factor.
Json effects_json(const TaskData& data) {
  Json json = Json::object();
  for (const auto& level : data.protocol.effects) json[level.name] = level.words;
  return json;
}

Json doubtful_json(const TaskData& data) {
  Json json = Json::array();
  for (const DoubtfulTime& one : data.doubtful_times)
    json.push_back({{"participant", one.participant},
                    {"station", one.station},
                    {"told_utc", one.told_utc},
                    {"not_before_utc", one.not_before_utc},
                    {"impossible", one.impossible}});
  return json;
}

Json protocol_json(const TaskData& data) {
  Json json{
      {"task", task_name(data.task)},
      {"title", task_title(data.task)},
      {"name", data.protocol.name},
      {"version", data.protocol.version},
      {"sha256", data.protocol.sha256},
      {"participants_planned", data.protocol.participants > 0 ? Json(data.protocol.participants) : Json()},
      {"first_answer_utc", data.first_answer_utc.empty() ? Json() : Json(data.first_answer_utc)},
      {"test_data", data.test_data},
      {"simulated", data.simulated.size()},
      {"observers", data.observers},
      {"gaze", data.gaze},
      {"stations", data.stations},
      {"displays", data.displays},
      {"angles", data.angles},
      {"settings", data.settings},
      {"unblinded", data.unblinded},
      {"mixed_pictures", data.mixed_pictures},
      {"effects", effects_json(data)},
      {"overlay", data.protocol.paint_temperature ? Json("temperature") : Json()}};
  if (!data.trackers.empty()) json["trackers"] = data.trackers;
  if (!data.imported.empty()) json["imported"] = data.imported;
  if (!data.doubtful_times.empty()) json["doubtful_times"] = doubtful_json(data);
  return json;
}

/// True if the results depend on gaze. Results of Task 1 and Task 2 are assumed to depend on gaze, those of a
/// pilot are not. Another design depends on gaze if it shows a method other than LoRes and HiRes.
bool refines(const TaskData& data) {
  if (data.task != TaskKind::Own) return data.task != TaskKind::Pilot;
  return std::any_of(data.protocol.methods.begin(), data.protocol.methods.end(), [](const std::string& one) {
    return !one.starts_with("LoRes") && !one.starts_with("HiRes");
  });
}

std::vector<std::string> notes_of(const TaskData& data, const stats::AnalysisPlan& plan) {
  const std::string task = std::string(task_title(data.task)) + ": ";
  std::vector<std::string> notes;
  if (data.test_data) notes.push_back(task + "these are test data, not a study.");
  if (!data.simulated.empty())
    notes.push_back(task + counted(data.simulated.size(), "participant") +
                    " simulated by an observer model.");
  if (!data.imported.empty()) notes.push_back(task + "imported: " + data.imported_words() + ".");
  if (data.asked_rates > 0)
    notes.push_back(
        task + counted(static_cast<std::size_t>(data.asked_rates), "rating") +
        " without recorded timing enter the fit at the mean and standard deviation that were asked "
        "for, under the harmonic and the arithmetic mean alike.");
  if (data.stated_rates > 0)
    notes.push_back(task + counted(static_cast<std::size_t>(data.stated_rates), "rating") +
                    " without recorded frames enter the fit at the frame rates that the source states.");
  for (const DoubtfulTime& one : data.doubtful_times)
    notes.push_back(task + "the clock showed " + one.told_utc + " at the first answer of " + one.participant +
                    ", after rows of the database of " + one.not_before_utc + ".");
  for (const SetAside& protocol : data.set_aside)
    notes.push_back(task + "protocol " + protocol.name + ", " +
                    counted(static_cast<std::size_t>(protocol.sessions), "session") +
                    ", left out: it holds no real answers.");
  if (data.flow.test_left_out > 0)
    notes.push_back(task + counted(static_cast<std::size_t>(data.flow.test_left_out), "session") +
                    " of test data left out.");
  if (data.flow.simulated_left_out > 0)
    notes.push_back(task + counted(static_cast<std::size_t>(data.flow.simulated_left_out), "session") +
                    " of simulated observers left out beside those of people.");
  const std::string gaze = refines(data) ? data.gaze_problem() : "";
  if (!gaze.empty()) notes.push_back(task + gaze + ".");
  const bool of_methods = data.task == TaskKind::Task1 || data.task == TaskKind::Task2;
  const std::string ids =
      of_methods
          ? ids_in_short(ids_of(claims_of_task(claims_in_force(plan), data.task == TaskKind::Task1 ? 1 : 2)))
          : "";
  if (!data.protocol.effects.empty() && !ids.empty())
    notes.push_back(task + "effects are a factor, so that " + ids +
                    ", which are about methods alone, are not tested.");
  return notes;
}

struct Mean {
  int count = 0;
  double sum = 0;
  void add(const std::optional<double>& value) {
    count += value ? 1 : 0;
    sum += value.value_or(0);
  }
  Json json() const { return count > 0 ? Json(sum / count) : Json(); }
};

/// Sums over the showings of one line of a timing table: of one scene, n_*, method and frame rate, or of one
/// cell of a design with factors.
struct TimedCell {
  int showings = 0, pass = 0, degraded = 0, fail = 0;
  int unjudged = 0;      ///< without a verdict, those of `not_recorded` included
  int not_recorded = 0;  ///< without frames
  std::map<std::string, int> grades;
  FpsSetting nominal;
  Mean mean, sd;  ///< over the showings whose rates are known
  double longest_ms = 0;
  std::int64_t late = 0;
  Mean active_fraction, tau_fps;  ///< over the showings in which they were measured

  void add(const TaskShowing& shown) {
    ++showings;
    nominal = shown.nominal;
    if (!shown.verdict) {
      ++unjudged;
    } else {
      ++(*shown.verdict == Verdict::Pass ? pass : *shown.verdict == Verdict::Degraded ? degraded : fail);
    }
    if (shown.has_rates()) {
      mean.add(shown.realised.mean);
      sd.add(shown.realised.sd);
    }
    if (!shown.framed) {
      ++not_recorded;
      return;
    }
    ++grades[std::string(1, static_cast<char>(shown.grade))];
    longest_ms = std::max(longest_ms, shown.longest_ms);
    late += shown.late;
    active_fraction.add(shown.active_fraction);
    tau_fps.add(shown.tau_fps);
  }
};

Json timed_json(const TimedCell& cell) {
  const bool scheduled = cell.nominal.mean > 0, framed = cell.not_recorded < cell.showings;
  Json json{{"showings", cell.showings},
            {"pass", cell.pass},
            {"degraded", cell.degraded},
            {"fail", cell.fail},
            {"unjudged", cell.unjudged},
            {"grades", cell.grades},
            {"nominal_mean_fps", scheduled ? Json(cell.nominal.mean) : Json()},
            {"nominal_sd_fps", scheduled ? Json(cell.nominal.sd) : Json()},
            {"realised_mean_fps", cell.mean.json()},
            {"realised_sd_fps", cell.sd.json()},
            {"longest_ms", framed ? Json(cell.longest_ms) : Json()},
            {"late_frames", framed ? Json(cell.late) : Json()},
            {"active_fraction", cell.active_fraction.json()},
            {"tau_fps", cell.tau_fps.json()}};
  if (cell.not_recorded > 0) json["not_recorded"] = cell.not_recorded;
  return json;
}

}  // namespace

Json study_json(const std::string& database, const std::vector<const TaskData*>& tasks,
                const stats::AnalysisPlan& plan) {
  std::set<std::string> observers, simulated;
  std::map<std::string, int> gaze, stations, displays;
  bool test_data = true, follow_gaze = false, tracked = true;
  Json protocols = Json::array(), notes = Json::array();
  for (const TaskData* data : tasks) {
    observers.insert(data->observers.begin(), data->observers.end());
    simulated.insert(data->simulated.begin(), data->simulated.end());
    for (const auto& [source, n] : data->gaze) gaze[source] += n;
    for (const auto& [station, n] : data->stations) stations[station] += n;
    for (const auto& [display, n] : data->displays) displays[display] += n;
    test_data = test_data && data->test_data;
    if (refines(*data)) {
      follow_gaze = true;
      tracked = tracked && !data->gaze.empty() && data->gaze_problem().empty();
    }
    protocols.push_back(protocol_json(*data));
    for (const std::string& note : notes_of(*data, plan)) notes.push_back(note);
  }
  return {{"database", database},
          {"test_data", test_data && !tasks.empty()},
          {"simulated", simulated.size()},
          {"observers", observers},
          {"gaze", gaze},
          {"tracked_gaze", follow_gaze ? Json(tracked) : Json()},
          {"stations", stations},
          {"displays", displays},
          {"protocols", protocols},
          {"notes", notes}};
}

Json acting_rules_json(const TaskData& data, const stats::ExclusionRules& rules) {
  bool catches = false, repeats = false;
  int most_trials = 0;
  for (const TaskSession& session : data.protocol.sessions) {
    catches = catches || !session.catches.empty();
    int trials = 0;
    for (const TaskTrial& trial : session.trials) {
      repeats = repeats || trial.kind == "repeat";
      trials += trial.kind == "stimulus" ? 1 : 0;
    }
    most_trials = std::max(most_trials, trials);
  }
  const bool judged = std::any_of(data.showings.begin(), data.showings.end(),
                                  [](const TimedShowing& one) { return one.shown.verdict.has_value(); });
  const bool pairs = data.protocol.pairs;
  const int range = data.question.scale_max - data.question.scale_min;
  Json out = Json::array();
  const auto add = [&](const char* rule, bool can_act) {
    if (can_act) out.push_back(rule);
  };
  add("timing", judged);
  add("min_catch_correct", catches);
  add("max_repeat_difference", repeats && !pairs && rules.max_repeat_difference.value_or(0) < range);
  add("min_repeat_agreement", repeats && pairs);
  add("straight_lining_answers", most_trials > 0 && most_trials >= rules.straight_lining_answers);
  add("min_answered", most_trials > 0);
  return out;
}

Json flow_json(const TaskFlow& flow) {
  const auto in_state = [&](const char* state) {
    const auto found = flow.by_state.find(state);
    return found == flow.by_state.end() ? 0 : found->second;
  };
  return {{"planned", in_state("planned")},
          {"started", flow.started},
          {"participants", flow.participants},
          {"no_answer", flow.no_answer},
          {"no_consent", in_state("refused")},
          {"not_eligible", in_state("not eligible")},
          {"stopped", in_state("stopped")},
          {"dropped_out", in_state("dropped out")},
          {"open", in_state("open")},
          {"done", in_state("done")},
          {"withdrawn", flow.withdrawn},
          {"set_aside",
           {{"test_data", flow.test_left_out},
            {"simulated", flow.simulated_left_out},
            {"protocols", flow.protocols_left_out}}},
          {"excluded_visits", flow.excluded_visits},
          {"excluded_participants", flow.excluded_participants},
          {"analysed", flow.analysed},
          {"trials_planned", flow.trials_planned},
          {"trials_answered", flow.trials_answered},
          {"trials_excluded", flow.trials_excluded},
          {"trials_analysed", flow.trials_analysed},
          {"practice", flow.practice},
          {"repeat", flow.repeat}};
}

Json roster_json(const TaskStudy& study, const std::multimap<std::string, std::string>& sections) {
  std::set<std::string> everyone;
  std::size_t sessions = 0;
  Json protocols = Json::array();
  for (const TaskProtocol& protocol : study.protocols) {
    std::set<std::string> people;
    int simulated = 0, test_data = 0;
    for (const TaskSession& session : protocol.sessions) {
      people.insert(session.participant);
      simulated += session.observer.empty() ? 0 : 1;
      test_data += session.test_data ? 1 : 0;
    }
    everyone.insert(people.begin(), people.end());
    sessions += protocol.sessions.size();
    Json places = Json::array();
    for (auto [at, end] = sections.equal_range(protocol.sha256); at != end; ++at)
      places.push_back(at->second);
    protocols.push_back({{"name", protocol.name},
                         {"version", protocol.version},
                         {"sha256", protocol.sha256},
                         {"participants", people.size()},
                         {"sessions", protocol.sessions.size()},
                         {"simulated", simulated},
                         {"test_data", test_data},
                         {"sections", places}});
  }
  return {{"participants", everyone.size()},
          {"sessions", sessions},
          {"withdrawn", study.withdrawn},
          {"protocols", protocols}};
}

Json exclusions_json(const TaskData& data) {
  Json list = Json::array();
  for (const auto& one : data.exclusions) {
    list.push_back({{"task", task_name(data.task)},
                    {"participant", one.participant},
                    {"visit", one.visit},
                    {"position", one.position < 0 ? Json() : Json(one.position)},
                    {"rule", one.rule},
                    {"reason", one.reason},
                    {"actor", one.by_hand() ? "experimenter" : "rule"},
                    {"answers", one.answers}});
  }
  return list;
}

Json timing_json(const TaskData& data) {
  std::map<std::tuple<int, int, int, double, double>, TimedCell> cells;
  const auto& protocol = data.protocol;
  for (const TimedShowing& one : data.showings) {
    const auto& what = one.shown.what;
    cells[{place_in(protocol.scenes, what.scene), place_in(protocol.n_stars, what.n_star),
           place_in(protocol.methods, treatment_name(what)), one.shown.nominal.mean, one.shown.nominal.sd}]
        .add(one.shown);
  }
  Json list = Json::array();
  for (const auto& [key, cell] : cells) {
    const auto scene = std::get<0>(key), n_star = std::get<1>(key), method = std::get<2>(key);
    Json json{{"task", task_name(data.task)},
              {"scene", data.scenes[static_cast<std::size_t>(scene)]},
              {"n_star", protocol.n_stars[static_cast<std::size_t>(n_star)]},
              {"method", protocol.methods[static_cast<std::size_t>(method)]}};
    json.update(timed_json(cell));
    list.push_back(std::move(json));
  }
  return list;
}

Json timing_by_cell_json(const TaskData& data) {
  const Design& design = data.protocol.whole->design;
  std::map<int, TimedCell> cells;
  for (const TimedShowing& one : data.showings) cells[one.shown.cell].add(one.shown);
  Json list = Json::array();
  for (const auto& [index, timed] : cells) {
    const Cell& cell = design.cells.at(static_cast<std::size_t>(index));
    Json json{{"cell", cell_name(design, cell)},
              {"asked", cell.setting.profile ? Json(profile_text(*cell.setting.profile)) : Json()}};
    json.update(timed_json(timed));
    list.push_back(std::move(json));
  }
  return list;
}

Json timing_totals_json(const Json& timing) {
  Json list = Json::array();
  for (const Json& cell : timing) {
    if (list.empty() || list.back().at("task") != cell.at("task"))
      list.push_back({{"task", cell.at("task")}, {"cells", 0}, {"flawed_cells", 0}});
    Json& total = list.back();
    const auto add = [&](const char* key, int n) { total[key] = total.value(key, 0) + n; };
    for (const char* key : {"showings", "pass", "degraded", "fail", "unjudged"})
      add(key, cell.at(key).get<int>());
    if (cell.contains("not_recorded")) add("not_recorded", cell.at("not_recorded").get<int>());
    add("cells", 1);
    add("flawed_cells", cell.at("degraded").get<int>() + cell.at("fail").get<int>() > 0 ? 1 : 0);
  }
  return list;
}

}  // namespace study
