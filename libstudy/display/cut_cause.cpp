#include "libstudy/display/cut_cause.hpp"

namespace study {

CutWords words_of(CutCause cause) {
  switch (cause) {
    case CutCause::Experimenter:
      return {"the experimenter asked for it again", "press r only where a trial must be shown again"};
    case CutCause::Participant:
      return {"the participant was asked whether to stop, and went on", "ask the participant what is wrong"};
    case CutCause::Minimised:
      return {"the participant's window was minimised", "keep that window open, and close what minimises it"};
    case CutCause::Focus:
      return {"another program had the headset's focus",
              "close menus, overlays and other programs of the headset"};
    case CutCause::TakenOff:
      return {"the headset was taken off",
              "ask the participant to put it on again, and check the sensor between its lenses"};
    case CutCause::NotDrawn:
      return {"the headset's software drew no pictures", "close overlays of the headset's software"};
    case CutCause::Pose:
      return {"the headset lost track of the head",
              "light the room, and check that nothing covers its cameras"};
    case CutCause::Recentred:
      return {"the headset's room was recentred", "switch recentring off in the headset's software"};
    case CutCause::Rate:
      return {"the headset's refresh rate changed", "fix the refresh rate in the headset's software"};
    case CutCause::SessionLost:
      return {"the headset's software lost the session", "restart the headset's software"};
    case CutCause::Gaze:
      return {"the eye tracker lost the eyes for over 100 ms",
              "check how the headset sits, and calibrate the eye tracker"};
    case CutCause::ServiceGone:
      return {"the headset's software ended", "start the headset's software again"};
    case CutCause::Hang:
      return {"the headset's software hung", "restart the headset's software"};
  }
  return {};
}

void note_cut(std::optional<CutCause>& noted, CutCause cause) {
  // Without focus or off the head, the software soon draws no pictures; off the head it has no focus either.
  const bool explains =
      cause == CutCause::SessionLost ||  // a lost session also ends pictures and focus
      (cause == CutCause::TakenOff && (noted == CutCause::Focus || noted == CutCause::NotDrawn)) ||
      (cause == CutCause::Focus && noted == CutCause::NotDrawn);
  if (!noted || explains) noted = cause;
}

}  // namespace study
