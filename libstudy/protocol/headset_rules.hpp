#pragma once
/// How a headset shows the stimuli of a study. A desktop ignores it.

#include <optional>

namespace study {

/// What a picture that stays on for several periods of the display does when the head moves. Data of
/// different modes are not to be pooled.
enum class Hold {
  Image,      ///< it stays where it was drawn: the runtime turns the old picture
  State,      ///< the content stands still and is drawn anew from where the head is
  HeadLocked  ///< it moves with the head
};

/// "image", "state" or "head_locked".
const char* hold_name(Hold hold);

struct HeadsetRules {
  Hold hold = Hold::Image;
  /// Held pictures reach this far beyond what the eyes see when they are drawn, degrees on each side.
  double hold_margin_deg = 0;
  double world_scale = 1;            ///< metres of the room that a metre of the scene takes
  std::optional<double> refresh_hz;  ///< that the headset must have; none: as it is
};

}  // namespace study
