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
  std::string protocol;  ///< its name, with or without version, or leading digits of its SHA-256; empty: all
  stats::AnalysisPlan plan;
  std::string question = {};         ///< its id; empty: all
  std::optional<double> level = {};  ///< pilot: score of the curve; none: that of level_of()
};

/// Score at which a pilot's curve is fitted: that of the selection, else of the plan, else of the protocol,
/// which without one means the middle of the scale.
double level_of(const TaskSelection& selection, const study::Question& question);

bool has_answers(const study::TaskSession& session);
/// Answered by an observer model, on whatever page.
bool is_simulated(const study::TaskSession& session);
bool has_real_answers(const study::TaskProtocol& protocol);

/// A protocol of a task that is not analysed, as it holds nothing but test data and others hold real data.
struct SetAside {
  std::string name;  ///< "name 1.0, SHA-256 0123456789ab": two may have one name and version
  int sessions = 0;
};

/// One protocol and the question whose answers are analysed.
struct ChosenTask {
  study::TaskProtocol protocol;
  std::vector<SetAside> set_aside;
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

/// What to do where choose_task() is refused: only what there is to choose from; empty: it is not.
std::string mend_of_choice(const study::TaskStudy& study, const TaskSelection& selection);

/// Why no analysis at all, of whatever task, was chosen, and what to do. `protocol`: as given.
stats::Refusal nothing_chosen(const study::TaskStudy& study, const std::string& protocol, std::string& mend);

/// A curve is fitted between the ends of its scale. The reason and the mend are the same for every command.
bool within_scale(double level, const study::Question& question);
std::string outside_scale(double level, const study::Question& question);
std::string mend_of_level(const study::Question& question);

}  // namespace apps
