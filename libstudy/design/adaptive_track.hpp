#pragma once
/// Chooses the cells of an adaptive procedure from the answers so far. A track is one run of the procedure;
/// its cells differ only in the level of the adaptive factor. The state of a track is never stored: it is
/// computed again from the answers, so that a resumed session continues with the same cells.

#include <cstdint>
#include <span>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "stats/adaptive/quest_plus.hpp"

namespace study {

/// An answered trial of a session. Lists of answers are in the order of the trials' positions.
struct TrackAnswer {
  int first = 0;              ///< cell shown first, index into Design::cells
  std::optional<int> second;  ///< cell shown second; none: not a pair
  int score = 0;              ///< answer to Procedure::question
};

/// The answers from which a procedure chooses the next trial.
struct TrackAnswers {
  std::vector<TrackAnswer> own;  ///< all answered trials of the session's stimulus block so far
  /// For ProcedureKind::Ptpe: those of earlier sessions of the same protocol.
  std::vector<TrackAnswer> earlier = {};
  int person = 0;  ///< for ProcedureKind::Ptpe: a number of the session that rises from person to person
};

/// The trials of one group of cells in random order, with the planned number of trials for each track. group:
/// the cells that one participant sees, as indices into Design::cells. Each trial has the first cell of its
/// track as a placeholder, which chosen_trial() replaces before the trial is shown. In a design with pairs,
/// each trial also has the standard, the stimulus with which all others are compared; every second trial of a
/// track shows the standard first.
std::vector<PlannedTrial> track_trials(const Design& design, const std::vector<int>& group,
                                       RandomStream& random);

/// The trial with the cells that the procedure chooses. Answers in other tracks are ignored. The order of the
/// intervals of a pair stays as planned.
PlannedTrial chosen_trial(const Protocol& protocol, const PlannedTrial& planned, const TrackAnswers& answers);

/// The cell that identifies the track of `cell`: the track's cell, other than the standard of a
/// design with pairs, with the lowest level of the adaptive factor. Returns `cell` itself if the track has
/// only the standard. The design must have a procedure.
int first_of_track(const Design& design, int cell);

/// A threshold estimated from the answers of one track of a staircase or of QUEST+.
struct TrackEstimate {
  stats::GridEstimate threshold, shape;  ///< with 95 % intervals; threshold in the unit of Procedure::axis
  int trials = 0;
  /// One entry for each level of the track, in ascending order: the level's value on the axis, its number of
  /// trials, and its number of positive answers.
  std::vector<double> values = {};
  std::vector<int> trials_at = {}, positive_at = {};
};

/// Estimates threshold and shape for the track of cell `cell`, from their posterior over the grid of QUEST+,
/// with the procedure's form, guess and lapse rates. `answers`: all answered trials of the session's stimulus
/// block; those of other tracks are ignored. Not for ProcedureKind::Ptpe.
TrackEstimate estimate_track(const Protocol& protocol, int cell, std::span<const TrackAnswer> answers);

}  // namespace study
