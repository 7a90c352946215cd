#pragma once
/// The content of a protocol file as plain structs. The readers check and hash the file.

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

/// How a picture that a headset shows for several display periods moves when the head moves. Do not pool data
/// of different modes.
enum class Hold {
  Image,      ///< the runtime reprojects the picture from the head pose at which it was drawn
  State,      ///< the fluid is frozen and redrawn from the current head pose
  HeadLocked  ///< the picture moves with the head
};

/// The word for `hold` in protocol files: "image", "state" or "head_locked".
const char* hold_name(Hold hold);

/// How a headset shows the stimuli of a study. A desktop display ignores these rules.
struct HeadsetRules {
  Hold hold = Hold::Image;
  /// Under Hold::Image, pictures extend this far beyond the eyes' field of view on each side, degrees.
  double hold_margin_deg = 0;
  double world_scale = 1;            ///< metres in the room per metre of the scene
  std::optional<double> refresh_hz;  ///< refresh rate that the headset must have, Hz; none: any
};

/// Kind of a block. Its word in protocol files and databases is block_kind_name(), such as "instructions".
enum class BlockKind {
  Instructions,  ///< a text to be read
  Screening,     ///< questions that may exclude a person
  Consent,       ///< a text and the questions that give consent
  Demographics,  ///< questions, usually personal
  Practice,      ///< trials for practice: stored, with a flag
  Stimulus,      ///< the trials of the design
  Question,      ///< questions outside the trials
  Rest,          ///< a pause with a countdown that cannot be cut short
  Break,         ///< a longer pause, ended by the participant after `seconds` or later
  Black,         ///< a black screen
  Repeat,        ///< trials of the design, shown again to measure test-retest reliability
  Catch,         ///< pages among the trials that test attention
  Ssq,           ///< Simulator Sickness Questionnaire (Kennedy et al. 1993)
  /// Targets that measure the eye tracker's accuracy. Skipped without a tracker or permission to record.
  GazeValidation,
  Fms,     ///< Fast Motion Sickness scale, 0 to 20 (Keshavarz and Hecht 2011), with a stop rule
  Debrief  ///< the text at the end of the session
};

/// The word for `kind` in protocol files: "instructions", "screening", ...
std::string block_kind_name(BlockKind kind);
/// True for the kinds of blocks that consist of trials: Practice, Stimulus and Repeat.
bool has_trials(BlockKind kind);

/// One step of a trial. In the file: "black 3", "stimulus", "stimulus first", "stimulus second", "ask realism
/// dizziness", "rest 30".
enum class StepKind { Black, Stimulus, Ask, Rest };

struct TrialStep {
  StepKind kind = StepKind::Stimulus;
  double seconds = 0;  ///< Black, Rest: duration
  int interval = 0;    ///< Stimulus: 0 for the first or only stimulus of the trial, 1 for the second
  std::vector<std::string> asks;  ///< Ask: ids of the asked questions, from any block

  bool operator==(const TrialStep&) const = default;
};

/// Policy for an interrupted trial when its session is resumed. In the file: "resume", "restart_block",
/// "invalidate". All earlier showings and answers stay in the database.
enum class Interruption {
  Resume,        ///< the trial is shown again
  RestartBlock,  ///< all trials of its block are shown again, from the first
  Invalidate     ///< the trial is excluded as interrupted; the session continues with the next trial
};

struct Block {
  BlockKind kind = BlockKind::Instructions;
  std::string id;     ///< unique in the protocol
  std::string title;  ///< heading of the page; may be empty
  std::string text;   ///< plain text of the page; empty lines separate paragraphs
  /// Rest, Black: length, s. Break, Instructions, Debrief: time after which the participant can continue, s.
  double seconds = 0;
  std::vector<Question> questions;  ///< asked on the block's page; Stimulus: by its steps
  /// Practice, Repeat: number of trials. Catch: number of pages, at random positions in the block `like`.
  /// GazeValidation: number of tries.
  int count = 0;
  /// GazeValidation: horizontal and vertical angle from the middle target to the outer targets, degrees.
  double extent_deg = 10;
  /// GazeValidation: a try passes if every target had a valid sample and the mean error over the targets is
  /// at most this, degrees. None: any mean error passes.
  std::optional<double> max_accuracy_deg;
  std::string like;              ///< Practice, Repeat, Catch: id of a Stimulus block
  std::vector<TrialStep> steps;  ///< Practice, Stimulus, Repeat: steps of each trial
  double between_groups_s = 0;   ///< Stimulus: length of the break before each group but the first, s
  int break_every = 0;           ///< Stimulus, format 3: trials from one break to the next; 0 = no break
  double break_s = 0;            ///< shortest duration of these breaks, s
  Interruption on_interruption = Interruption::Resume;  ///< Practice, Repeat: that of the block `like`
};

struct Protocol {
  static constexpr int newest_format = 3;

  int format = 2;  ///< 2, or 3, which adds factors and timing profiles
  std::string name;
  std::string version;
  std::string language;
  int participants = 16;  ///< planned number
  Design design;
  std::vector<Block> blocks;  ///< in the order in which a session runs them
  PacingRules pacing;
  ContentRules content;
  TimingTolerance timing;
  HeadsetRules headset;
  bool accept_approximate = false;
  /// Allows sessions in which compared stimuli differ in renderer, picture size or angle, as baked and live
  /// stimuli can.
  bool accept_mixed_pictures = false;
  /// True: the texts instruct participants to look at the middle of the picture, so the gaze point is known
  /// before the session.
  bool fixation = false;
  /// True: the study needs tracked gaze; the console and the notes of a power calculation say so. The value
  /// has no effect on reports: they mark the hypotheses with MethodClaim::needs_gaze.
  bool needs_gaze = false;
  /// True: the camera uses the visual angle of the picture instead of each scene's angle.
  bool true_angle = false;
  /// True after override_trial_seconds(): the protocol's data are marked as test data.
  bool test_data = false;
  /// Argument of override_trial_seconds(); none: the durations of the file. `text` and `trial_seconds`
  /// together rebuild the protocol.
  std::optional<double> trial_seconds;

  std::string place;   ///< name of the protocol file in messages
  std::string text;    ///< the file as read, stored in every database
  std::string sha256;  ///< of `text`; if an option changed the protocol, of `text` and the change
};

/// Every question of the protocol with the index of its block, in the order of the file.
std::vector<std::pair<int, const Question*>> all_questions(const Protocol& protocol);

/// How strictly to read a protocol. Protocols of earlier program versions may fail the newest checks, so
/// Stored skips these: misspelt ids of known questions, the form of gaze_question and sharing_question, and
/// in format 2 method names and n_*.
enum class ProtocolUse { New, Stored };

/// Reads a protocol; base::Error at file:line:column for an unknown key, a wrong type, a value out of range
/// or two keys that contradict each other. `name` names the file in messages.
Protocol parse_protocol(std::string_view text, const std::string& name, ProtocolUse use = ProtocolUse::New);
/// As parse_protocol(); base::Error also for a file that cannot be read or is larger than 1 MiB.
Protocol read_protocol(const std::filesystem::path& path);
/// Sets the duration of every stimulus, 0.1 to 3600 s; changes the hash and marks the data as test. Equal
/// texts and seconds give equal hashes.
void override_trial_seconds(Protocol& protocol, double seconds);

}  // namespace study
