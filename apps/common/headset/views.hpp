#pragma once
/// Where a headset's eyes and rays are: plain values, for those who know nothing of OpenXR.

#include <array>

#include "libstudy/display/canvas.hpp"

namespace apps {

/// A place and a turn in the headset's world: x right, y up, -z ahead, metres; the origin is where the head
/// was when the runtime fixed it (OpenXR's LOCAL space).
struct HeadsetPose {
  std::array<float, 3> place_m{};
  std::array<float, 4> turn{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  bool place_valid = false, turn_valid = false;
  /// Valid and not tracked is a guess of the runtime: sub-nominal.
  bool place_tracked = false, turn_tracked = false;

  bool valid() const { return place_valid && turn_valid; }
};

/// Angles from straight ahead, rad; left and down are negative as a rule.
struct FieldOfView {
  float left = 0, right = 0, up = 0, down = 0;
};

/// What one eye sees from.
struct EyeView {
  HeadsetPose pose;
  FieldOfView fov;
  int width_px = 0, height_px = 0;
};

/// Left and right.
using EyeViews = std::array<EyeView, 2>;

/// Both poses are valid: what they are drawn from can be shown.
bool can_be_shown(const EyeViews& views);

/// Right, up and back of a pose as unit vectors, one behind the other.
std::array<float, 9> axes_of(const HeadsetPose& pose);
/// The direction in which a pose looks, a unit vector.
std::array<float, 3> direction_of(const HeadsetPose& pose);

/// An eye as stimuli take it, whose picture begins at x_px of the canvas. world_scale: metres of the room for
/// a metre of the scene.
study::EyeView study_view(const EyeView& eye, int x_px, double world_scale = 1);

}  // namespace apps
