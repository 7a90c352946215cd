#pragma once
/// Selects the frames, called turns, in which saliency, splits and merges are updated.

#include "libsim/methods/preset.hpp"

namespace sim {

/// Decides which frames are turns. Splits and merges visibly disturb the water: compared with a turn in every
/// fourth frame, a turn in every frame costs more time, and gives worse pictures in two of the three measured
/// scenes (docs/decisions.md).
struct LevelTurns {
  /// the present frame is a turn; stays true in a run that never calls begin_frame(), such as one with forced
  /// targets
  bool due = true;
  int frames_since = 0;  ///< frames since the last turn; 0: there was none
  int in_a_row = 0;      ///< number of following frames that are turns although the period has not passed

  /// True if the coming frame is a turn. turned_deg: angle, in degrees, by which a gaze has
  /// moved since the last turn.
  bool would_be(const Readings& r, double turned_deg) const {
    return frames_since == 0 || in_a_row > 0 || frames_since >= r.levels_period_frames ||
           turned_deg > r.saccade_deg;
  }
  /// Sets `due` for the frame that begins. The first frame counts as a frame after a saccade.
  void begin_frame(const Readings& r, double turned_deg) {
    due = would_be(r, turned_deg);
    if (frames_since == 0 || turned_deg > r.saccade_deg) in_a_row = r.saccade_frames + 1;
    if (in_a_row > 0) --in_a_row;
  }
  void end_frame() { frames_since = due ? 1 : frames_since + 1; }
};

}  // namespace sim
