#include "apps/common/headset/views.hpp"

#include <cmath>

namespace apps {

namespace {

/// Eye to world.
sim::Mat4 matrix_of(const HeadsetPose& pose) {
  const auto axes = axes_of(pose);
  const auto [x, y, z] = pose.place_m;
  return {axes[0], axes[1], axes[2], 0, axes[3], axes[4], axes[5], 0,
          axes[6], axes[7], axes[8], 0, x,       y,       z,       1};
}

sim::Mat4 frustum(const FieldOfView& fov, double near_m, double far_m) {
  const double left = std::tan(fov.left), right = std::tan(fov.right);
  const double down = std::tan(fov.down), up = std::tan(fov.up);
  sim::Mat4 m{};
  m[0] = static_cast<float>(2 / (right - left));
  m[5] = static_cast<float>(2 / (up - down));
  m[8] = static_cast<float>((right + left) / (right - left));
  m[9] = static_cast<float>((up + down) / (up - down));
  m[10] = static_cast<float>(-(far_m + near_m) / (far_m - near_m));
  m[11] = -1;
  m[14] = static_cast<float>(-2 * far_m * near_m / (far_m - near_m));
  return m;
}

}  // namespace

bool can_be_shown(const EyeViews& views) { return views[0].pose.valid() && views[1].pose.valid(); }

std::array<float, 9> axes_of(const HeadsetPose& pose) {
  const auto [x, y, z, w] = pose.turn;
  return {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
          2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
          2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
}

std::array<float, 3> direction_of(const HeadsetPose& pose) {
  const auto axes = axes_of(pose);
  return {-axes[6], -axes[7], -axes[8]};
}

sim::View view_of(const EyeView& eye, double near_m, double far_m) {
  sim::View view;
  view.view = sim::rigid_inverse(matrix_of(eye.pose));
  view.projection = frustum(eye.fov, near_m, far_m);
  view.viewport = {0, 0, eye.width_px, eye.height_px};
  view.near_m = near_m;
  view.far_m = far_m;
  return view;
}

}  // namespace apps
