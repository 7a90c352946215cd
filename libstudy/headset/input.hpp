#pragma once
/// The participant's input: gaze, head pose, buttons and pointing.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "libstudy/headset/views.hpp"

namespace study {

/// One ray for both eyes; it starts at `ray.place_m` and goes along direction_of(ray).
struct HeadsetGaze {
  /// When the eyes were sampled, on the session's clock; none if the runtime does not say.
  std::optional<std::int64_t> sampled_ns;
  HeadsetPose ray;  ///< orientation valid but not tracked: sub-nominal
};

/// Buttons and pointing. A button held on both hands counts once.
struct HeadsetHands {
  bool select = false;                            ///< pressed now
  bool select_began = false;                      ///< pressed since the last reading
  bool menu = false;                              ///< pressed now
  std::array<float, 2> stick{};                   ///< right and up, [-1, 1]; 0 without a stick
  std::array<std::optional<HeadsetPose>, 2> aim;  ///< left and right hand; along direction_of()
};

struct HeadsetInput {
  HeadsetPose head;
  bool focused = false;             ///< the following members are set only while focused
  std::optional<HeadsetGaze> gaze;  ///< none: no tracker, or no data now
  HeadsetHands hands;
};

}  // namespace study
