#pragma once
/// Poses and fields of view of a headset's eyes, as plain values without OpenXR.

#include <array>

#include "libstudy/display/canvas.hpp"

namespace study {

/// Position (m) and orientation in the headset's world: x right, y up, -z ahead. The runtime fixed the origin
/// at the head's position at some time (OpenXR's LOCAL space).
struct HeadsetPose {
  std::array<float, 3> place_m{};
  std::array<float, 4> turn{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  bool place_valid = false, turn_valid = false;
  /// A position or orientation that is valid but not tracked is an estimate of the runtime.
  bool place_tracked = false, turn_tracked = false;

  bool valid() const { return place_valid && turn_valid; }
};

/// Angles from straight ahead, rad; left and down are usually negative.
struct FieldOfView {
  float left = 0, right = 0, up = 0, down = 0;
};

/// Pose, field of view and picture size of one eye.
struct HeadsetEye {
  HeadsetPose pose;
  FieldOfView fov;
  int width_px = 0, height_px = 0;
};

/// The views of the left and the right eye.
using EyeViews = std::array<HeadsetEye, 2>;

/// True if both poses are valid, so that a picture drawn from them can be shown.
bool can_be_shown(const EyeViews& views);

/// The unit vectors to the right, up and back of a pose, one after the other.
std::array<float, 9> axes_of(const HeadsetPose& pose);
/// The direction in which a pose looks, a unit vector.
std::array<float, 3> direction_of(const HeadsetPose& pose);

/// Converts an eye's view to an EyeView, from which stimuli draw. The eye's picture starts at x_px of the
/// canvas. world_scale: metres of the room per metre of the scene.
EyeView study_view(const HeadsetEye& eye, int x_px, double world_scale = 1);

}  // namespace study
