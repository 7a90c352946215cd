#include "libstudy/analysis/tasks/costs_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "libsim/setting/setting_file.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

struct RunningMean {
  double sum = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  Json json() const { return count > 0 ? Json(sum / count) : Json(); }
};

/// All sessions' measurements of one stimulus, and the answers to it.
struct ShownStimulus {
  StimulusSpec what;
  int sessions = 0, measured = 0;
  /// Means over the sessions of the mean and of the 95th percentile of the time in ms in which the session's
  /// computer computes and draws a frame.
  RunningMean made_ms, made_p95_ms;
  RunningMean interval_ms;  ///< mean frame interval in ms, over showings without a schedule of frames
  std::map<std::string, int> settings;  ///< number of sessions by setting text; "" = default setting
  std::set<std::string> stimuli;        ///< texts by which the sessions recorded what they showed
  RunningMean said;                     ///< Task 1: scores; Task 2: 1 if the stimulus was chosen, else 0
};
using Stimuli = std::map<std::array<int, 3>, ShownStimulus>;  // scene, n_*, method

std::array<int, 3> key_of(const TaskProtocol& protocol, const StimulusSpec& what) {
  return {place_in(protocol.scenes, what.scene), place_in(protocol.n_stars, what.n_star),
          place_in(protocol.methods, treatment_name(what))};
}

/// Text of the setting file with which the session ran this method at this n_*; empty: default setting.
std::string setting_text(const TaskSession& session, const StimulusSpec& what) {
  for (const auto& one : session.settings) {
    const auto setting = sim::parse_setting_file(one.text, "setting " + one.sha256.substr(0, 12)).setting;
    if (setting.method == sim::parse_method(what.method) &&
        std::llround(setting[sim::SolverKnob::Size]) == sim::parse_n_star(what.n_star))
      return one.text;
  }
  return {};
}

void add_session(const TaskProtocol& protocol, const TaskSession& session, Stimuli& out) {
  std::set<std::array<int, 3>> seen;
  const auto add = [&](const TaskShowing& showing) {
    if (!showing.played) return;
    const auto key = key_of(protocol, showing.what);
    ShownStimulus& shown = out[key];
    if (showing.nominal.mean == 0 && showing.realised.mean > 0)
      shown.interval_ms.add(1000 / showing.realised.mean);
    if (!seen.insert(key).second) return;
    ++shown.sessions;
    shown.what = showing.what;
    ++shown.settings[setting_text(session, showing.what)];
    shown.stimuli.insert(session.stimulus);
    RunningMean mean, p95;
    for (const auto& cost : session.frame_costs) {
      if (cost.what != showing.what) continue;
      mean.add(cost.mean_ms);
      p95.add(cost.p95_ms);
    }
    if (mean.count == 0) return;
    ++shown.measured;
    shown.made_ms.add(mean.sum / mean.count);
    shown.made_p95_ms.add(p95.sum / p95.count);
  };
  for (const auto& trial : session.trials) {
    if (trial.kind == "practice") continue;
    add(trial.first);
    if (trial.second) add(*trial.second);
  }
}

void add_answers(const TaskData& data, Stimuli& out) {
  for (const auto& report : data.reports) {
    const auto answer = report.answers.find(data.question.id);
    if (answer != report.answers.end())
      out[{report.scene, report.n_star, report.method}].said.add(answer->second);
  }
  // A choice does not record the n_* of its pair, so choices count only if the study has one n_*.
  if (data.protocol.n_stars.size() > 1) return;
  for (const auto& choice : data.choices) {
    out[{choice.scene, 0, choice.first}].said.add(choice.first_chosen ? 1 : 0);
    out[{choice.scene, 0, choice.second}].said.add(choice.first_chosen ? 0 : 1);
  }
}

/// Reads the stimulus's scene from its file. Refused if the file cannot be read, if a session did not record
/// the file's SHA-256, or if the stimulus has a level of effects other than the scene's.
stats::Result<sim::Scene> scene_of(const StimulusSpec& what, const ShownStimulus& shown) {
  if (!what.effects.empty() && what.effects != scene_effects_level)
    return stats::Refusal{"errors are measured with the scene's own effects, and this is level " +
                          what.effects + " of them"};
  const std::string& path = what.scene;
  sim::Scene scene;
  try {
    scene = sim::read_scene(base::find_input(path));
  } catch (const base::Error&) {
    return stats::Refusal{"the scene's file cannot be found or read here"};
  }
  for (const auto& stimulus : shown.stimuli)
    if (stimulus.find(scene.sha256) == std::string::npos)
      return stats::Refusal{"the sessions do not say that they showed this scene file live"};
  return scene;
}

Json spread_json(const Spread& spread) {
  return {{"mean", json_number(spread.mean)},
          {"low", json_number(spread.low)},
          {"high", json_number(spread.high)}};
}

/// The error that the recorded setting file states for its setting.
Json recorded_error_json(const sim::SettingFile& file, const stats::Result<sim::Scene>& scene) {
  if (!scene) return json_refused(scene.reason());
  if (file.measured.scene_sha256 != scene->sha256)
    return json_refused("the setting was measured on another scene file");
  const auto& m = file.measured;
  return {{"error", m.error},     {"mean", m.error_pct}, {"low", m.error_low_pct}, {"high", m.error_high_pct},
          {"ms_mean", m.ms_mean}, {"ms_p95", m.ms_p95},  {"machine", m.machine},   {"program", m.program}};
}

