#include "libstudy/analysis/task_choice.hpp"

#include <algorithm>

#include "libstudy/analysis/claims.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

using study::Question;
using study::TaskProtocol;
using study::TaskSession;
using study::TaskTrial;

constexpr const char* realism = "realism";

const char* what_it_shows(TaskKind task) {
  if (task == TaskKind::Pilot) return "that shows frame rates, rated on a scale";
  if (task == TaskKind::Own) return "of another design than the pilot, Task 1 and Task 2";
  return task == TaskKind::Task2 ? "that shows pairs of methods and asks a choice with exactly two anchors"
                                 : "that shows methods one by one, rated for 'realism' on a scale";
}

bool is_scale(const Question& question) { return traits_of(question.kind).rated() && !is_sickness(question); }

/// True if the question is a choice with exactly two anchors, one for each stimulus of a pair.
bool is_choice_of_two(const Question& question) {
  return traits_of(question.kind).labelled && question.anchors.size() == 2;
}

bool asks(const TaskProtocol& protocol, bool (*wanted)(const Question&)) {
  return std::any_of(protocol.questions.begin(), protocol.questions.end(), wanted);
}

std::string name_of(const TaskProtocol& protocol) { return protocol.name + " " + protocol.version; }

bool is_asked_for(const TaskProtocol& protocol, const TaskSelection& selection) {
  return kind_of(protocol) == selection.task && is_meant(protocol, selection.protocol);
}

std::ptrdiff_t answered_sessions(const TaskProtocol& protocol) {
  return std::count_if(protocol.sessions.begin(), protocol.sessions.end(), has_answers);
}

/// Questions of the protocol that are analysed: the selected question, or if none is selected, all main
/// questions. A protocol without questions gets one empty Question, so that it is still listed.
std::vector<Question> main_questions(const TaskProtocol& protocol, const TaskSelection& selection) {
  std::vector<Question> out;
  for (const Question& question : protocol.questions) {
    const bool chosen = question.id == selection.question;
    const bool main = is_main_question(protocol, question);
    if (selection.question.empty() ? main : chosen && (main || kind_of(protocol) == TaskKind::Own))
      out.push_back(question);
  }
  if (out.empty() && protocol.questions.empty() && selection.question.empty()) out.emplace_back();
  return out;
}

constexpr const char* choose_protocol = "choose one with --protocol: ";
constexpr const char* choose_question = "choose one with --question: ";

void list_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

std::vector<std::string> protocols_of(const std::vector<ChosenTask>& all) {
  std::vector<std::string> out;
  for (const ChosenTask& one : all) list_once(out, hashed_name(one.protocol));
  return out;
}

std::vector<std::string> questions_of(const std::vector<ChosenTask>& all) {
  std::vector<std::string> out;
  for (const ChosenTask& one : all) list_once(out, one.question.id);
  return out;
}

/// Protocols that match the selection. The first `real` of them have real answers, the others only test data
/// or no answers.
std::vector<const TaskProtocol*> protocols_for(const TaskStudy& study, const TaskSelection& selection,
                                               std::size_t& real) {
  std::vector<const TaskProtocol*> out;
  for (const TaskProtocol& protocol : study.protocols)
    if (is_asked_for(protocol, selection)) out.push_back(&protocol);
  // Protocols are sorted by their number of answered sessions, the largest first, so that a faulty version
  // that was used in few sessions comes after its corrected version.
  std::stable_sort(out.begin(), out.end(), [](const TaskProtocol* a, const TaskProtocol* b) {
    return answered_sessions(*a) > answered_sessions(*b);
  });
  const auto end = std::stable_partition(
      out.begin(), out.end(), [](const TaskProtocol* protocol) { return has_real_answers(*protocol); });
  real = static_cast<std::size_t>(end - out.begin());
  return out;
}

}  // namespace

std::string hashed_name(const TaskProtocol& protocol) {
  return name_of(protocol) + " " + protocol.sha256.substr(0, 12);
}

bool is_meant(const TaskProtocol& protocol, const std::string& by) {
  return protocol.sha256.starts_with(by) || by == protocol.name || by == name_of(protocol) ||
         by == hashed_name(protocol);
}

const char* task_name(TaskKind task) {
  switch (task) {
    case TaskKind::Pilot:
      return "pilot";
    case TaskKind::Task1:
      return "task1";
    case TaskKind::Task2:
      return "task2";
    case TaskKind::Own:
      break;
  }
  return "own";
}

const char* task_title(TaskKind task) {
  switch (task) {
    case TaskKind::Pilot:
      return "Pilot";
    case TaskKind::Task1:
      return "Task 1";
    case TaskKind::Task2:
      return "Task 2";
    case TaskKind::Own:
      break;
  }
  return "Own design";
}

namespace {

/// True for a protocol of format 3, which `vip-stats study` analyses. False if the protocol places frame-rate
/// settings adaptively for the PTPE: such a protocol is a pilot.
bool has_own_factors(const TaskProtocol& protocol) {
  if (!protocol.whole || protocol.whole->design.factors.empty()) return false;
  const auto& procedure = protocol.whole->design.procedure;
  return !procedure || procedure->kind != ProcedureKind::Ptpe;
}

}  // namespace

TaskKind kind_of(const TaskProtocol& protocol) {
  if (has_own_factors(protocol)) return TaskKind::Own;
  if (protocol.pairs) {
    const bool of_methods = protocol.methods.size() > 1 && asks(protocol, is_choice_of_two);
    return of_methods ? TaskKind::Task2 : TaskKind::Own;
  }
  if (protocol.pilot()) return asks(protocol, is_scale) ? TaskKind::Pilot : TaskKind::Own;
  const auto rates_realism = [](const Question& question) {
    return is_scale(question) && question.id == realism;
  };
  return asks(protocol, rates_realism) ? TaskKind::Task1 : TaskKind::Own;
}

