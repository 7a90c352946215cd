#pragma once
/// Chooses which protocols of a database and which of their questions to analyse, and at which level of a
/// scale.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/read/task_answers.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/result.hpp"

namespace study {

/// The kind of analysis of a protocol.
enum class TaskKind {
  Pilot,  ///< one method under several frame rates, rated on a scale
  Task1,  ///< methods shown one by one, rated for realism
  Task2,  ///< pairs of methods, with a choice of one
  Own     ///< any other design: its answers are described, and no hypothesis is tested
};
/// "pilot", "task1", "task2", "own".
const char* task_name(TaskKind task);
/// For display: "Pilot", "Task 1", "Task 2", "Own design".
const char* task_title(TaskKind task);
TaskKind kind_of(const TaskProtocol& protocol);

/// The selection made by a command's options.
struct TaskSelection {
  TaskKind task = TaskKind::Task1;
  std::string protocol;  ///< its name, with or without version, or leading digits of its SHA-256; empty: all
  stats::AnalysisPlan plan;
  std::string question = {};         ///< its id; empty: all
  std::optional<double> level = {};  ///< pilot: score at which the curve is fitted; empty: see level_of()
};

/// Score at which a pilot's curve is fitted: that of the selection, else of the plan, else of the protocol,
/// whose default is the middle of the scale.
double level_of(const TaskSelection& selection, const Question& question);

bool has_answers(const TaskSession& session);
/// True if an observer model answered it, on any page.
bool is_simulated(const TaskSession& session);
bool has_real_answers(const TaskProtocol& protocol);

/// A protocol that is not analysed because it holds only test data while other protocols of its task hold
/// real data.
struct SetAside {
  std::string name;  ///< "name 1.0, SHA-256 0123456789ab", since two may have one name and version
  int sessions = 0;
};

/// One protocol and the question whose answers are analysed.
struct ChosenTask {
  TaskProtocol protocol;
  std::vector<SetAside> set_aside;
  /// Realism of Task 1, the choice of Task 2, a scale of the pilot, the first question of another design.
  Question question;
  bool first_of_protocol = true;  ///< true for the first question chosen from this protocol
};

/// True if the question gets an analysis of its own: the protocol asks it about its trials and its kind suits
/// the task.
bool is_main_question(const TaskProtocol& protocol, const Question& question);

/// All protocols that match the selection and have real answers, or if there are none, all that match; for
/// each, every main question. Refused with the reason if nothing matches.
stats::Result<std::vector<ChosenTask>> choose_tasks(const TaskStudy& study, const TaskSelection& selection);

/// The only match. Refused with the reason if there are several, which are never pooled, or none.
stats::Result<ChosenTask> choose_task(const TaskStudy& study, const TaskSelection& selection);

/// Advice if choose_task() is refused, naming only existing choices; empty if it is not refused.
std::string mend_of_choice(const TaskStudy& study, const TaskSelection& selection);

/// The reason why no analysis of any task was chosen; `mend` gets the advice. `protocol`: as given.
stats::Refusal nothing_chosen(const TaskStudy& study, const std::string& protocol, std::string& mend);

/// True if the level lies between the ends of the scale, as a curve requires. The reason and the advice are
/// the same for every command.
bool within_scale(double level, const Question& question);
std::string outside_scale(double level, const Question& question);
std::string mend_of_level(const Question& question);

}  // namespace study
