#include "apps/stats/tasks/task_data.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

namespace apps {

namespace {

using study::TaskProtocol;
using study::TaskSession;
using study::TaskTrial;

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

/// The one protocol asked for. Test data step back behind real ones.
stats::Result<TaskProtocol> choose_protocol(const study::TaskStudy& study, const TaskSelection& selection) {
  std::vector<const TaskProtocol*> fit;
  for (const TaskProtocol& protocol : study.protocols) {
    if (protocol.pairs == (selection.task == TaskKind::Task2) &&
        protocol.sha256.starts_with(selection.protocol))
      fit.push_back(&protocol);
  }
  const std::string wanted =
      selection.task == TaskKind::Task2 ? "that shows pairs of methods" : "that shows methods one by one";
  if (fit.empty()) {
    return stats::Refusal{
        "the database holds no protocol " + wanted +
        (selection.protocol.empty() ? "" : " and whose SHA-256 begins with " + selection.protocol)};
  }
  if (fit.size() > 1) {
    std::vector<const TaskProtocol*> real;
    std::copy_if(fit.begin(), fit.end(), std::back_inserter(real),
                 [](const TaskProtocol* protocol) { return has_real_answers(*protocol); });
    if (real.size() == 1) fit = real;
  }
  if (fit.size() == 1) return *fit.front();
  std::string list;
  for (const TaskProtocol* one : fit)
    list += (list.empty() ? "" : ", ") + one->name + " " + one->version + " " + one->sha256.substr(0, 12);
  return stats::Refusal{"several protocols are never pooled; choose one with --protocol: " + list};
}

/// Realism of Task 1, the choice of Task 2; nullptr when nothing of the kind is asked.
const study::Question* main_question(const TaskProtocol& protocol) {
  const auto fits = [&](const study::Question& question) {
    if (protocol.pairs) return question.kind == study::AnswerKind::Choice && question.anchors.size() == 2;
    return question.kind == study::AnswerKind::Scale && question.id == "realism";
  };
  const auto found = std::find_if(protocol.questions.begin(), protocol.questions.end(), fits);
  return found == protocol.questions.end() ? nullptr : &*found;
}

/// The answer to a question; for a choice 1 or 2, the interval. NaN: none.
double answer_to(const TaskTrial& trial, const study::Question& question) {
  for (const study::TaskAnswer& answer : trial.answers) {
    if (answer.question != question.id || !answer.score) continue;
    if (question.kind != study::AnswerKind::Choice) return *answer.score;
    return *answer.score == question.anchors.front().first ? 1 : 2;
  }
  return stats::TrialRecord::unanswered;
}

stats::TrialTiming timing_of(const study::TaskShowing& shown) {
  if (!shown.verdict) return stats::TrialTiming::Unjudged;
  if (*shown.verdict == study::Verdict::Pass) return stats::TrialTiming::Pass;
  return *shown.verdict == study::Verdict::Degraded ? stats::TrialTiming::Degraded : stats::TrialTiming::Fail;
}

stats::TrialRecord record_of(const TaskSession& session, const TaskTrial& trial,
                             const study::Question& question) {
  stats::TrialRecord out;
  out.participant = session.participant;
  out.visit = session.visit;
  out.position = trial.position;
  out.timing = timing_of(trial.first);
  out.timing_reason = trial.first.reason;
  if (trial.second && timing_of(*trial.second) > out.timing) {
    out.timing = timing_of(*trial.second);
    out.timing_reason = trial.second->reason;
  }
  out.interrupted = trial.excluded == study::interrupted_reason;
  if (trial.excluded && !out.interrupted)
    out.by_experimenter = trial.excluded->empty() ? "no reason given" : *trial.excluded;
  out.answer = answer_to(trial, question);
  out.answers =
      static_cast<int>(std::count_if(trial.answers.begin(), trial.answers.end(),
                                     [](const study::TaskAnswer& one) { return one.score.has_value(); }));
  // A repeat without an original compares with nothing.
  if (trial.kind == "repeat") out.repeats = trial.repeats.value_or(trial.position);
  return out;
}

/// Fills a TaskData from the sessions that may be pooled.
class Collector {
 public:
  Collector(TaskData& data, const study::Question& question, const stats::AnalysisPlan& plan)
      : data_(data), question_(question), plan_(plan) {}

