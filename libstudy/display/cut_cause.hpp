#pragma once
/// Why a showing was cut, so that its trial is shown again.

#include <optional>
#include <string>

namespace study {

/// Each cut has one cause. A new one needs its words, and its way into the test over all causes.
enum class CutCause {
  Experimenter,  ///< wished to have the trial shown again
  Participant,   ///< was asked whether to stop, and went on
  Minimised,     ///< the participant's window was
  Focus,         ///< another program had the headset's focus
  TakenOff,      ///< the headset was
  NotDrawn,      ///< the headset's software drew no pictures
  Pose,          ///< the headset did not know where the eyes are
  Recentred,     ///< the origin of the headset's room moved
  Rate,          ///< the headset's refresh rate changed
  SessionLost,   ///< the headset's software gave the session up
  Gaze,          ///< the eye tracker lost the eyes
  Last = Gaze
};

struct CutWords {
  std::string happened;  ///< for notes and the log
  std::string mend;      ///< what the experimenter can do
};
CutWords words_of(CutCause cause);

/// Keeps the first cause. Two say more than what they bring with them: a session that was lost, and a headset
/// that was taken off after its focus went.
void note_cut(std::optional<CutCause>& noted, CutCause cause);

}  // namespace study
