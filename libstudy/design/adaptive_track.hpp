#pragma once
/// Chooses the cells of an adaptive procedure from the answers so far. The procedure's state is never stored.
/// It is rebuilt from the answers, so a resumed session continues with the same cells.

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

/// The trials of one group of cells: each track has its planned number of trials, and the tracks are
/// interleaved at random. Until it is shown, a trial names the first cell of its track. In a design with
/// pairs it also names the standard, which half of a track's trials show first.
std::vector<PlannedTrial> track_trials(const Design& design, const std::vector<int>& group,
                                       RandomStream& random);

/// The trial with the cells that the procedure chooses. `answers`: all answered trials of the session's
/// stimulus block so far; those of other tracks are ignored. The order of the intervals of a pair stays as
/// planned.
PlannedTrial chosen_trial(const Protocol& protocol, const PlannedTrial& planned,
                          std::span<const TrackAnswer> answers);

/// The cell that identifies the track of `cell`: the track's cell with the lowest level of the adaptive
/// factor, the standard aside. `cell` itself if the track has only the standard. The design has a procedure.
int first_of_track(const Design& design, int cell);

/// A threshold estimated from the answers of one track of a staircase or of QUEST+.
struct TrackEstimate {
  stats::GridEstimate threshold, shape;  ///< threshold in the unit of Procedure::axis; 95 % intervals
  int trials = 0;
  /// By level of the track, ascending: its value on the axis, its trials, and those with a positive answer.
  std::vector<double> values = {};
  std::vector<int> trials_at = {}, positive_at = {};
};

/// The posterior of threshold and shape over the grid of QUEST+, with the procedure's form, guess and lapse
/// rates. Not for ProcedureKind::Ptpe. `answers` as for chosen_trial(); the track is that of cell `cell`.
TrackEstimate estimate_track(const Protocol& protocol, int cell, std::span<const TrackAnswer> answers);

}  // namespace study
