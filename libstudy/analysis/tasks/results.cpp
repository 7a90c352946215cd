#include "libstudy/analysis/tasks/results.hpp"

#include <algorithm>
#include <set>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "libstudy/analysis/tasks/costs_json.hpp"
#include "libstudy/analysis/tasks/data_json.hpp"
#include "libstudy/analysis/tasks/descriptives_json.hpp"
#include "libstudy/analysis/tasks/exploration_json.hpp"
#include "libstudy/analysis/tasks/hypotheses_json.hpp"
#include "libstudy/analysis/tasks/people_json.hpp"
#include "libstudy/analysis/tasks/sensitivity.hpp"
#include "libstudy/analysis/tasks/station_timing.hpp"
#include "libstudy/analysis/tasks/task1_json.hpp"
#include "libstudy/analysis/tasks/task2_json.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/base/file.hpp"
#include "stats/gsl_errors.hpp"

namespace study {

namespace {

/// One analysis with the entries that it adds to the results document.
struct TaskPart {
  TaskData data;
  std::vector<std::string> described;  ///< ids of the questions whose answers are described
  Json results = {};                   ///< entry named after the task, or {"refused": reason}
  std::vector<stats::Hypothesis> hypotheses = {};
  std::vector<stats::ShownClaims::LeftOut> not_analysed = {};
  Json sensitivity = Json::array();
};

/// A sentence on what the protocol of a design lacks for the built-in analyses.
std::string what_it_lacks(const TaskData& data) {
  const auto& protocol = data.protocol;
  const std::string lacks =
      protocol.pairs && protocol.methods.size() > 1
          ? "asks no question of kind choice with exactly two anchors, one for each of a pair"
      : protocol.pairs   ? "shows pairs of one method"
      : protocol.pilot() ? "asks no question on a scale"
                         : "asks no question 'realism' on a scale";
  return "protocol " + protocol.name + " " + lacks;
}

/// True if the protocol has factors of its own. `vip-stats study` analyses such a protocol. This file does
/// not, because its tables by scene and n_* would pool the levels of these factors.
bool varies_own_factors(const TaskData& data) {
  return data.task == TaskKind::Own && data.protocol.whole && !data.protocol.whole->design.factors.empty();
}

std::string why_not_analysed(const TaskData& data) {
  if (varies_own_factors(data))
    return "protocol " + data.protocol.name + " has factors of its own: vip-stats study analyses it";
  return what_it_lacks(data) + ", so no shipped analysis covers it; its answers are described by cell";
}

/// The analysis and the hypotheses that are left out for a design without a built-in analysis, with reasons.
std::vector<stats::ShownClaims::LeftOut> left_out_of_own(const TaskData& data,
                                                         const stats::AnalysisPlan& plan) {
  std::vector<stats::ShownClaims::LeftOut> out{{"own design", why_not_analysed(data)}};
  if (varies_own_factors(data)) return out;
  const std::string lacks = what_it_lacks(data);
  if (data.protocol.methods.size() < 2) {
    leave_out(out, plan, {}, lacks);
  } else {
    leave_out(out, plan, 1, data.protocol.pairs ? methods_in_pairs : lacks);
    leave_out(out, plan, 2, data.protocol.pairs ? lacks : no_pairs);
  }
  return out;
}

/// Makes the entry named after the task, such as "task1", and sets the part's hypotheses and not_analysed.
/// Refused with the reason if no answer can be analysed or no built-in analysis applies.
stats::Result<Json> results_of(TaskPart& part, const ResultsRequest& request) {
  const TaskData& data = part.data;
  const stats::AnalysisPlan& plan = request.plan.plan;
  if (data.task == TaskKind::Own) part.not_analysed = left_out_of_own(data, plan);
  if (const std::string nothing = nothing_counts(data); !nothing.empty()) return stats::Refusal{nothing};
  if (data.task == TaskKind::Own) return stats::Refusal{why_not_analysed(data)};
  if (data.task == TaskKind::Pilot) {
    stats::BootstrapOptions bootstrap;
    bootstrap.seed = plan.seed;
    bootstrap.confidence = plan.confidence;
    const double level = level_of({data.task, {}, plan, {}, request.level}, data.question);
    Json fitted = fit_json(fit_pilot(data, level, bootstrap, plan.pilot));
    fitted["distributions"] = distributions_json(data);
    return fitted;
  }
  if (data.task == TaskKind::Task1) {
    const auto results = analyse_task1(data, plan);
    part.hypotheses = results.hypotheses;
    part.not_analysed = results.left_out;
    return task1_json(data, results, plan);
  }
  const auto methods = static_cast<int>(data.protocol.methods.size());
  const auto analysis = stats::analyse_preferences(data.choices, methods, plan);
  // The plan's hypotheses compare methods, so they are not tested if effects vary.
  if (data.protocol.effects.empty()) {
    auto claims =
        stats::claims_about(stats::task2_hypotheses(claims_in_force(plan), analysis.pairs,
                                                    data.protocol.methods, plan, data.gaze_problem()),
                            data.protocol.methods);
    part.hypotheses = std::move(claims.claims);
    part.not_analysed = std::move(claims.left_out);
  }
  return task2_json(data, analysis, plan);
}

/// Ids of the questions whose answers this analysis describes, so that each is described once: a main
/// question in its own analysis, any other in the first analysis of its protocol. `only`: the question that
/// the user selected; empty: all.
std::vector<std::string> described_questions(const ChosenTask& chosen, const std::string& only) {
  std::vector<std::string> out;
  for (const Question& question : chosen.protocol.questions) {
    const bool own = question.id == chosen.question.id;
    const bool others =
        chosen.first_of_protocol && only.empty() &&
        (kind_of(chosen.protocol) == TaskKind::Own || !is_main_question(chosen.protocol, question));
    if (own || others) out.push_back(question.id);
  }
  return out;
}

/// Analyses one protocol and question. If no answer can be analysed or no built-in analysis applies, the part
/// still counts the participants and exclusions, and the reason is added to `missing`.
TaskPart analyse(const TaskStudy& study, const ChosenTask& chosen, const ResultsRequest& request,
                 std::vector<MissingTask>& missing) {
  const TaskSelection selection{kind_of(chosen.protocol), request.protocol, request.plan.plan};
  TaskPart part{.data = collect_task(study, chosen, selection.plan.exclusions),
                .described = described_questions(chosen, request.question)};
  const auto results = results_of(part, request);
  part.results = results ? *results : json_refused(results.reason());
  if (!results)
    missing.push_back({selection.task, results.reason(),
                       part.data.flow.trials_excluded > 0
                           ? "collect answers, or give other rules of exclusion with --plan"
                           : "collect answers"});
  if (results && !part.hypotheses.empty())
    part.sensitivity = sensitivity_json(study, selection, part.data, part.hypotheses);
  return part;
}

void append(Json& list, const Json& more) {
  for (const auto& one : more) list.push_back(one);
}

Json not_analysed_json(const TaskPart& part) {
  Json list = Json::array();
  for (const auto& [what, reason, ids] : part.not_analysed)
    list.push_back({{"task", task_name(part.data.task)},
                    {"protocol", part.data.protocol.name},
                    {"what", what},
                    {"reason", reason}});
  return list;
}

Json assemble(const ResultsRequest& request, const std::vector<TaskPart>& parts,
              const std::vector<PersonalEntry>& about_people) {
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
            {"study", study_json(request.database.filename().string(), data, request.plan.plan)},
            {"flow", Json::object()},
            {"exclusions", Json::array()},
            {"people", people_json(data, about_people)},
            {"timing", Json::array()},
            {"response_times", Json::array()},
            {"costs", Json::array()}};
  if (request.sweep) json["sweep"] = sweep_json(request.sweep_file, *request.sweep);
  for (std::size_t i = 0; i < parts.size(); ++i)
    json["study"]["protocols"][i]["rules"] = acting_rules_json(parts[i].data, request.plan.plan.exclusions);
  json["descriptives"] = Json::array();
  json["not_analysed"] = Json::array();
  for (const auto& one : request.plan.plan.hypotheses)
    json["not_analysed"].push_back(
        {{"task", "own"},
         {"protocol", ""},
         {"what", one.id},
         {"reason",
          "it lacks the key task, so that only vip-stats study tests it, in a study with "
          "factors; a hypothesis about methods has task = \"task1\" or \"task2\""}});
  Json stations = Json::array();
  for (const TaskPart& part : parts) {
    json["flow"][task_name(part.data.task)] = flow_json(part.data.flow);
    append(json["exclusions"], exclusions_json(part.data));
    append(json["timing"], timing_json(part.data));
    append(stations, station_timing_json(part.data));
    append(json["response_times"], response_times_json(part.data));
    append(json["costs"], costs_json(part.data, request.sweep.get()));
    if (!varies_own_factors(part.data))
      append(json["descriptives"], descriptives_json(part.data, part.described));
    append(json["not_analysed"], not_analysed_json(part));
  }
  json["timing_totals"] = timing_totals_json(json["timing"]);
  if (!stations.empty()) json["timing_stations"] = std::move(stations);
  for (const TaskPart& part : parts) json[task_name(part.data.task)] = part.results;
  json["hypotheses"] = Json::array();
  json["sensitivity"] = Json::array();
  std::vector<stats::Hypothesis> claims;
  for (const TaskPart& part : parts) {
    claims.insert(claims.end(), part.hypotheses.begin(), part.hypotheses.end());
    append(json["sensitivity"], part.sensitivity);
  }
  stats::correct_over_claims(claims, claims_in_force(request.plan.plan).size());
  for (const auto& hypothesis : claims) json["hypotheses"].push_back(hypothesis_json(hypothesis));
  return json;
}

/// Name of the document at this index (from 0) of the list "apart", which holds the analyses beyond the first
/// of each task: "apart 1" for index 0.
std::string apart_name(std::size_t index) { return "apart " + std::to_string(index + 1); }

/// Number of simulated participants with answers, analysed or not. A participant of several protocols counts
/// once.
std::size_t simulated_people(const TaskStudy& study) {
  std::set<std::string> people;
  for (const TaskProtocol& protocol : study.protocols)
    for (const TaskSession& session : protocol.sessions)
      if (is_simulated(session)) people.insert(session.participant);
  return people.size();
}

/// For the SHA-256 of each analysed protocol, the sections that analyse it: the task's name if the analysis
/// is in `first`, such as "apart 1" (apart_name()) if it is in `others`.
std::multimap<std::string, std::string> sections_of(const std::vector<TaskPart>& first,
                                                    const std::vector<TaskPart>& others) {
  std::multimap<std::string, std::string> out;
  for (const TaskPart& part : first) out.emplace(part.data.protocol.sha256, task_name(part.data.task));
  for (std::size_t i = 0; i < others.size(); ++i) out.emplace(others[i].data.protocol.sha256, apart_name(i));
  return out;
}

/// Entries of not_analysed for the hypotheses that the plan declares about a task without an analysis here.
/// A plan that declares no hypotheses about methods gets no entry, although the shipped ones are then tested.
Json claims_without_task(const ResultsRequest& request, const std::vector<TaskPart>& parts) {
  Json list = Json::array();
  for (const TaskKind task : {TaskKind::Task1, TaskKind::Task2}) {
    // An analysis of an own design lists all hypotheses itself.
    const bool listed = std::ranges::any_of(parts, [&](const TaskPart& part) {
      return part.data.task == task || part.data.task == TaskKind::Own;
    });
    const auto ids = ids_of(claims_of_task(request.plan.plan.claims, task == TaskKind::Task1 ? 1 : 2));
    if (listed || ids.empty()) continue;
    const bool asked = std::ranges::find(request.tasks, task) != request.tasks.end();
    list.push_back({{"task", task_name(task)},
                    {"protocol", ""},
                    {"what", ids_in_short(ids)},
                    {"reason", (asked ? std::string("the database has no analysed answer of ")
                                      : std::string("this command does not analyse ")) +
                                   task_name(task)}});
  }
  return list;
}

}  // namespace