Json price_json(const SettingPrice& price) {
  const auto& origin = price.sweep->list.origin;
  const auto& plan = price.sweep->plan;
  Json json{{"machine", origin.machine},
            {"program", origin.program},
            {"scene", plan.scene},
            {"picture", plan.size.empty() ? "none" : plan.size},
            {"seconds", plan.seconds},
            {"reference_n_star", plan.n_star},
            {"starts", price.row->seeds},
            {"ms_mean", json_number(price.row->ms_mean)},
            {"ms_p95", json_number(price.row->ms_p95)},
            {"times_hires", price.hires ? json_number(price.row->ms_mean / price.hires->ms_mean) : Json()},
            {"errors", Json::object()}};
  if (!price.hires) json["times_hires_reason"] = "the sweep has no usual HiRes of this n_*";
  for (std::size_t e = 0; e < sweep_error_count; ++e)
    json["errors"][sweep_error_columns[e]] = spread_json(price.row->errors[e]);
  return json;
}

Json prices_json(const SettingPrices& prices) {
  if (prices.found.empty()) return json_refused(prices.why_none);
  Json list = Json::array();
  for (const auto& one : prices.found) list.push_back(price_json(one));
  return list;
}

sim::SolverSetting usual_in(const sim::Scene& scene, const StimulusSpec& what, double content_step_s) {
  sim::SimulationOptions options;
  options.method = sim::parse_method(what.method);
  options.n_star = sim::parse_n_star(what.n_star);
  options.frame_dt_s = content_step_s;
  return sim::setting_of(scene, options);
}

void add_made(Json& json, const ShownStimulus& shown) {
  json["measured_sessions"] = shown.measured;
  json["made_ms"] = shown.made_ms.json();
  json["made_p95_ms"] = shown.made_p95_ms.json();
  json["shown_ms"] = shown.interval_ms.json();
  for (const char* name : {"made_ms", "made_p95_ms"})
    if (json[name].is_null())
      json[std::string(name) + "_reason"] =
          "no session holds it: it is measured before live sessions on the real clock";
  if (json["shown_ms"].is_null())
    json["shown_ms_reason"] = "every showing had a schedule, which says nothing of what a frame costs";
}

void add_said(Json& json, const TaskData& data, const ShownStimulus& shown) {
  json["answers"] = shown.said.count;
  json["said"] = shown.said.json();
  if (shown.said.count > 0) return;
  json["said_reason"] = data.task == TaskKind::Own
                            ? "the answers of this design are described by question and cell"
                        : data.task == TaskKind::Task2 && data.protocol.n_stars.size() > 1
                            ? "pairs of several n_* are not distinguished"
                            : "no answer counts";
}

void add_errors(Json& json, const TaskData& data, const StimulusSpec& what, const ShownStimulus& shown,
                const SweepTables* sweep) {
  const std::string& text = shown.settings.begin()->first;
  const bool mixed = shown.settings.size() > 1, usual = text.empty();
  const auto scene = scene_of(what, shown);
  json["setting"] = mixed ? "several" : "usual";
  json["setting_sha256"] = Json();
  json["error"] =
      json_refused(mixed ? "its sessions ran at different settings" : "no setting file stands in the record");
  std::optional<sim::SettingFile> file;
  if (!mixed && !usual) {
    file = sim::parse_setting_file(text, "the record's setting");
    json["setting"] = in_words(file->setting);
    json["setting_sha256"] = base::sha256_hex(text);
    json["error"] = recorded_error_json(*file, scene);
  }
  if (!sweep) return;
  json["sweep"] =
      mixed    ? json_refused("its sessions ran at different settings")
      : !scene ? json_refused(scene.reason())
               : prices_json(prices_of(
                     *sweep, file ? file->setting : usual_in(*scene, what, data.protocol.content_step_s),
                     scene->sha256));
}

}  // namespace

Json costs_json(const TaskData& data, const SweepTables* sweep) {
  if (data.task == TaskKind::Pilot) return Json::array();
  Stimuli stimuli;
  for (const auto& session : data.protocol.sessions) add_session(data.protocol, session, stimuli);
  add_answers(data, stimuli);
  Json list = Json::array();
  for (const auto& [key, shown] : stimuli) {
    if (shown.sessions == 0) continue;
    const StimulusSpec& what = shown.what;
    Json json{{"task", task_name(data.task)},
              {"scene", data.scenes[static_cast<std::size_t>(key[0])]},
              {"n_star", what.n_star},
              {"method", treatment_name(what)},
              {"sessions", shown.sessions}};
    add_made(json, shown);
    add_errors(json, data, what, shown, sweep);
    add_said(json, data, shown);
    list.push_back(std::move(json));
  }
  return list;
}

Json sweep_json(const std::string& file, const SweepTables& sweep) {
  Json headings = Json::object();
  for (std::size_t e = 0; e < sweep_error_count; ++e) {
    const std::string_view column = sweep_error_columns[e];
    headings[sweep_error_columns[e]] = std::string(sweep_error_words[e]) + (column.ends_with("_pct")  ? ", %"
                                                                            : column.ends_with("_db") ? ", dB"
                                                                                                      : "");
  }
  return {{"file", file}, {"errors", headings}, {"left_out", sweep.left_out}};
}

}  // namespace study
