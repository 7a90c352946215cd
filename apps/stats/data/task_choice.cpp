#include "apps/stats/data/task_choice.hpp"

#include <algorithm>

#include "stats/base/text.hpp"

namespace apps {

namespace {

using study::Question;
using study::TaskProtocol;
using study::TaskSession;
using study::TaskTrial;

constexpr const char* realism = "realism";

const char* what_it_shows(TaskKind task) {
  if (task == TaskKind::Pilot) return "that shows frame rates, rated on a scale";
  if (task == TaskKind::Own) return "of another design than the pilot, Task 1 and Task 2";
  return task == TaskKind::Task2 ? "that shows pairs of methods, one of which is chosen"
                                 : "that shows methods one by one, rated for 'realism' on a scale";
}

/// Sickness that trials ask for again and again is analysed by itself (sickness_json.hpp).
bool is_sickness(const Question& question) { return question.id == "fms" || question.id.starts_with("ssq_"); }

bool is_scale(const Question& question) {
  return question.kind == study::AnswerKind::Scale && !is_sickness(question);
}

/// Answered by one of two stimuli.
bool is_choice_of_two(const Question& question) {
  return question.kind == study::AnswerKind::Choice && question.anchors.size() == 2;
}

bool asks(const TaskProtocol& protocol, bool (*wanted)(const Question&)) {
  return std::any_of(protocol.questions.begin(), protocol.questions.end(), wanted);
}

bool is_asked_for(const TaskProtocol& protocol, const TaskSelection& selection) {
  return kind_of(protocol) == selection.task && protocol.sha256.starts_with(selection.protocol);
}

std::string name_of(const TaskProtocol& protocol) { return protocol.name + " " + protocol.version; }

std::ptrdiff_t answered_sessions(const TaskProtocol& protocol) {
  return std::count_if(protocol.sessions.begin(), protocol.sessions.end(), has_answers);
}

/// Of a design without any question on a scale or of a choice: none.
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

std::string ids_of(const std::vector<Question>& questions) {
  std::vector<std::string> ids;
  for (const auto& one : questions) ids.push_back(one.id);
  return base::joined(ids);
}

/// Protocols that are asked for; first those with real answers, whose number is `real`.
std::vector<const TaskProtocol*> protocols_for(const study::TaskStudy& study, const TaskSelection& selection,
                                               std::size_t& real) {
  std::vector<const TaskProtocol*> out;
  for (const TaskProtocol& protocol : study.protocols)
    if (is_asked_for(protocol, selection)) out.push_back(&protocol);
  // That of most people first: a version with a typo, which was mended, comes after the mended one.
  std::stable_sort(out.begin(), out.end(), [](const TaskProtocol* a, const TaskProtocol* b) {
    return answered_sessions(*a) > answered_sessions(*b);
  });
  const auto end = std::stable_partition(
      out.begin(), out.end(), [](const TaskProtocol* protocol) { return has_real_answers(*protocol); });
  real = static_cast<std::size_t>(end - out.begin());
  return out;
}

}  // namespace

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

TaskKind kind_of(const TaskProtocol& protocol) {
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
  return planned != selection.plan.levels.end() ? planned->second : study::fitted_level(question);
}

bool has_answers(const TaskSession& session) {
  return std::any_of(session.trials.begin(), session.trials.end(), [](const TaskTrial& trial) {
    return std::any_of(trial.answers.begin(), trial.answers.end(),
                       [](const study::TaskAnswer& answer) { return answer.score.has_value(); });
  });
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

stats::Result<std::vector<ChosenTask>> choose_tasks(const study::TaskStudy& study,
                                                    const TaskSelection& selection) {
  std::size_t real = 0;
  auto protocols = protocols_for(study, selection, real);
  if (protocols.empty()) {
    return stats::Refusal{
        std::string("the database holds no protocol ") + what_it_shows(selection.task) +
        (selection.protocol.empty() ? "" : " and whose SHA-256 begins with " + selection.protocol)};
  }
  std::vector<std::string> set_aside;
  if (real > 0) {
    for (std::size_t i = real; i < protocols.size(); ++i) set_aside.push_back(name_of(*protocols[i]));
    protocols.resize(real);
  }
  std::vector<ChosenTask> out;
  std::vector<std::string> asked;
  for (const TaskProtocol* protocol : protocols) {
    bool first = true;
    for (const Question& question : main_questions(*protocol, selection)) {
      out.push_back({*protocol, out.empty() ? set_aside : std::vector<std::string>(), question, first});
      first = false;
    }
    asked.push_back("protocol " + protocol->name + " asks no question '" + selection.question +
                    "' that can be analysed by itself, but " +
                    ids_of(main_questions(*protocol, {selection.task, {}, {}})));
  }
  if (out.empty()) return stats::Refusal{base::joined(asked)};
  return out;
}

stats::Result<ChosenTask> choose_task(const study::TaskStudy& study, const TaskSelection& selection) {
  const auto all = choose_tasks(study, selection);
  if (!all) return stats::Refusal{all.reason()};
  if (all->size() == 1) return all->front();
  std::vector<std::string> protocols;
  std::vector<Question> questions;
  for (const ChosenTask& one : *all) {
    if (one.first_of_protocol)
      protocols.push_back(name_of(one.protocol) + " " + one.protocol.sha256.substr(0, 12));
    questions.push_back(one.question);
  }
  if (protocols.size() > 1)
    return stats::Refusal{"several protocols are never pooled; choose one with --protocol: " +
                          base::joined(protocols)};
  return stats::Refusal{"several questions are never pooled; choose one with --question: " +
                        ids_of(questions)};
}

}  // namespace apps
