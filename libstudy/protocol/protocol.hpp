#pragma once
/// A study as described by its file: plain structs, checked and hashed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/design.hpp"
#include "libstudy/protocol/question.hpp"

namespace study {

/// How a picture that is held for several display periods follows the head. Do not pool data of different
/// modes.
enum class Hold {
  Image,      ///< it stays at the pose where it was drawn: the runtime reprojects the old picture
  State,      ///< the fluid is frozen and redrawn from the new head pose
  HeadLocked  ///< it moves with the head
};

/// "image", "state" or "head_locked".
const char* hold_name(Hold hold);

/// How a headset shows the stimuli of a study. A desktop ignores it.
struct HeadsetRules {
  Hold hold = Hold::Image;
  /// Held pictures extend this far beyond the eyes' field of view, degrees on each side.
  double hold_margin_deg = 0;
  double world_scale = 1;            ///< metres in the room per metre of the scene
  std::optional<double> refresh_hz;  ///< that the headset must have; none: any
};

/// In the file and in the database: block_kind_name(), e.g. "instructions".
enum class BlockKind {
  Instructions,  ///< a text to be read
  Screening,     ///< questions that may exclude a person
  Consent,       ///< a text with boxes to tick; asked before anything is stored
  Demographics,  ///< questions, usually personal
  Practice,      ///< trials that are flagged, never dropped
  Stimulus,      ///< the trials of the design
  Question,      ///< questions outside the trials
  Rest,          ///< a pause with a countdown that cannot be cut short
  Break,         ///< a longer pause, ended by the participant after `seconds` or later
  Black,         ///< a black screen
  Repeat,        ///< trials shown again: test-retest
  Catch,         ///< pages among the trials that test attention
  Ssq,           ///< Simulator Sickness Questionnaire (Kennedy et al. 1993)
  /// Targets that measure the eye tracker's accuracy. Skipped without a tracker or permission to record.
  GazeValidation,
  Fms,     ///< Fast Motion Sickness scale, 0 to 20 (Keshavarz and Hecht 2011), with a stop rule
  Debrief  ///< the last text
};

/// "instructions", "screening", ...
std::string block_kind_name(BlockKind kind);
/// True if its units are trials: Practice, Stimulus and Repeat.
bool has_trials(BlockKind kind);

/// One step of a trial. In the file: "black 3", "stimulus", "stimulus first", "stimulus second", "ask realism
/// dizziness", "rest 30".
enum class StepKind { Black, Stimulus, Ask, Rest };

struct TrialStep {
  StepKind kind = StepKind::Stimulus;
  double seconds = 0;             ///< Black, Rest
  int interval = 0;               ///< Stimulus: 0, or 0 and 1 of a pair
  std::vector<std::string> asks;  ///< Ask: ids of questions of any block

  bool operator==(const TrialStep&) const = default;
};

/// Policy for the trial that was interrupted, applied when the session is resumed. In the file: "resume",
/// "restart_block", "invalidate". All earlier showings and answers stay in the database.
enum class Interruption {
  Resume,        ///< the trial is shown again
  RestartBlock,  ///< all trials of its block are shown again, from the first
  Invalidate     ///< the trial is left out, excluded as interrupted; the next one follows
};

struct Block {
  BlockKind kind = BlockKind::Instructions;
  std::string id;                   ///< unique in the protocol
  std::string title;                ///< of a page; may be empty
  std::string text;                 ///< of a page: plain, paragraphs separated by empty lines
  double seconds = 0;               ///< Rest, Break, Black: length. Instructions, Debrief: least time
  std::vector<Question> questions;  ///< of a page; Stimulus: asked in its steps
  /// Practice, Repeat: trials. Catch: pages, at random places of `like`. GazeValidation: tries.
  int count = 0;
  double extent_deg = 10;  ///< GazeValidation: offset of the outer targets, across and up
  /// GazeValidation: bound on the mean over the targets; beyond it a try fails. None: any accuracy passes.
  std::optional<double> max_accuracy_deg;
  std::string like;              ///< Practice, Repeat, Catch: id of a Stimulus block
  std::vector<TrialStep> steps;  ///< Practice, Stimulus, Repeat: steps of each trial
  double between_groups_s = 0;   ///< Stimulus: a break before each group of the design but the first
  Interruption on_interruption = Interruption::Resume;  ///< Practice and Repeat copy that of Stimulus
};

struct Protocol {
  static constexpr int newest_format = 3;

  int format = 2;  ///< 2, or 3: factors, timing profiles
  std::string name;
  std::string version;
  std::string language;
  int participants = 16;  ///< planned
  Design design;
  std::vector<Block> blocks;  ///< in the order of the session
  PacingRules pacing;
  ContentRules content;
  TimingTolerance timing;
  HeadsetRules headset;
  bool accept_approximate = false;
  /// Allows comparing stimuli whose pictures differ in renderer, size or angle, as baked and live ones can.
  bool accept_mixed_pictures = false;
  /// Participants are instructed to look at the middle of the picture, so the gaze point is known in advance.
  bool fixation = false;
  /// H1 and H5 need gaze: without tracked gaze they are labelled not testable.
  bool needs_gaze = false;
  /// The camera uses the visual angle of the picture instead of each scene's own angle.
  bool true_angle = false;
  /// True if the command line changed it (--trial-seconds ...): data are marked as test and the hash differs.
  bool test_data = false;
  /// Argument of override_trial_seconds(); none = trial lengths of the file. `text` and this rebuild the
  /// protocol.
  std::optional<double> trial_seconds;

  std::string place;   ///< name of the file in messages; empty: rebuilt from tables
  std::string text;    ///< the file as read, stored in every database
  std::string sha256;  ///< of `text`, or of text + overrides when there are any
};

/// Every question of the protocol with its block's index, in the order of the file.
std::vector<std::pair<int, const Question*>> all_questions(const Protocol& protocol);

/// Stored: accepts protocols of earlier versions, which allowed any method name and question id and any form
/// of gaze_question and sharing_question.
enum class ProtocolUse { New, Stored };

/// Reads a protocol; base::Error at file:line:column for an unknown key, a wrong type, a value out of range
/// or two keys that contradict each other. `name` names the file in messages.
Protocol parse_protocol(std::string_view text, const std::string& name, ProtocolUse use = ProtocolUse::New);
Protocol read_protocol(const std::filesystem::path& path);
/// Sets the length of every trial, 0.1 to 3600 s; changes the hash and marks the data as test. Equal texts
/// and seconds give equal hashes.
void override_trial_seconds(Protocol& protocol, double seconds);

}  // namespace study
