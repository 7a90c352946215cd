#pragma once
/// The blocks that a protocol composes, in the order of the session.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/question.hpp"

namespace study {

/// Word in the file and in the database: lower case, e.g. "instructions" (block_kind_name).
enum class BlockKind {
  Instructions,  ///< a text to be read
  Screening,     ///< questions that may rule a person out
  Consent,       ///< a text with boxes to tick; asked before anything is kept
  Demographics,  ///< questions, as a rule personal
  Practice,      ///< trials that are flagged, never dropped
  Stimulus,      ///< the trials of the design
  Question,      ///< questions outside the trials
  Rest,          ///< a pause with a countdown that nobody can cut short
  Break,         ///< a longer one that ends when the participant wishes, not before `seconds`
  Black,         ///< a black screen
  Repeat,        ///< trials shown again: test-retest
  Catch,         ///< pages among the trials, with an answer that attention gives
  Ssq,           ///< Simulator Sickness Questionnaire (Kennedy et al. 1993)
  /// Targets to look at: how well the eye tracker does. Left out where none is read, or may be recorded.
  GazeValidation,
  Fms,     ///< Fast Motion Sickness scale, 0 to 20 (Keshavarz and Hecht 2011), with a stop rule
  Debrief  ///< the last text
};

/// "instructions", "screening", ...
std::string block_kind_name(BlockKind kind);
/// Its units are trials: Practice, Stimulus and Repeat.
bool has_trials(BlockKind kind);

/// One thing that a trial does, in order. In the file: "black 3", "stimulus", "stimulus first", "stimulus
/// second", "ask realism dizziness", "rest 30".
enum class StepKind { Black, Stimulus, Ask, Rest };

struct TrialStep {
  StepKind kind = StepKind::Stimulus;
  double seconds = 0;             ///< Black, Rest
  int interval = 0;               ///< Stimulus: 0, or 0 and 1 of a pair
  std::vector<std::string> asks;  ///< Ask: ids of questions of any block

  bool operator==(const TrialStep&) const = default;
};

/// What resuming a session does about the trial that was under way when it stopped. Word in the file:
/// "resume", "restart_block", "invalidate". Whatever was shown and answered stays in the database.
enum class Interruption {
  Resume,        ///< the trial is shown again
  RestartBlock,  ///< all trials of its block are shown again, from the first
  Invalidate     ///< the trial is left out, excluded as interrupted; the next one follows
};

struct Block {
  BlockKind kind = BlockKind::Instructions;
  std::string id;                   ///< unique in the protocol
  std::string title;                ///< of a page; may be empty
  std::string text;                 ///< of a page: plain, paragraphs parted by empty lines
  double seconds = 0;               ///< Rest, Break, Black: length. Instructions, Debrief: least time
  std::vector<Question> questions;  ///< of a page; Stimulus: asked in its steps
  /// Practice, Repeat: trials. Catch: pages, at random places of `like`. GazeValidation: tries.
  int count = 0;
  double extent_deg = 10;  ///< GazeValidation: of the outer targets from the middle, across and up
  /// GazeValidation: of the mean over the targets; more is tried again, and at last refused. None: any.
  std::optional<double> max_accuracy_deg;
  std::string like;              ///< Practice, Repeat, Catch: id of a Stimulus block
  std::vector<TrialStep> steps;  ///< Practice, Stimulus, Repeat: what each trial does
  double between_groups_s = 0;   ///< Stimulus: a break before each group of the design but the first
  Interruption on_interruption = Interruption::Resume;  ///< Practice, Stimulus, Repeat: that of Stimulus
};

}  // namespace study
