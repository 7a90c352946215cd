#include "apps/stats/tasks/results.hpp"

#include "apps/stats/ptpe/pilot_fit.hpp"
#include "apps/stats/tasks/costs_json.hpp"
#include "apps/stats/tasks/data_json.hpp"
#include "apps/stats/tasks/hypotheses_json.hpp"
#include "apps/stats/tasks/sensitivity.hpp"
#include "apps/stats/tasks/task1_json.hpp"
#include "apps/stats/tasks/task2_json.hpp"
#include "stats/base/file.hpp"
#include "stats/gsl_errors.hpp"

namespace apps {

namespace {

/// The pilot's level for the solver, the middle of the paper's scale.
constexpr double pilot_level = 4;

/// One task's parts of the document.
struct TaskPart {
  TaskData data;
  Json results;  ///< refused when no answer counts
  std::vector<stats::Hypothesis> hypotheses;
  Json sensitivity = Json::array();
};

/// What stands under the task's own name, and its hypotheses. Refused with the reason.
stats::Result<Json> results_of(TaskPart& part, const stats::AnalysisPlan& plan) {
  const TaskData& data = part.data;
  if (const std::string nothing = nothing_counts(data); !nothing.empty()) return stats::Refusal{nothing};
  if (data.task == TaskKind::Pilot) {
    stats::BootstrapOptions bootstrap;
    bootstrap.seed = plan.seed;
    bootstrap.confidence = plan.confidence;
    return fit_json(fit_pilot(data, pilot_level, bootstrap));
  }
  if (data.task == TaskKind::Task1) {
    const auto results = analyse_task1(data, plan);
    if (!results) return stats::Refusal{results.reason()};
    part.hypotheses = results->hypotheses;
    return task1_json(data, *results, plan);
  }
  const auto methods = static_cast<int>(data.protocol.methods.size());
  const auto analysis = stats::analyse_preferences(data.choices, methods, plan);
  // The paper's claims are about methods alone.
  if (data.protocol.effects.empty())
    part.hypotheses =
        stats::task2_hypotheses(analysis.pairs, data.protocol.methods, plan, data.gaze_problem());
  return task2_json(data, analysis, plan);
}

/// Refused without a protocol that is analysed; without an answer that counts, who left and why still stands.
stats::Result<TaskPart> analyse(const study::TaskStudy& study, const TaskSelection& selection,
                                std::vector<MissingTask>& missing) {
  const auto data = collect_task(study, selection);
  if (!data) return stats::Refusal{data.reason()};
  TaskPart part{*data, {}, {}};
  const auto results = results_of(part, selection.plan);
  part.results = results ? *results : json_refused(results.reason());
  if (!results) missing.push_back({selection.task, results.reason()});
  if (results && !part.hypotheses.empty())
    part.sensitivity = sensitivity_json(study, selection, *data, part.hypotheses);
  return part;
}

void append(Json& list, const Json& more) {
  for (const auto& one : more) list.push_back(one);
}

Json assemble(const ResultsRequest& request, const std::vector<TaskPart>& parts) {
  std::vector<const TaskData*> data;
  std::vector<std::string> protocols;
  for (const TaskPart& part : parts) {
    data.push_back(&part.data);
    protocols.push_back(part.data.protocol.sha256);
  }
  Json json{{"schema", "vip-results/1"},
            {"versions", {{"vip_lab", base::version()}, {"gsl", stats::gsl_library_version()}}},
            {"date_utc", base::utc_now()},
            {"plan", plan_json(request.plan, protocols)},
            {"study", study_json(request.database.filename().string(), data)},
            {"flow", Json::object()},
            {"exclusions", Json::array()},
            {"timing", Json::array()},
            {"costs", Json::array()}};
  if (request.sweep) json["sweep"] = sweep_json(request.sweep_file, *request.sweep);
  for (const TaskPart& part : parts) {
    json["flow"][task_name(part.data.task)] = flow_json(part.data.flow);
    append(json["exclusions"], exclusions_json(part.data));
    append(json["timing"], timing_json(part.data));
    append(json["costs"], costs_json(part.data, request.sweep.get()));
  }
  for (const TaskPart& part : parts) json[task_name(part.data.task)] = part.results;
  json["hypotheses"] = Json::array();
  json["sensitivity"] = Json::array();
  std::vector<stats::Hypothesis> claims;
  for (const TaskPart& part : parts) {
    claims.insert(claims.end(), part.hypotheses.begin(), part.hypotheses.end());
    append(json["sensitivity"], part.sensitivity);
  }
  stats::correct_over_claims(claims);
  for (const auto& hypothesis : claims) json["hypotheses"].push_back(hypothesis_json(hypothesis));
  return json;
}

}  // namespace

Results study_results(const ResultsRequest& request) {
  return make_results(study::read_tasks({request.database, request.incomplete}), request);
}

Results make_results(const study::TaskStudy& study, const ResultsRequest& request) {
  Results out;
  std::vector<TaskPart> parts;
  for (const TaskKind task : request.tasks) {
    const auto part = analyse(study, {task, request.protocol, request.plan.plan}, out.missing);
    if (part) {
      parts.push_back(*part);
    } else {
      out.missing.push_back({task, part.reason()});
    }
  }
  out.json = assemble(request, parts);
  if (!study.lacking.empty()) out.json["study"]["incomplete"] = study.lacking;
  return out;
}

}  // namespace apps