  void collect() {
    leave_out_sessions();
    find_exclusions();
    for (const TaskSession& session : data_.protocol.sessions) add_session(session);
    count_excluded_people();
    data_.flow.analysed = static_cast<int>(data_.participants.size());
  }

 private:
  /// Test data beside real ones, observer models beside people.
  void leave_out_sessions() {
    auto& sessions = data_.protocol.sessions;
    data_.test_data =
        !has_real_answers(data_.protocol) &&
        std::any_of(sessions.begin(), sessions.end(), [](const auto& one) { return one.test_data; });
    data_.flow.test_left_out = static_cast<int>(
        std::erase_if(sessions, [&](const TaskSession& one) { return one.test_data && !data_.test_data; }));
    const bool people = std::any_of(sessions.begin(), sessions.end(), [](const TaskSession& one) {
      return one.observer.empty() && has_answers(one);
    });
    data_.flow.simulated_left_out = static_cast<int>(
        std::erase_if(sessions, [&](const TaskSession& one) { return people && !one.observer.empty(); }));
    for (const TaskSession& session : sessions) ++data_.flow.by_state[session.state];
    data_.flow.started = static_cast<int>(sessions.size());
  }

  void find_exclusions() {
    std::vector<stats::TrialRecord> trials;
    std::vector<stats::CatchRecord> catches;
    for (const TaskSession& session : data_.protocol.sessions) {
      if (!has_answers(session)) continue;
      for (const TaskTrial& trial : session.trials) {
        if (trial.kind != "practice") trials.push_back(record_of(session, trial, question_));
      }
      for (const study::CatchAnswer& page : session.catches) {
        if (page.score) catches.push_back({session.participant, session.visit, *page.score == page.expected});
      }
    }
    data_.exclusions =
        stats::find_exclusions(trials, catches, plan_.exclusions, data_.task == TaskKind::Task2);
  }

  void add_session(const TaskSession& session) {
    bool counted = false;
    for (const TaskTrial& trial : session.trials) counted = add_trial(session, trial) || counted;
    if (!counted) return;
    ++data_.gaze[session.gaze_source];
    ++data_.stations[session.station];
    ++data_.displays[session.display];
    if (session.observer.empty()) return;
    add_once(data_.simulated, session.participant);
    add_once(data_.observers, session.observer);
  }

  /// True when an answer about it counts.
  bool add_trial(const TaskSession& session, const TaskTrial& trial) {
    if (trial.kind == "practice") {
      ++data_.flow.practice;
      return false;
    }
    const bool excluded =
        stats::is_excluded(data_.exclusions, session.participant, session.visit, trial.position);
    if (trial.kind == "repeat") {
      ++data_.flow.repeat;
      if (!excluded) add_repeat(session, trial);
      return false;
    }
    const auto record = record_of(session, trial, question_);
    ++data_.flow.trials_planned;
    if (record.answers == 0) return false;
    ++data_.flow.trials_answered;
    if (excluded) {
      ++data_.flow.trials_excluded;
      return false;
    }
    ++data_.flow.trials_analysed;
    add_showings(trial);
    return data_.task == TaskKind::Task1 ? add_report(session, trial)
                                         : add_choice(session, trial, record.answer);
  }

  void add_repeat(const TaskSession& session, const TaskTrial& repeat) {
    if (!repeat.repeats ||
        stats::is_excluded(data_.exclusions, session.participant, session.visit, *repeat.repeats))
      return;
    for (const TaskTrial& original : session.trials) {
      if (original.position != *repeat.repeats) continue;
      for (const study::Question& question : data_.protocol.questions) {
        const double before = answer_to(original, question), after = answer_to(repeat, question);
        if (before == before && after == after) data_.repeats[question.id].push_back({before, after});
      }
    }
  }

