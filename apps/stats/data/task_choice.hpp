#pragma once
/// Which protocols of a database and which of their questions are analysed, and at which level of a scale.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/task_answers.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/result.hpp"

namespace apps {

/// What a protocol is analysed as.
enum class TaskKind {
  Pilot,  ///< one method under several frame rates, rated on a scale
  Task1,  ///< methods shown one by one, rated for realism
  Task2,  ///< pairs of methods, one of which is chosen
  Own     ///< any other design: its answers are described, and no hypothesis is tested
};
/// "pilot", "task1", "task2", "own".
const char* task_name(TaskKind task);
/// For print: "Pilot", "Task 1", "Task 2", "Own design".
const char* task_title(TaskKind task);
TaskKind kind_of(const study::TaskProtocol& protocol);

/// What the options of a command ask for.
struct TaskSelection {
  TaskKind task = TaskKind::Task1;
  std::string protocol;  ///< leading digits of the SHA-256; empty: all
  stats::AnalysisPlan plan;
  std::string question = {};         ///< its id; empty: all
  std::optional<double> level = {};  ///< pilot: score of the curve; none: that of level_of()
};

/// Score at which a pilot's curve is fitted: that of the selection, else of the plan, else of the protocol,
/// which without one means the middle of the scale.
double level_of(const TaskSelection& selection, const study::Question& question);

bool has_answers(const study::TaskSession& session);
bool has_real_answers(const study::TaskProtocol& protocol);

/// One protocol and the question whose answers are analysed.
struct ChosenTask {
  study::TaskProtocol protocol;
  std::vector<std::string> set_aside;  ///< "name 1.0": protocols of this task with nothing but test data
  /// Realism of Task 1, the choice of Task 2, a scale of the pilot, the first question of another design.
  study::Question question;
  bool first_of_protocol = true;  ///< no question of this protocol was chosen before
};

/// Whether the protocol asks it of each trial, so that it is analysed by itself.
bool is_main_question(const study::TaskProtocol& protocol, const study::Question& question);

/// All that is asked for: those protocols with real answers, or without any all of them; of each, every main
/// question. Refused with the reason when there is none.
stats::Result<std::vector<ChosenTask>> choose_tasks(const study::TaskStudy& study,
                                                    const TaskSelection& selection);

/// The only one. Refused with the reason where there are several, as they are never pooled.
stats::Result<ChosenTask> choose_task(const study::TaskStudy& study, const TaskSelection& selection);

}  // namespace apps
