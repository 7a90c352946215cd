#pragma once
/// How a headset shows the stimuli of a study. A desktop ignores it.

#include <optional>

namespace study {

/// How a picture that is held for several display periods follows the head. Do not pool data of different
/// modes.
enum class Hold {
  Image,      ///< it stays at the pose where it was drawn: the runtime reprojects the old picture
  State,      ///< the fluid is frozen and redrawn from the new head pose
  HeadLocked  ///< it moves with the head
};

/// "image", "state" or "head_locked".
const char* hold_name(Hold hold);

struct HeadsetRules {
  Hold hold = Hold::Image;
  /// Held pictures extend this far beyond the eyes' field of view, degrees on each side.
  double hold_margin_deg = 0;
  double world_scale = 1;            ///< metres in the room per metre of the scene
  std::optional<double> refresh_hz;  ///< that the headset must have; none: any
};

}  // namespace study
