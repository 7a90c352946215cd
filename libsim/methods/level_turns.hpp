#pragma once
/// In which frames levels are chosen: the turns of saliency, splits and merges.

#include "libsim/methods/preset.hpp"

namespace sim {

/// Splits and merges stir water, and are seen: a turn in each frame costs time and makes worse pictures than
/// one in every fourth (docs/solver_notes.md).
struct LevelTurns {
  bool due = true;       ///< the frame that runs has one; stays so where a test gives targets
  int frames_since = 0;  ///< the last one; 0: there was none
  int in_a_row = 0;      ///< frames to come that have one, whatever the period is

  /// Would the coming frame have one, when a gaze has turned so far since the last?
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
