#include "libstudy/analysis/tasks/sensitivity.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "libstudy/analysis/tasks/hypotheses_json.hpp"
#include "libstudy/analysis/tasks/task1_results.hpp"
#include "libstudy/protocol/method_claims.hpp"

namespace study {

namespace {

using Verdicts = std::vector<stats::Hypothesis>;

stats::Result<Verdicts> verdicts(const TaskData& data, const stats::AnalysisPlan& plan) {
  if (data.task == TaskKind::Task1) return task1_verdicts(data, plan);
  const auto methods = static_cast<int>(data.protocol.methods.size());
  return stats::claims_about(stats::task2_hypotheses(claims_in_force(plan),
                                                     stats::count_preferences(data.choices, methods, plan),
                                                     data.protocol.methods, plan, data.gaze_problem()),
                             data.protocol.methods)
      .claims;
}

Json changed(const Verdicts& planned, const Verdicts& other) {
  Json ids = Json::array();
  for (std::size_t i = 0; i < planned.size() && i < other.size(); ++i) {
    if (planned[i].status_if_testable != other[i].status_if_testable) ids.push_back(planned[i].id);
  }
  return ids;
}

/// Collects one entry for each variant of the analysis.
class Writer {
 public:
  Writer(TaskKind task, const Verdicts& planned) : task_(task), planned_(planned) {}

  void add(const char* id, const char* label, const stats::Result<TaskData>& data,
           const stats::AnalysisPlan& plan) {
    Json json{{"id", id}, {"label", label}, {"task", task_name(task_)}};
    const auto other = data ? verdicts(*data, plan) : stats::Result<Verdicts>(stats::Refusal{data.reason()});
    if (!other) {
      json["refused"] = other.reason();
    } else {
      json["participants"] = data->participants.size();
      json["answers"] = task_ == TaskKind::Task1 ? data->reports.size() : data->choices.size();
      json["hypotheses"] = Json::array();
      for (const auto& one : *other) json["hypotheses"].push_back(hypothesis_outline_json(one));
      json["changed"] = changed(planned_, *other);
    }
    list_.push_back(std::move(json));
  }
  Json take() { return std::move(list_); }

 private:
  TaskKind task_;
  const Verdicts& planned_;
  Json list_ = Json::array();
};

/// The study with only those sessions in which gaze was tracked.
TaskStudy with_tracked_gaze(TaskStudy study) {
  for (auto& protocol : study.protocols)
    std::erase_if(protocol.sessions, [](const TaskSession& one) { return one.gaze_source != "tracked"; });
  return study;
}

/// The data with each block (one participant's reports on one scene at one n_* in one visit) treated as a
/// separate participant.
TaskData with_blocks_pooled(TaskData data) {
  std::map<std::tuple<int, int, int, int>, int> blocks;
  for (Report& report : data.reports) {
    report.participant =
        blocks
            .emplace(std::tuple{report.participant, report.visit, report.scene, report.n_star},
                     static_cast<int>(blocks.size()))
            .first->second;
  }
  data.participants.resize(blocks.size());
  data.unanswered.clear();  // their participant numbers refer to people, not to blocks
  return data;
}

/// True if a participant has several reports on one method at one n_*. The planned analysis averages these
/// reports, so with_blocks_pooled() can lead to other results.
bool averages_blocks(const TaskData& data) {
  std::map<std::tuple<int, int, int>, int> reports;
  return std::any_of(data.reports.begin(), data.reports.end(), [&](const Report& one) {
    return ++reports[{one.participant, one.n_star, one.method}] > 1;
  });
}

bool mixed_gaze(const TaskData& data) { return data.gaze.size() > 1 && data.gaze.contains("tracked"); }

bool repeated_pairs(const TaskData& data) {
  std::map<std::tuple<int, int, int>, int> answers;
  return std::any_of(data.choices.begin(), data.choices.end(), [&](const stats::PairChoice& one) {
    return ++answers[{one.participant, std::min(one.first, one.second), std::max(one.first, one.second)}] > 1;
  });
}

}  // namespace

Json sensitivity_json(const TaskStudy& study, const TaskSelection& selection, const TaskData& data,
                      const std::vector<stats::Hypothesis>& planned) {
  Writer writer(selection.task, planned);
  writer.add("planned", "as planned", data, selection.plan);

  TaskSelection other = selection;
  other.protocol = data.protocol.sha256;
  other.question = data.question.id;
  other.plan.exclusions = {.timing = stats::TimingRule::None,
                           .min_catch_correct = {},
                           .max_repeat_difference = {},
                           .min_repeat_agreement = {},
                           .straight_lining_answers = 0,
                           .min_answered = 0};
  writer.add("no_exclusions", "nothing excluded by rule", select_task(study, other), other.plan);

  other.plan = selection.plan;
  other.plan.exclusions.timing = stats::TimingRule::Degraded;
  writer.add("timing_pass_only", "only trials whose timing passed", select_task(study, other), other.plan);

  if (mixed_gaze(data)) {
    other.plan = selection.plan;
    writer.add("tracked_gaze_only", "only sessions with tracked gaze",
               select_task(with_tracked_gaze(study), other), other.plan);
  }
  if (selection.task == TaskKind::Task1 && averages_blocks(data))
    writer.add("blocks_pooled", "blocks of one participant taken as independent (rejects too often)",
               with_blocks_pooled(data), selection.plan);
  if (selection.task == TaskKind::Task2 && repeated_pairs(data)) {
    other.plan = selection.plan;
    other.plan.repeated_pairs = stats::RepeatedPairs::Warn;
    writer.add("trials_pooled", "trials of one participant taken as independent (rejects too often)", data,
               other.plan);
  }
  return writer.take();
}

}  // namespace study
