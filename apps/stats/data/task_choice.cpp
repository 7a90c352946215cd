#include "apps/stats/data/task_choice.hpp"

#include <algorithm>

#include "stats/base/text.hpp"

namespace apps {

namespace {

using study::Question;
using study::TaskProtocol;
using study::TaskSession;
using study::TaskTrial;

const char* what_it_shows(TaskKind task) {
  if (task == TaskKind::Pilot) return "that shows frame rates";
  return task == TaskKind::Task2 ? "that shows pairs of methods" : "that shows methods one by one";
}

}  // namespace

const char* task_name(TaskKind task) {
  if (task == TaskKind::Pilot) return "pilot";
  return task == TaskKind::Task1 ? "task1" : "task2";
}

const char* task_title(TaskKind task) {
  if (task == TaskKind::Pilot) return "Pilot";
  return task == TaskKind::Task1 ? "Task 1" : "Task 2";
}

TaskKind kind_of(const TaskProtocol& protocol) {
  if (protocol.pilot()) return TaskKind::Pilot;
  return protocol.pairs ? TaskKind::Task2 : TaskKind::Task1;
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

stats::Result<ChosenProtocol> choose_protocol(const study::TaskStudy& study, const TaskSelection& selection) {
  std::vector<const TaskProtocol*> fit, test;
  for (const TaskProtocol& protocol : study.protocols) {
    if (kind_of(protocol) == selection.task && protocol.sha256.starts_with(selection.protocol))
      fit.push_back(&protocol);
  }
  if (fit.empty()) {
    return stats::Refusal{
        std::string("the database holds no protocol ") + what_it_shows(selection.task) +
        (selection.protocol.empty() ? "" : " and whose SHA-256 begins with " + selection.protocol)};
  }
  const auto real = std::stable_partition(
      fit.begin(), fit.end(), [](const TaskProtocol* protocol) { return has_real_answers(*protocol); });
  if (real - fit.begin() == 1) {
    test.assign(real, fit.end());
    fit.resize(1);
  }
  std::vector<std::string> names;
  for (const auto* one : fit)
    names.push_back(one->name + " " + one->version + " " + one->sha256.substr(0, 12));
  if (fit.size() > 1)
    return stats::Refusal{"several protocols are never pooled; choose one with --protocol: " +
                          base::joined(names)};
  ChosenProtocol out{*fit.front(), {}};
  for (const auto* one : test) out.set_aside.push_back(one->name + " " + one->version);
  return out;
}

stats::Result<Question> main_question(const TaskProtocol& protocol, const TaskSelection& selection) {
  const auto fits = [&](const Question& question) {
    if (protocol.pairs) return question.kind == study::AnswerKind::Choice && question.anchors.size() == 2;
    if (question.kind != study::AnswerKind::Scale) return false;
    if (!protocol.pilot()) return question.id == "realism";
    return selection.question.empty() || question.id == selection.question;
  };
  std::vector<Question> found;
  std::copy_if(protocol.questions.begin(), protocol.questions.end(), std::back_inserter(found), fits);
  if (found.size() == 1 || (!found.empty() && !protocol.pilot())) return found.front();
  if (found.empty()) {
    const std::string lacking = protocol.pairs      ? "choice between two"
                                : !protocol.pilot() ? "question 'realism' on a scale"
                                                    : "question '" + selection.question + "' on a scale";
    return stats::Refusal{"protocol " + protocol.name + " asks no " + lacking};
  }
  std::vector<std::string> ids;
  for (const auto& question : found) ids.push_back(question.id);
  return stats::Refusal{"several questions are never pooled; choose one with --question: " +
                        base::joined(ids)};
}

}  // namespace apps
