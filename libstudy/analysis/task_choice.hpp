#pragma once
/// Chooses the protocols of a database and the questions that are analysed, and the score at which a pilot's
/// curve is fitted.

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
  Task2,  ///< methods shown in pairs, with a choice between the two
  Own  ///< any other design: its answers are described; `vip-stats study` tests hypotheses of a design with
       ///< factors
};
/// Name in JSON and in options: "pilot", "task1", "task2", "own".
const char* task_name(TaskKind task);
/// Title for display: "Pilot", "Task 1", "Task 2", "Own design".
const char* task_title(TaskKind task);
TaskKind kind_of(const TaskProtocol& protocol);

/// Name, version and first 12 digits of the SHA-256: "name 1.0 0123456789ab".
std::string hashed_name(const TaskProtocol& protocol);
/// True if `by` denotes the protocol: by the first digits of its SHA-256, by its name, by name and version,
/// or by hashed_name(), which messages print. An empty `by` denotes every protocol.
bool is_meant(const TaskProtocol& protocol, const std::string& by);

/// The selection made by a command's options.
struct TaskSelection {
  TaskKind task = TaskKind::Task1;
  std::string protocol;  ///< text for is_meant(); empty: all protocols
  stats::AnalysisPlan plan;
  std::string question = {};         ///< the question's id; empty: all main questions
  std::optional<double> level = {};  ///< pilot: score at which the curve is fitted; empty: see level_of()
};

/// Score at which a pilot's curve is fitted: the level of the selection, else of the plan, else of the
/// protocol, else the middle of the scale.
double level_of(const TaskSelection& selection, const Question& question);

bool has_answers(const TaskSession& session);
/// True if an observer model answered any page of the session.
bool is_simulated(const TaskSession& session);
/// True if a session of the protocol that is not marked as test data has answers.
bool has_real_answers(const TaskProtocol& protocol);

/// A protocol that is not analysed: it has no real answers (see has_real_answers()), while another protocol
/// of the same task has some.
struct SetAside {
  std::string name;  ///< "name 1.0, SHA-256 0123456789ab": two protocols may have the same name and version
  int sessions = 0;
};

/// One protocol and the question whose answers are analysed.
struct ChosenTask {
  TaskProtocol protocol;
  std::vector<SetAside> set_aside;
  /// The analysed question: 'realism' in Task 1, the choice in Task 2, a scale in the pilot, in another
  /// design the first or the selected question.
  Question question;
  bool first_of_protocol = true;  ///< true for the first question chosen from this protocol
  bool own = false;               ///< true: analysed as TaskKind::Own, whatever the kind of the protocol
};

/// True if the question has a separate analysis: in a pilot every scale except those on sickness, in Task 1
/// the scale 'realism', in Task 2 every choice of two, in another design the protocol's first question.
bool is_main_question(const TaskProtocol& protocol, const Question& question);

/// One entry for each protocol that matches the selection and each of its main questions. A selected question
/// replaces the main questions; it must be one of them unless the design is TaskKind::Own. Protocols without
/// answers other than test data are set aside if another match has some. Refused with the reason if nothing
/// matches.
stats::Result<std::vector<ChosenTask>> choose_tasks(const TaskStudy& study, const TaskSelection& selection);

/// The protocol and question that match the selection. Refused with the reason if none or several match,
/// since answers to several protocols or questions are never pooled.
stats::Result<ChosenTask> choose_task(const TaskStudy& study, const TaskSelection& selection);

/// Advice to the user if choose_task() is refused. It names only protocols and questions of the database.
/// Empty if choose_task() is not refused.
std::string mend_of_choice(const TaskStudy& study, const TaskSelection& selection);

/// The reason why the user's choice of protocol or question selects no analysis of any task. `mend` receives
/// the advice. `protocol`: the user's text.
stats::Refusal nothing_chosen(const TaskStudy& study, const std::string& protocol, std::string& mend);

/// True if the level lies strictly between the ends of the question's scale; a curve can be fitted only
/// there. outside_scale() gives the reason and mend_of_level() the advice for any other level.
bool within_scale(double level, const Question& question);
std::string outside_scale(double level, const Question& question);
std::string mend_of_level(const Question& question);

}  // namespace study