Results study_results(const ResultsRequest& request) {
  const StudyFile file(request.database, request.incomplete);
  auto study = read_tasks(file);
  read_about_people(file, study);
  return make_results(study, request);
}

Results make_results(const TaskStudy& study, const ResultsRequest& request) {
  Results out;
  std::vector<TaskPart> first, others;
  for (const TaskKind task : request.tasks) {
    const auto chosen = choose_tasks(study, {task, request.protocol, request.plan.plan, request.question});
    if (!chosen) {
      out.missing.push_back(
          {task, chosen.reason(),
           mend_of_choice(study, {task, request.protocol, request.plan.plan, request.question})});
      continue;
    }
    for (const ChosenTask& one : *chosen)
      (&one == &chosen->front() ? first : others).push_back(analyse(study, one, request, out.missing));
  }
  out.json = assemble(request, first, study.about_people);
  append(out.json["not_analysed"], claims_without_task(request, first));
  out.json["study"]["simulated_people"] = simulated_people(study);
  out.json["roster"] = roster_json(study, sections_of(first, others));
  if (!others.empty()) out.json["apart"] = Json::array();
  for (TaskPart& part : others) {
    std::vector<TaskPart> alone;
    alone.push_back(std::move(part));
    Json document = assemble(request, alone, study.about_people);
    document["section"] = apart_name(out.json["apart"].size());
    out.json["apart"].push_back(std::move(document));
  }
  if (!study.lacking.empty()) {
    out.json["study"]["incomplete"] = study.lacking;
    if (!others.empty()) {
      for (Json& document : out.json["apart"]) document["study"]["incomplete"] = study.lacking;
    }
  }
  return out;
}

}  // namespace study
