#pragma once
/// Selects the frames that update levels: the turns of saliency, splits and merges.

#include "libsim/methods/preset.hpp"

namespace sim {

/// Splits and merges stir the water, visibly: a turn in each frame costs time and gives worse pictures than
/// one in every fourth frame (docs/decisions.md).
struct LevelTurns {
  bool due = true;       ///< the present frame is a turn; always true if a test gives targets
  int frames_since = 0;  ///< frames since the last turn; 0: there was none
  int in_a_row = 0;      ///< number of coming frames that are turns, whatever the period

  /// True if the coming frame is a turn, given the angle by which a gaze has turned since the last one.
  bool would_be(const Readings& r, double turned_deg) const {
    return frames_since == 0 || in_a_row > 0 || frames_since >= r.levels_period_frames ||
           turned_deg > r.saccade_deg;
  }
  /// The first frame counts as a saccade.
  void begin_frame(const Readings& r, double turned_deg) {
    due = would_be(r, turned_deg);
    if (frames_since == 0 || turned_deg > r.saccade_deg) in_a_row = r.saccade_frames + 1;
    if (in_a_row > 0) --in_a_row;
  }
  void end_frame() { frames_since = due ? 1 : frames_since + 1; }
};

}  // namespace sim
