#pragma once
/// The target on which a stimulus is drawn: one picture, or one for each eye of a headset.

#include <array>
#include <span>

namespace study {

/// One eye of a headset in the frame of the anchor, m: x right, y up, z back. The anchor is at the scene's
/// camera and has the camera's heading without its pitch.
struct EyeView {
  std::array<double, 3> position_m{};             ///< position of the eye
  std::array<double, 4> orientation{0, 0, 0, 1};  ///< x y z w of a unit quaternion; the eye looks along -z
  /// Edges of the eye's picture: angles from straight ahead in (-pi/2, pi/2), positive to the right and up;
  /// left < right, down < up.
  double left_rad = 0, right_rad = 0, up_rad = 0, down_rad = 0;
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< the eye's part of the canvas; origin: lower left
};

struct Canvas {
  unsigned framebuffer = 0;  ///< OpenGL framebuffer object of the current context
  int width_px = 0, height_px = 0;
  std::span<const EyeView> eyes{};  ///< two for a headset; none: one picture from the scene's camera
};

}  // namespace study