  void add_showings(const TaskTrial& trial) {
    data_.showings.push_back({trials_, trial.first});
    if (trial.second) data_.showings.push_back({trials_, *trial.second});
    ++trials_;
  }

  bool add_report(const TaskSession& session, const TaskTrial& trial) {
    Report report{person(session), session.visit, trial.position, 0, 0, 0, {}};
    report.scene = index_of(data_.protocol.scenes, trial.first.what.scene);
    report.n_star = index_of(data_.protocol.n_stars, trial.first.what.n_star);
    report.method = index_of(data_.protocol.methods, trial.first.what.method);
    for (const study::TaskAnswer& answer : trial.answers) {
      if (answer.score) report.answers[answer.question] = *answer.score;
    }
    data_.reports.push_back(std::move(report));
    return true;
  }

  bool add_choice(const TaskSession& session, const TaskTrial& trial, double interval) {
    if (interval != interval) return false;
    stats::PairChoice choice;
    choice.participant = person(session);
    choice.scene = index_of(data_.protocol.scenes, trial.first.what.scene);
    choice.first = index_of(data_.protocol.methods, trial.first.what.method);
    choice.second = index_of(data_.protocol.methods, trial.second->what.method);
    choice.first_chosen = interval == 1;
    choice.position = trial.position;
    data_.choices.push_back(choice);
    return true;
  }

  int person(const TaskSession& session) {
    add_once(data_.participants, session.participant);
    return index_of(data_.participants, session.participant);
  }

  static void add_once(std::vector<std::string>& list, const std::string& item) {
    if (index_of(list, item) < 0) list.push_back(item);
  }

  static int index_of(const std::vector<std::string>& list, const std::string& item) {
    const auto found = std::find(list.begin(), list.end(), item);
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  }

  void count_excluded_people() {
    std::set<std::string> people;
    for (const stats::Exclusion& one : data_.exclusions) {
      if (one.position >= 0) continue;
      ++data_.flow.excluded_visits;
      if (index_of(data_.participants, one.participant) < 0) people.insert(one.participant);
    }
    data_.flow.excluded_participants = static_cast<int>(people.size());
  }

  TaskData& data_;
  const study::Question& question_;
  const stats::AnalysisPlan& plan_;
  int trials_ = 0;
};

}  // namespace

const char* task_name(TaskKind task) { return task == TaskKind::Task1 ? "task1" : "task2"; }

std::string TaskData::gaze_problem() const {
  int sessions = 0;
  std::string sources;
  for (const auto& [source, n] : gaze) {
    sessions += n;
    if (source != "tracked") sources += (sources.empty() ? "" : ", ") + source + " in " + std::to_string(n);
  }
  if (sources.empty()) return {};
  return "gaze was not tracked in every session (" + sources + " of " + std::to_string(sessions) +
         "), and what the methods refine depends on it";
}

stats::Result<TaskData> select_task(const study::TaskStudy& study, const TaskSelection& selection) {
  const auto protocol = choose_protocol(study, selection);
  if (!protocol) return stats::Refusal{protocol.reason()};
  const study::Question* question = main_question(*protocol);
  if (!question) {
    return stats::Refusal{"protocol " + protocol->name + " asks no " +
                          (protocol->pairs ? "choice between two" : "question 'realism' on a scale")};
  }
  TaskData data;
  data.task = selection.task;
  data.protocol = *protocol;
  data.question = question->id;
  for (const std::string& scene : data.protocol.scenes) data.scenes.push_back(scene_name(scene));
  data.flow.withdrawn = study.withdrawn;
  Collector(data, *question, selection.plan).collect();
  if (data.participants.empty()) {
    return stats::Refusal{"no answer counts: " + std::to_string(data.flow.started) +
                          " sessions of protocol " + data.protocol.name + ", " +
                          std::to_string(data.flow.trials_answered) + " trials answered, " +
                          std::to_string(data.flow.trials_excluded) + " excluded"};
  }
  return data;
}

std::string scene_name(const std::string& scene) { return std::filesystem::path(scene).stem().string(); }

}  // namespace apps
