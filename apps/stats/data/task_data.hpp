#pragma once
/// From the sessions of a database to the answers that are analysed, with a count of all that is left out.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "apps/stats/data/task_choice.hpp"
#include "stats/analysis/exclusions.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/ptpe/pilot.hpp"

namespace apps {

/// What became of the sessions of one protocol, and of their trials.
struct TaskFlow {
  std::map<std::string, int> by_state;  ///< sessions, by TaskSession::state
  int started = 0;                      ///< all but those that are planned alone
  int participants = 0;                 ///< of the sessions started
  int no_answer = 0;                    ///< participants without an answer to analyse, practice and repeats aside
  int withdrawn = 0;                    ///< participants, from whatever protocol of the database
  int test_left_out = 0;                ///< sessions of test data beside real ones
  int simulated_left_out = 0;           ///< sessions of observer models beside those of people
  int protocols_left_out = 0;           ///< sessions of protocols with nothing but test data beside real ones
  int excluded_visits = 0;
  int excluded_participants = 0;  ///< who answered a trial, and of whom nothing is left
  int analysed = 0;               ///< participants with an answer that counts
  int trials_planned = 0, trials_answered = 0, trials_excluded = 0, trials_analysed = 0;
  int practice = 0, repeat = 0;
};

/// A showing that was played, practice aside.
struct TimedShowing {
  study::TaskShowing shown;
  bool analysed = false;  ///< its trial is: answered, not excluded, no repeat
};

/// A trial that is analysed, with all that was answered about it.
struct AnsweredTrial {
  std::string participant;  ///< code
  study::StimulusSpec first;
  std::optional<study::StimulusSpec> second;
  study::FpsSetting first_nominal, second_nominal;
  std::vector<study::TaskAnswer> answers;
};

/// The first answer of a session whose clock contradicts the order in which its database was written.
struct DoubtfulTime {
  std::string participant, station;
  std::string told_utc;        ///< by the clock
  std::string not_before_utc;  ///< by the order of the rows
  bool impossible = false;     ///< ViP-Lab is younger: the clock was wrong then, not before
};

/// Task 1: one page.
struct Report {
  int participant = 0, visit = 1, position = 0;
  int scene = 0, n_star = 0, method = 0;
  int period = 0;                         ///< stats::periods_of(), counted on over visits
  std::map<std::string, double> answers;  ///< by question; those left out are absent
};

/// The answers of one task, or of the pilot, that count. Indices are of the lists here.
struct TaskData {
  TaskKind task = TaskKind::Task1;
  study::TaskProtocol protocol;  ///< its sessions are those analysed
  std::vector<SetAside> set_aside;
  bool test_data = false;                 ///< there are no real data: test data are analysed
  std::vector<std::string> participants;  ///< codes
  std::vector<std::string> scenes;        ///< short: "single_dam"
  std::vector<std::string> simulated;     ///< participants answered by observer models, excluded ones too
  std::vector<std::string> observers;     ///< different models
  std::map<std::string, int> gaze, stations, displays, angles, settings, unblinded,
      mixed_pictures;            ///< sessions
  std::string first_answer_utc;  ///< of the sessions analysed, the doubtful left out; empty: none
  std::vector<DoubtfulTime> doubtful_times;
  TaskFlow flow;
  std::vector<stats::Exclusion> exclusions;
  std::vector<TimedShowing> showings;
  std::vector<AnsweredTrial> answered;
  std::vector<Report> reports;              ///< Task 1: answered pages
  std::vector<Report> unanswered;           ///< Task 1: planned for these participants, no answer counts
  std::vector<stats::PairChoice> choices;   ///< Task 2
  std::vector<stats::PilotRating> ratings;  ///< pilot
  study::Question question;                 ///< ChosenTask::question
  /// Of the answers that count, by question, s: from the page's showing to the last change.
  std::map<std::string, std::vector<double>> response_times;
  /// Repeated showings: answers of the original and of the repeat, by question (Task 2: 1 / 2).
  std::map<std::string, std::vector<std::array<double, 2>>> repeats;

  /// Empty, or why hypotheses about adaptive methods against FovFluid cannot be tested.
  std::string gaze_problem() const;
};

/// Of what was chosen. Whether any answer counts is not asked.
TaskData collect_task(const study::TaskStudy& study, const ChosenTask& chosen,
                      const stats::ExclusionRules& rules);
/// Of the only protocol and question that the selection asks for. Refused with the reason: there is none, or
/// there are several.
stats::Result<TaskData> collect_task(const study::TaskStudy& study, const TaskSelection& selection);

/// Why there is nothing to analyse; empty = there is.
std::string nothing_counts(const TaskData& data);

/// The same, refused without an answer that counts.
stats::Result<TaskData> select_task(const study::TaskStudy& study, const TaskSelection& selection);

/// "data/scenes/single_dam.toml" -> "single_dam".
std::string scene_name(const std::string& scene);

}  // namespace apps
