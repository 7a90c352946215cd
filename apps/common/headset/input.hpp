#pragma once
/// What the participant gives: the look of the eyes, the turn of the head, an answer by hand.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "apps/common/headset/views.hpp"

namespace apps {

/// One ray for both eyes; it begins at `ray.place_m` and goes along direction_of(ray).
struct HeadsetGaze {
  /// When the eyes were there, on the session's clock; empty: the runtime does not say.
  std::optional<std::int64_t> sampled_ns;
  HeadsetPose ray;  ///< turn valid and not tracked: sub-nominal
};

/// What is pressed and where the hands point. Held on both hands counts once.
struct HeadsetHands {
  bool select = false;                            ///< is pressed
  bool select_began = false;                      ///< was pressed since the last reading
  bool menu = false;                              ///< likewise is pressed
  std::array<float, 2> stick{};                   ///< right and up, [-1, 1]; 0 without a stick
  std::array<std::optional<HeadsetPose>, 2> aim;  ///< left and right; along direction_of()
};

struct HeadsetInput {
  HeadsetPose head;
  bool focused = false;             ///< what follows is given while focused only
  std::optional<HeadsetGaze> gaze;  ///< empty: no tracker, or it gives nothing now
  HeadsetHands hands;
};

}  // namespace apps
