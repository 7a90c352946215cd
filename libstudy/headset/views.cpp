#include "libstudy/headset/views.hpp"

namespace study {

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

EyeView study_view(const HeadsetEye& eye, int x_px, double world_scale) {
  EyeView out;
  for (std::size_t k = 0; k < 3; ++k)
    out.position_m[k] = static_cast<double>(eye.pose.place_m[k]) / world_scale;
  for (std::size_t k = 0; k < 4; ++k) out.orientation[k] = static_cast<double>(eye.pose.turn[k]);
  out.left_rad = static_cast<double>(eye.fov.left);
  out.right_rad = static_cast<double>(eye.fov.right);
  out.up_rad = static_cast<double>(eye.fov.up);
  out.down_rad = static_cast<double>(eye.fov.down);
  out.x_px = x_px;
  out.width_px = eye.width_px;
  out.height_px = eye.height_px;
  return out;
}

}  // namespace study
