#pragma once
/// From the sessions of a database to the answers that are analysed, with a count of all that is left out.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "libstudy/store/task_answers.hpp"
#include "stats/analysis/exclusions.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/result.hpp"

namespace apps {

enum class TaskKind { Task1, Task2 };
/// "task1", "task2".
const char* task_name(TaskKind task);

/// What became of the sessions of one protocol, and of their trials.
struct TaskFlow {
  std::map<std::string, int>
      by_state;  ///< sessions: "open", "done", "refused", "not eligible", "stopped", "dropped out"
  int started = 0;
  int withdrawn = 0;           ///< participants, from whatever protocol of the database
  int test_left_out = 0;       ///< sessions of test data beside real ones
  int simulated_left_out = 0;  ///< sessions of observer models beside those of people
  int excluded_visits = 0;
  int excluded_participants = 0;  ///< without a visit left
  int analysed = 0;               ///< participants with an answer that counts
  int trials_planned = 0, trials_answered = 0, trials_excluded = 0, trials_analysed = 0;
  int practice = 0, repeat = 0;
};

/// A showing of an analysed trial.
struct TimedShowing {
  int trial = 0;  ///< one of a pair has the same as the other
  study::TaskShowing shown;
};

/// Task 1: one answered page.
struct Report {
  int participant = 0, visit = 1, position = 0;
  int scene = 0, n_star = 0, method = 0;
  std::map<std::string, double> answers;  ///< by question; those left out are absent
};

/// The answers of one task that count. Indices are of the lists here.
struct TaskData {
  TaskKind task = TaskKind::Task1;
  study::TaskProtocol protocol;                         ///< its sessions are those analysed
  bool test_data = false;                               ///< there are no real data: test data are analysed
  std::vector<std::string> participants;                ///< codes
  std::vector<std::string> scenes;                      ///< short: "single_dam"
  std::vector<std::string> simulated;                   ///< participants answered by observer models
  std::vector<std::string> observers;                   ///< different models
  std::map<std::string, int> gaze, stations, displays;  ///< sessions
  TaskFlow flow;
  std::vector<stats::Exclusion> exclusions;
  std::vector<TimedShowing> showings;
  std::vector<Report> reports;             ///< Task 1
  std::vector<stats::PairChoice> choices;  ///< Task 2
  std::string question;                    ///< id of the main one: realism, preference
  /// Repeated showings: answers of the original and of the repeat, by question (Task 2: 1 / 2).
  std::map<std::string, std::vector<std::array<double, 2>>> repeats;

  /// Empty, or why hypotheses about adaptive methods against FovFluid cannot be tested.
  std::string gaze_problem() const;
};

struct TaskSelection {
  TaskKind task = TaskKind::Task1;
  std::string protocol;  ///< leading digits of the SHA-256; empty when one protocol fits
  stats::AnalysisPlan plan;
};

/// Refused with the reason: no protocol of this task, several and none chosen, no answer that counts.
stats::Result<TaskData> select_task(const study::TaskStudy& study, const TaskSelection& selection);

/// "data/scenes/single_dam.toml" -> "single_dam".
std::string scene_name(const std::string& scene);

}  // namespace apps
