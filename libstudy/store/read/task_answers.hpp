#pragma once
/// Reads the answers of the pilot (frame rates), Task 1 (single showings of methods) and Task 2 (pairs of
/// methods) for the analyses. Does not change the database.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/read/frame_costs.hpp"
#include "libstudy/store/read/run_settings.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// One stimulus of a trial, with its timing. If the trial was shown several times, the timing is of the
/// earliest showing that an answer judges or, without answers, of the last showing played to its end;
/// showings that were set aside are left out.
struct TaskShowing {
  StimulusSpec what;
  FpsSetting nominal;              ///< mean and sd 0: as fast as the method ran
  bool played = false;             ///< true: the stimulus was shown to its end; false: it has no timing
  std::optional<Verdict> verdict;  ///< timing verdict; none: no schedule, and not cut for overrunning
  /// False: no frame was recorded, which happens to imported trials alone. There is no grade then, and
  /// `realised` holds what the source states, or zeros.
  bool framed = true;
  TimingGrade grade = TimingGrade::CpuSubmit;
  std::string reason;  ///< why the timing verdict is not pass
  stats::FpsMoments realised;
  double longest_ms = 0;  ///< longest frame interval
  std::int64_t late = 0;  ///< number of late frames
  /// Fraction of the particles that the solver computed, and the tolerance tau, frames/s; both means over the
  /// frames. None: not measured, or the method has no such value.
  std::optional<double> active_fraction, tau_fps;
  int cell = 0;  ///< index into Design::cells

  /// True if the mean and SD of the frame rate that was shown are known.
  bool has_rates() const { return framed || realised.mean > 0; }
};

/// A question about a trial, with its answer if there is one. The score is on the question's scale; of a
/// choice, it is the score of the chosen words (Question::anchors).
struct TaskAnswer {
  std::string question;
  std::optional<int> score;
  /// Time from the page's appearance to the answer's last change; none: no answer.
  std::optional<double> response_time_s = {};
};

/// The text in TaskTrial::excluded if the protocol's policy excluded the trial because of an interruption.
inline constexpr const char* interrupted_reason = "interrupted";

struct TaskTrial {
  int position = 0;   ///< 0-based order among the session's trials
  std::string kind;   ///< kind of its block: "stimulus", "practice" or "repeat"
  TaskShowing first;  ///< first or only stimulus
  std::optional<TaskShowing> second;
  std::optional<std::string> excluded;  ///< the experimenter's reason, or interrupted_reason
  std::vector<TaskAnswer> answers;  ///< in the order of the questions, without text and personal questions
  /// If kind is "repeat": position of the first earlier stimulus trial with the same stimuli in the same
  /// order; none if there is no such trial.
  std::optional<int> repeats;
};

/// A catch page with the expected and the given answer.
struct CatchAnswer {
  std::string question;
  int expected = 0;
  std::optional<int> score;
};

struct TaskSession {
  std::string participant;  ///< participant code
  int visit = 1;
  std::string observer;  ///< simulated observer that answered; empty = a person
  bool test_data = false;
  /// "planned" (nothing shown and no unit done), "open" (begun), "done", "refused", "not eligible", "stopped"
  /// or "dropped out".
  std::string state;
  /// Gaze that the fluid used: "tracked", "head", "mouse", "fixed" (assumed in the middle of the picture),
  /// "fixation" (the protocol makes people look at the middle) or "none". If a showing used another source
  /// than planned, that source.
  std::string gaze_source;
  std::string station, display;
  std::vector<TaskTrial> trials;  ///< by position
  std::vector<CatchAnswer> catches;
  /// Time of the session's first answer, by the station's clock; of an imported session the time that the
  /// source states, or that of the session's start; empty: none.
  std::string first_answer_utc;
  /// Vertical field of view of the camera, and vertical visual angle of the picture at the eye: "camera 75
  /// degrees, eye 27.4 degrees, ratio 0.37". Several pairs of angles are joined by "; ". "not known":
  /// recorded by an earlier version. Empty: nothing was drawn.
  std::string angles;
  /// Events by which the experimenter lost blindness: "mirror opened", "setting revealed" or both, joined by
  /// " and "; empty: the experimenter stayed blind.
  std::string unblinded;
  /// Scenes whose pictures differed in renderer, size or angle between cells: "a.toml: 640x360 px at 75
  /// degrees by R and 64x36 px at 75 degrees by S". Empty: there was no such scene, or no framing is stored.
  std::string mixed_pictures;
  std::string stimulus;                 ///< description of the stimuli from the session's plan
  std::vector<RunSetting> settings;     ///< solver settings of the live fluid
  std::vector<FrameCosts> frame_costs;  ///< latest frame costs measured for the session; empty: not measured
  /// The latest time stored in the database when the session was planned, or the start of the session's run
  /// if that is later. The session's first answer came later, whatever the station's clock says. Empty: not
  /// known.
  std::string not_before_utc = {};
  /// Eye tracker outside OpenXR, by the name that its sender gave; several are joined by " and ". Empty:
  /// none.
  std::string tracker = {};
  std::string uid = {};  ///< random identifier of the session, equal in all copies of the database
  /// Program that recorded the session elsewhere, and the SHA-256 of the file of its answers; empty: not
  /// imported.
  std::string imported_from = {}, source_sha256 = {};
};

/// A protocol with all its sessions, ordered by participant and visit.
struct TaskProtocol {
  std::string name, version, sha256;
  bool pairs = false;    ///< true: a trial shows two stimuli (Task 2)
  int participants = 0;  ///< planned number of participants
  /// Levels of each factor in the order of the protocol's cells. If effects are a factor, a method's name
  /// includes its level of effects: "Ours, foam" (treatment_name()).
  std::vector<std::string> scenes, methods, n_stars;
  std::vector<Question> questions;  ///< questions about trials, without text questions
  std::vector<TaskSession> sessions;
  double content_step_s = 1.0 / 60;
  std::vector<EffectSet> effects = {};  ///< levels of the factor effects; empty: effects are not a factor
  bool paint_temperature = false;       ///< true: pictures show temperatures over the water
  /// Method and effects of each of `methods`; empty if effects are not a factor.
  std::vector<StimulusSpec> treatments = {};

  /// Questions on pages of kind demographics, screening and question that no trial asks, without text
  /// questions.
  std::vector<Question> about_people = {};

  std::shared_ptr<const Protocol> whole = {};  ///< the protocol as stored; null: not read from a database

  /// True if the protocol is a pilot: it has a single method with a single level of effects.
  bool pilot() const { return methods.size() < 2; }
};

struct TaskStudy {
  std::vector<TaskProtocol> protocols;
  int withdrawn = 0;  ///< number of participants who withdrew, under all protocols
  /// how the database lags behind its journal of answers, in words (OpenedStudy::lacking); empty: it does not
  std::string lacking = {};
  /// Answers to TaskProtocol::about_people; empty until read_about_people() adds them.
  std::vector<PersonalEntry> about_people = {};
};

/// Reads all protocols, sessions, trials and answers. If a trial was shown several times, the schema's view
/// trial_showing selects the showing to read (see TaskShowing). base::Error, which names the file, if the
/// file is missing, damaged, not a database of vip-study, or written by a newer program, or if it lacks rows
/// of its journal of answers (open_study()).
TaskStudy read_tasks(const StudyFile& file);
/// Adds the answers to TaskProtocol::about_people. Personal answers come from the personal file, other
/// answers from the database. base::Error as read_tasks().
void read_about_people(const StudyFile& file, TaskStudy& study);

}  // namespace study
