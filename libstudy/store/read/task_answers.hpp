#pragma once
/// The answers of the pilot (frame rates), Task 1 (single showings of methods) and Task 2 (pairs) for the
/// analyses. Read-only.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/design.hpp"
#include "libstudy/protocol/question.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "libstudy/store/read/run_settings.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// One stimulus of a trial and its showing.
struct TaskShowing {
  StimulusSpec what;
  FpsSetting nominal;              ///< moments 0: as fast as the method ran
  bool played = false;             ///< the fields below are known
  std::optional<Verdict> verdict;  ///< empty without a schedule
  TimingGrade grade = TimingGrade::CpuSubmit;
  std::string reason;  ///< why the verdict is not pass
  stats::FpsMoments realised;
  double longest_ms = 0;
  std::int64_t late = 0;  ///< frames
  /// Values of the solver, means over the frames; empty: not measured, or a method without tau.
  std::optional<double> active_fraction, tau_fps;
};

/// A question about a trial and its answer so far; choices count from the scale's lowest score.
struct TaskAnswer {
  std::string question;
  std::optional<int> score;
  std::optional<double> response_time_s =
      {};  ///< from the page's appearance to the last change; none: no answer
};

/// TaskTrial::excluded of a trial that was excluded after an interruption by the protocol's policy.
inline constexpr const char* interrupted_reason = "interrupted";

struct TaskTrial {
  int position = 0;   ///< 0-based order among the session's trials
  std::string kind;   ///< "stimulus", "practice" or "repeat"
  TaskShowing first;  ///< first or only one
  std::optional<TaskShowing> second;
  std::optional<std::string> excluded;  ///< the experimenter's reason, or interrupted_reason
  std::vector<TaskAnswer> answers;      ///< in the order of the page, without text answers
  /// Of a repeat: position of the trial with the same stimuli in the same order.
  std::optional<int> repeats;
};

/// A catch page with the expected and the given answer.
struct CatchAnswer {
  std::string question;
  int expected = 0;
  std::optional<int> score;
};

struct TaskSession {
  std::string participant;  ///< code
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  bool test_data = false;
  /// "planned" (open, nothing shown yet), "open" (begun), "done", "refused", "not eligible", "stopped" or
  /// "dropped out"
  std::string state;
  /// "tracked", "head", "mouse", "fixed", "fixation" or "none"; if showings differ, a source other than the
  /// planned one.
  std::string gaze_source;
  std::string station, display;
  std::vector<TaskTrial> trials;  ///< by position
  std::vector<CatchAnswer> catches;
  std::string first_answer_utc;  ///< of any page or trial, by the station's clock; empty: none yet
  /// "camera 75 degrees, eye 27.4 degrees, ratio 0.37", for each pair of angles that was shown; "not known":
  /// recorded by an earlier version; empty: nothing was drawn.
  std::string angles;
  /// "mirror opened", "setting revealed" or both, joined by " and "; empty: the experimenter stayed blind.
  std::string unblinded;
  /// "a.toml: 640x360 px at 75 degrees by R and 64x36 px at 75 degrees by S", for each scene whose pictures
  /// differed in renderer, size or angle; empty: none did, or not stored.
  std::string mixed_pictures;
  std::string stimulus;                 ///< description of the stimuli from the session's plan
  std::vector<RunSetting> settings;     ///< solver settings of its live fluid
  std::vector<FrameCosts> frame_costs;  ///< latest measurement of its station; empty: not measured
  /// Latest time stored in the database before the session began: its first answer came later, whatever its
  /// station's clock said. Empty: not known.
  std::string not_before_utc = {};
};

/// A protocol with all its sessions by participant and visit.
struct TaskProtocol {
  std::string name, version, sha256;
  bool pairs = false;    ///< a trial shows two methods (Task 2)
  int participants = 0;  ///< planned
  /// In file order. If effects are a factor, a method includes its level of effects: "Ours, foam"
  /// (treatment_name()).
  std::vector<std::string> scenes, methods, n_stars;
  std::vector<Question> questions;  ///< asked about trials, without text questions
  std::vector<TaskSession> sessions;
  double content_step_s = 1.0 / 60;
  std::vector<EffectSet> effects = {};  ///< levels of the factor; empty: effects are not a factor
  bool paint_temperature = false;       ///< Design::paint_temperature
  std::vector<StimulusSpec> treatments =
      {};  ///< method and effects of each of `methods`; empty without levels

  /// Questions on pages of kind demographics, screening and question outside the trials, without text
  /// questions.
  std::vector<Question> about_people = {};

  /// One method (with one level of effects) under several frame rates, shown one by one.
  bool pilot() const { return methods.size() < 2; }
};

struct TaskStudy {
  std::vector<TaskProtocol> protocols;
  int withdrawn = 0;         ///< participants who withdrew, of all protocols
  std::string lacking = {};  ///< rows that only the journal holds (open_study.hpp); empty: none
  /// Answers to TaskProtocol::about_people, after read_about_people().
  std::vector<PersonalEntry> about_people = {};
};

/// If a trial was shown several times, the schema's view trial_showing selects the showing that counts.
/// base::Error naming the file: missing, not a database of this program, damaged, or newer than this program.
TaskStudy read_tasks(const StudyFile& file);
/// Adds the answers about TaskProtocol::about_people: from the personal file, and from the database if not
/// marked as personal. base::Error as read_tasks().
void read_about_people(const StudyFile& file, TaskStudy& study);

}  // namespace study
