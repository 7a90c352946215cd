#pragma once
/// Collects the answers to analyse from the sessions of a database, and counts everything that is left out.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/task_choice.hpp"
#include "stats/analysis/exclusions.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/ptpe/pilot.hpp"

namespace study {

/// Counts of the sessions and trials of one protocol, from start to analysis.
struct TaskFlow {
  std::map<std::string, int> by_state;  ///< sessions, by TaskSession::state
  int started = 0;                      ///< all sessions except those only planned
  int participants = 0;                 ///< participants of the sessions started
  int no_answer = 0;      ///< participants without an answer to analyse, not counting practice and repeats
  int withdrawn = 0;      ///< participants who withdrew, from any protocol of the database
  int test_left_out = 0;  ///< sessions of test data, left out because real ones exist
  int simulated_left_out = 0;  ///< sessions of observer models, left out because sessions of people exist
  int protocols_left_out = 0;  ///< sessions of protocols with only test data, left out because others hold
                               ///< real data
  int excluded_visits = 0;
  int excluded_participants = 0;  ///< participants who answered a trial, all of whose answers are excluded
  int analysed = 0;               ///< participants with an analysed answer
  int trials_planned = 0, trials_answered = 0, trials_excluded = 0, trials_analysed = 0;
  int practice = 0, repeat = 0;
};

/// A showing that was played, except practice.
struct TimedShowing {
  TaskShowing shown;
  bool analysed = false;  ///< its trial is analysed: answered, not excluded, not a repeat
};

/// An analysed trial with all of its answers.
struct AnsweredTrial {
  std::string participant;  ///< code
  StimulusSpec first;
  std::optional<StimulusSpec> second;
  FpsSetting first_nominal, second_nominal;
  std::vector<TaskAnswer> answers;
};

/// The first answer of a session whose clock contradicts the order in which its database was written.
struct DoubtfulTime {
  std::string participant, station;
  std::string told_utc;        ///< time of the answer by the station's clock
  std::string not_before_utc;  ///< as in TaskSession
  bool impossible = false;  ///< the time is before ViP-Lab existed, so this clock was wrong, not the earlier
                            ///< one
};

/// Task 1: the answers of one page.
struct Report {
  int participant = 0, visit = 1, position = 0;
  int scene = 0, n_star = 0, method = 0;
  int period = 0;                         ///< as stats::periods_of(), numbered across visits
  std::map<std::string, double> answers;  ///< by question; unanswered questions are absent
};

/// The answers of one task, or of the pilot, that are analysed. Indices refer to the lists here.
struct TaskData {
  TaskKind task = TaskKind::Task1;
  TaskProtocol protocol;  ///< its sessions are the analysed ones
  std::vector<SetAside> set_aside;
  bool test_data = false;                 ///< test data are analysed, as there are no real data
  std::vector<std::string> participants;  ///< codes
  std::vector<std::string> scenes;        ///< short: "single_dam"
  std::vector<std::string> simulated;  ///< participants simulated by observer models, including excluded ones
  std::vector<std::string> observers;  ///< the distinct models
  std::map<std::string, int> gaze, stations, displays, angles, settings, unblinded,
      mixed_pictures;            ///< sessions
  std::string first_answer_utc;  ///< of the analysed sessions without doubtful times; empty: none
  std::vector<DoubtfulTime> doubtful_times;
  TaskFlow flow;
  std::vector<stats::Exclusion> exclusions;
  std::vector<TimedShowing> showings;
  std::vector<AnsweredTrial> answered;
  std::vector<Report> reports;     ///< Task 1: answered pages
  std::vector<Report> unanswered;  ///< Task 1: planned for these participants, but without an answer to
                                   ///< analyse
  std::vector<stats::PairChoice> choices;   ///< Task 2
  std::vector<stats::PilotRating> ratings;  ///< pilot
  Question question;                        ///< ChosenTask::question
  /// Response times in s of the analysed answers, by question: from the page's showing to the last change.
  std::map<std::string, std::vector<double>> response_times;
  /// Repeated showings: answers of the original and of the repeat, by question (Task 2: 1 / 2).
  std::map<std::string, std::vector<std::array<double, 2>>> repeats;

  /// Why hypotheses about adaptive methods against FovFluid cannot be tested; empty if they can.
  std::string gaze_problem() const;
};

/// Collects the chosen protocol and question. The result may hold no answer.
TaskData collect_task(const TaskStudy& study, const ChosenTask& chosen, const stats::ExclusionRules& rules);
/// Collects the only protocol and question that match the selection. Refused with the reason if none or
/// several match.
stats::Result<TaskData> collect_task(const TaskStudy& study, const TaskSelection& selection);

/// Why there is nothing to analyse; empty if there is something.
std::string nothing_counts(const TaskData& data);

/// As collect_task(), but refused without an answer to analyse.
stats::Result<TaskData> select_task(const TaskStudy& study, const TaskSelection& selection);

/// "data/scenes/single_dam.toml" -> "single_dam".
std::string scene_name(const std::string& scene);

}  // namespace study
