#include "apps/stats/tasks/results.hpp"

#include "apps/stats/tasks/data_json.hpp"
#include "apps/stats/tasks/hypotheses_json.hpp"
#include "apps/stats/tasks/sensitivity.hpp"
#include "apps/stats/tasks/task1_json.hpp"
#include "apps/stats/tasks/task2_json.hpp"
#include "stats/base/file.hpp"
#include "stats/gsl_errors.hpp"

namespace apps {

namespace {

/// One task's parts of the document.
struct TaskPart {
  TaskData data;
  Json results;
  std::vector<stats::Hypothesis> hypotheses;
  Json sensitivity;
};

stats::Result<TaskPart> analyse(const study::TaskStudy& study, const TaskSelection& selection) {
  const auto data = select_task(study, selection);
  if (!data) return stats::Refusal{data.reason()};
  TaskPart part{*data, {}, {}, {}};
  if (selection.task == TaskKind::Task1) {
    const auto results = analyse_task1(*data, selection.plan);
    if (!results) return stats::Refusal{results.reason()};
    part.results = task1_json(*data, *results, selection.plan);
    part.hypotheses = results->hypotheses;
  } else {
    const auto methods = static_cast<int>(data->protocol.methods.size());
    const auto analysis = stats::analyse_preferences(data->choices, methods, selection.plan);
    part.results = task2_json(*data, analysis, selection.plan);
    part.hypotheses =
        stats::task2_hypotheses(analysis.pairs, data->protocol.methods, selection.plan, data->gaze_problem());
  }
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
            {"timing", Json::array()}};
  for (const TaskPart& part : parts) {
    json["flow"][task_name(part.data.task)] = flow_json(part.data.flow);
    append(json["exclusions"], exclusions_json(part.data));
    append(json["timing"], timing_json(part.data));
  }
  for (const TaskPart& part : parts) json[task_name(part.data.task)] = part.results;
  json["hypotheses"] = Json::array();
  json["sensitivity"] = Json::array();
  for (const TaskPart& part : parts) {
    for (const auto& hypothesis : part.hypotheses) json["hypotheses"].push_back(hypothesis_json(hypothesis));
    append(json["sensitivity"], part.sensitivity);
  }
  return json;
}

}  // namespace

Results study_results(const ResultsRequest& request) {
  return make_results(study::read_tasks(request.database), request);
}

Results make_results(const study::TaskStudy& study, const ResultsRequest& request) {
  Results out;
  std::vector<TaskPart> parts;
  for (const TaskKind task : request.tasks) {
    const auto part = analyse(study, {task, request.protocol, request.plan.plan});
    if (part) {
      parts.push_back(*part);
    } else {
      out.missing.push_back({task, part.reason()});
    }
  }
  out.json = assemble(request, parts);
  return out;
}

}  // namespace apps
