#pragma once
/// Causes for which the showing of a stimulus is cut and its trial shown again.

#include <optional>
#include <string>

#include "stats/base/error.hpp"

namespace study {

/// The cause of a cut. A new cause needs a case in words_of(). If it is the last one, set Last to it: tests
/// run over all causes up to Last.
enum class CutCause {
  Experimenter,  ///< the experimenter asked to show the trial again
  Participant,   ///< the participant opened the stop dialog and went on
  Minimised,     ///< the participant's window was minimised
  Focus,         ///< another program had the headset's focus
  TakenOff,      ///< the headset was taken off
  NotDrawn,      ///< the headset's software drew no pictures
  Pose,          ///< the headset lost the position of the eyes
  Recentred,     ///< the origin of the headset's room moved
  Rate,          ///< the headset's refresh rate changed
  SessionLost,   ///< the headset's software lost the session
  Gaze,          ///< the eye tracker lost the eyes
  ServiceGone,   ///< the headset's software ended or asked the program to leave
  Hang,          ///< the headset's software let no frame begin
  Last = Hang
};

struct CutWords {
  std::string happened;  ///< for notes and the log
  std::string mend;      ///< what the experimenter can do
};
CutWords words_of(CutCause cause);

/// An error of the display that ends the program, and so cuts the showing for `cause`.
class DisplayGone : public base::Error {
 public:
  DisplayGone(CutCause cause, const std::string& place, const std::string& problem, const std::string& mend)
      : base::Error(place, problem, mend), cause_(cause) {}
  CutCause cause() const { return cause_; }

 private:
  CutCause cause_;
};

/// Stores a cause in `noted` if `noted` is empty, or if the cause explains the earlier one: a lost session
/// explains any cause, a headset taken off explains a lost focus, and both explain missing pictures.
void note_cut(std::optional<CutCause>& noted, CutCause cause);

}  // namespace study