double level_of(const TaskSelection& selection, const Question& question) {
  if (selection.level) return *selection.level;
  const auto planned = selection.plan.levels.find(question.id);
  return planned != selection.plan.levels.end() ? planned->second : fitted_level(question);
}

bool has_answers(const TaskSession& session) {
  return std::any_of(session.trials.begin(), session.trials.end(), [](const TaskTrial& trial) {
    return std::any_of(trial.answers.begin(), trial.answers.end(),
                       [](const TaskAnswer& answer) { return answer.score.has_value(); });
  });
}

bool is_simulated(const TaskSession& session) {
  return !session.observer.empty() && (has_answers(session) || !session.first_answer_utc.empty());
}

bool has_real_answers(const TaskProtocol& protocol) {
  return std::any_of(protocol.sessions.begin(), protocol.sessions.end(),
                     [](const TaskSession& session) { return !session.test_data && has_answers(session); });
}

bool is_main_question(const TaskProtocol& protocol, const Question& question) {
  switch (kind_of(protocol)) {
    case TaskKind::Pilot:
      return is_scale(question);
    case TaskKind::Task1:
      return is_scale(question) && question.id == realism;
    case TaskKind::Task2:
      return is_choice_of_two(question);
    case TaskKind::Own:
      break;
  }
  return question.id == protocol.questions.front().id;
}

stats::Result<std::vector<ChosenTask>> choose_tasks(const TaskStudy& study, const TaskSelection& selection) {
  std::size_t real = 0;
  auto protocols = protocols_for(study, selection, real);
  if (protocols.empty()) {
    return stats::Refusal{
        std::string("the database holds no protocol ") + what_it_shows(selection.task) +
        (selection.protocol.empty() ? "" : " and is '" + selection.protocol + "' by name or SHA-256")};
  }
  std::vector<SetAside> set_aside;
  if (real > 0) {
    for (std::size_t i = real; i < protocols.size(); ++i)
      set_aside.push_back({name_of(*protocols[i]) + ", SHA-256 " + protocols[i]->sha256.substr(0, 12),
                           static_cast<int>(protocols[i]->sessions.size())});
    protocols.resize(real);
  }
  std::vector<ChosenTask> out;
  for (const TaskProtocol* protocol : protocols) {
    bool first = true;
    for (const Question& question : main_questions(*protocol, selection)) {
      out.push_back({*protocol, out.empty() ? set_aside : std::vector<SetAside>(), question, first});
      first = false;
    }
  }
  if (out.empty())
    return stats::Refusal{"the trials ask no question '" + selection.question +
                          "' that is analysed by itself"};
  return out;
}

stats::Result<ChosenTask> choose_task(const TaskStudy& study, const TaskSelection& selection) {
  const auto all = choose_tasks(study, selection);
  if (!all) return stats::Refusal{all.reason()};
  if (all->size() == 1) return all->front();
  return stats::Refusal{protocols_of(*all).size() > 1 ? "several protocols are never pooled"
                                                      : "several questions are never pooled"};
}

std::string mend_of_choice(const TaskStudy& study, const TaskSelection& selection) {
  if (study.protocols.empty()) return "run a session first";
  const auto all = choose_tasks(study, selection);
  if (all && all->size() == 1) return "";
  if (all && protocols_of(*all).size() > 1) return choose_protocol + base::joined(protocols_of(*all));
  TaskSelection any = selection;
  any.question.clear();
  const auto asked = all ? all : choose_tasks(study, any);
  if (asked) return choose_question + base::joined(questions_of(*asked));
  any.protocol.clear();
  const auto others = choose_tasks(study, any);
  if (others) return choose_protocol + base::joined(protocols_of(*others));
  std::vector<std::string> held;
  for (const TaskProtocol& protocol : study.protocols) held.push_back(name_of(protocol));
  return "give another database: this one holds " + base::joined(held) +
         ", which vip-stats report describes, and vip-stats study if its design has factors";
}

stats::Refusal nothing_chosen(const TaskStudy& study, const std::string& protocol, std::string& mend) {
  std::vector<std::string> names, questions;
  for (const TaskProtocol& one : study.protocols) {
    names.push_back(hashed_name(one));
    if (!is_meant(one, protocol)) continue;
    for (const Question& question : one.questions)
      if (is_main_question(one, question) || kind_of(one) == TaskKind::Own) list_once(questions, question.id);
  }
  if (names.empty()) {
    mend = "run a session first";
    return {"holds no protocol"};
  }
  if (questions.empty()) {
    mend = choose_protocol + base::joined(names);
    return {"holds no protocol '" + protocol + "', by name or SHA-256"};
  }
  mend = choose_question + base::joined(questions);
  return {"asks no such question that is analysed by itself"};
}

bool within_scale(double level, const Question& question) {
  return level > question.scale_min && level < question.scale_max;
}

std::string outside_scale(double level, const Question& question) {
  return "the level " + base::shortest(level) + " does not lie between the ends of the scale of '" +
         question.id + "', " + std::to_string(question.scale_min) + " and " +
         std::to_string(question.scale_max);
}

std::string mend_of_level(const Question& question) {
  return "choose a --level above " + std::to_string(question.scale_min) + " and below " +
         std::to_string(question.scale_max) + ", or leave it out";
}

}  // namespace study
