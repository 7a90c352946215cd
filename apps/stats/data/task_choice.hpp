#pragma once
/// Which protocol of a database and which of its questions are analysed.

#include <string>
#include <vector>

#include "libstudy/store/task_answers.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/result.hpp"

namespace apps {

enum class TaskKind { Pilot, Task1, Task2 };
/// "pilot", "task1", "task2".
const char* task_name(TaskKind task);
/// For print: "Pilot", "Task 1", "Task 2".
const char* task_title(TaskKind task);
TaskKind kind_of(const study::TaskProtocol& protocol);

struct TaskSelection {
  TaskKind task = TaskKind::Task1;
  std::string protocol;  ///< leading digits of the SHA-256; empty when one protocol fits
  stats::AnalysisPlan plan;
  std::string question = {};  ///< pilot: id of the scale; empty when one is asked
};

bool has_answers(const study::TaskSession& session);
bool has_real_answers(const study::TaskProtocol& protocol);

struct ChosenProtocol {
  study::TaskProtocol protocol;
  std::vector<std::string> set_aside;  ///< "name 1.0": protocols of this task with nothing but test data
};

/// The one protocol asked for; test data step back behind real ones. Refused with the reason.
stats::Result<ChosenProtocol> choose_protocol(const study::TaskStudy& study, const TaskSelection& selection);

/// Realism of Task 1, the choice of Task 2, the pilot's scale. Refused with the reason.
stats::Result<study::Question> main_question(const study::TaskProtocol& protocol,
                                             const TaskSelection& selection);

}  // namespace apps
