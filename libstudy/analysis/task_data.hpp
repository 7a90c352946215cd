#pragma once
/// Collects the answers for an analysis from the sessions of a database, and counts all sessions and trials
/// that are left out.

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

/// Counts of one protocol's sessions, participants and trials, from the planned sessions to the analysed
/// answers.
struct TaskFlow {
  std::map<std::string, int> by_state;  ///< number of sessions by TaskSession::state
  int started = 0;                      ///< number of sessions in any state but "planned"
  int participants = 0;                 ///< participants of the started sessions
  int no_answer = 0;  ///< participants without an answer for the analysis even before exclusions; practice
                      ///< and repeats do not count
  int withdrawn = 0;  ///< participants who withdrew, counted over all protocols of the database
  int test_left_out = 0;          ///< sessions of test data, left out because real data exist
  int simulated_left_out = 0;     ///< sessions of observer models, left out because a person answered
  int protocols_left_out = 0;     ///< sessions of the protocols in TaskData::set_aside
  int excluded_visits = 0;        ///< visits (sessions) that a rule excludes as a whole
  int excluded_participants = 0;  ///< participants who answered, but whose answers are all excluded
  int analysed = 0;               ///< participants with an analysed answer
  int trials_planned = 0, trials_answered = 0, trials_excluded = 0, trials_analysed = 0;
  int practice = 0, repeat = 0;  ///< trials for practice and repeated trials; not in the four counts above
};

/// A showing (one presentation of a stimulus) that was played in a trial other than practice.
struct TimedShowing {
  TaskShowing shown;
  bool analysed = false;  ///< true if the showing's trial is analysed: answered, not excluded and no repeat
  std::string station = {};  ///< TaskSession::station
};

/// An analysed trial with all of its answers.
struct AnsweredTrial {
  std::string participant;  ///< code of the participant
  int first_cell = 0;       ///< index into Design::cells
  std::optional<int> second_cell;
  StimulusSpec first;
  std::optional<StimulusSpec> second;
  FpsSetting first_nominal, second_nominal;
  std::vector<TaskAnswer> answers;
};

/// A session's first answer with a doubtful time: the time contradicts the order in which the rows of the
/// database were written.
struct DoubtfulTime {
  std::string participant, station;
  std::string told_utc;        ///< time of the answer in UTC, by the station's clock
  std::string not_before_utc;  ///< earliest possible time of the answer, by the rows written before it
  bool impossible = false;  ///< true if the answer's time is before ViP-Lab existed: the clock was then wrong
                            ///< at this answer and not at the earlier rows
};

/// Task 1: the answers about one trial.
struct Report {
  int participant = 0, visit = 1, position = 0;
  int scene = 0, n_star = 0, method = 0;
  /// Number, from 0 over all visits, of the trial's period: a run of successive trials with one scene and one
  /// n_*.
  int period = 0;
  std::map<std::string, double> answers;  ///< score by question id; unanswered questions are absent
};

/// The analysed answers of one protocol to one question. Indices of participants refer to `participants`;
/// indices of scenes, n_* and methods refer to the lists in `protocol`.
struct TaskData {
  TaskKind task = TaskKind::Task1;
  /// The protocol. Its sessions lack those that flow.test_left_out and flow.simulated_left_out count.
  TaskProtocol protocol;
  std::vector<SetAside> set_aside;        ///< protocols not analysed, for lack of real answers
  bool test_data = false;                 ///< true if test data are analysed, since there are no real data
  std::vector<std::string> participants;  ///< codes of the participants with an analysed answer
  std::vector<std::string> scenes;        ///< scenes of the protocol by scene_name(), such as "single_dam"
  std::vector<std::string> simulated;  ///< participants simulated by observer models, including excluded ones
  std::vector<std::string> observers;  ///< the distinct observer models
  std::map<std::string, int> gaze, stations, displays, angles, settings, unblinded,
      mixed_pictures;  ///< number of analysed sessions with each value, such as gaze "tracked"
  /// Number of analysed sessions with tracked gaze by the name of their eye tracker outside OpenXR.
  std::map<std::string, int> trackers;
  /// Imported sessions with analysed answers: by program, the SHA-256 of the source of each session.
  std::map<std::string, std::vector<std::string>> imported;
  /// Pilot: analysed ratings by their frame rate: of recorded frames; without frames the one that the source
  /// states, or else the one that was asked for.
  int recorded_rates = 0, stated_rates = 0, asked_rates = 0;
  /// What the frame rates of the ratings are: "realised", "stated" (by the source), "asked" (for), or
  /// several, separated by ", ".
  std::string rates_words() const;
  std::string first_answer_utc;  ///< earliest first answer of the sessions without doubtful times, in UTC;
                                 ///< empty: none
  std::vector<DoubtfulTime> doubtful_times;
  TaskFlow flow;
  std::vector<stats::Exclusion> exclusions;
  std::vector<TimedShowing> showings;
  std::vector<AnsweredTrial> answered;
  std::vector<Report> reports;     ///< Task 1: analysed trials
  std::vector<Report> unanswered;  ///< Task 1: trials planned for `participants` that have no analysed report
  std::vector<stats::PairChoice> choices;   ///< Task 2: analysed choices
  std::vector<stats::PilotRating> ratings;  ///< pilot: analysed ratings
  Question question;                        ///< the analysed question
  /// Response times of the analysed answers in s, by question id: from the display of the page to the last
  /// change of the answer. Reactions without a press are left out.
  std::map<std::string, std::vector<double>> response_times;
  /// Repeated trials: by question id, each pair of the answer to the original and the answer to the repeat.
  /// For a choice or yes-or-no question an answer is 1 for the first anchor (in a pair the first interval)
  /// and 2 for any other.
  std::map<std::string, std::vector<std::array<double, 2>>> repeats;

  /// The reason why hypotheses that need gaze cannot be tested: gaze was not tracked in some analysed
  /// session. Empty if gaze was tracked in every analysed session.
  std::string gaze_problem() const;
  /// "2 sessions from PsychoPy (SHA-256 of the sources 0123456789ab, ...)"; empty: nothing was imported.
  std::string imported_words() const;
};

/// Collects the answers to the chosen protocol and question. The result may hold no answer.
TaskData collect_task(const TaskStudy& study, const ChosenTask& chosen, const stats::ExclusionRules& rules);
/// Collects the answers to the protocol and question that match the selection. Refused with the reason if
/// none or several match.
stats::Result<TaskData> collect_task(const TaskStudy& study, const TaskSelection& selection);

/// The reason why no answer can be analysed; empty if some answer can.
std::string nothing_counts(const TaskData& data);

/// Returns collect_task(), but is refused as well if no answer can be analysed.
stats::Result<TaskData> select_task(const TaskStudy& study, const TaskSelection& selection);

/// Name of the scene's file without folder and extension: "data/scenes/single_dam.toml" -> "single_dam".
std::string scene_name(const std::string& scene);

}  // namespace study
