#pragma once
/// The blocks of a protocol, in the order of the session.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/question.hpp"

namespace study {

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

}  // namespace study
