#pragma once
/// One eye in the form that kernels use: its camera, its gaze and the last picture it saw.

#include "libsim/exec/vec.hpp"
#include "libsim/view/camera.hpp"

namespace sim::SIM_BACKEND {

/// The G-buffer of libsim/view/gbuffer.hpp in the back end's memory, with any owner: SaliencyInput uploads a
/// host buffer; a renderer on the same device may pass its own.
struct GBufferView {
  const float* depth = nullptr;   ///< not smoothed, m; +infinity without fluid. nullptr: no picture
  const float* normal = nullptr;  ///< filtered, eye space; 0 without fluid
  int normal_stride = 3;          ///< floats per pixel: 3 from the host, 4 in the renderer's buffer
  int width = 0, height = 0;
  float radius_scale = 1;

  SIM_FN bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  SIM_FN std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  SIM_FN Vec3 normal_at(int x, int y) const {
    const float* n = normal + at(x, y) * static_cast<std::size_t>(normal_stride);
    return {n[0], n[1], n[2]};
  }
};

/// World to eye space: x right, y up, z against the line of sight.
struct EyeSpace {
  float m[12];  ///< three rows of four
  SIM_FN Vec3 operator()(Vec3 x) const {
    return {m[0] * x.x + m[1] * x.y + m[2] * x.z + m[3], m[4] * x.x + m[5] * x.y + m[6] * x.z + m[7],
            m[8] * x.x + m[9] * x.y + m[10] * x.z + m[11]};
  }
};

struct Eye {
  Vec3 viewpoint{};  ///< p_v, m
  Vec3 gaze{};       ///< from visual(), of any length
  EyeSpace now{};    ///< camera of the coming frame
  EyeSpace then{};   ///< camera of the picture
  PixelRays rays{};  ///< of the picture's camera
  GBufferView picture{};
  Vec3 axis{0, 0, -1};     ///< the camera's line of sight, a unit vector
  float visual_scale = 1;  ///< EyeLook::visual_scale

  /// Scales the part of a direction perpendicular to the axis, as the eye sees it in the picture. The result
  /// has any length; unchanged if visual_scale is 1.
  SIM_FN Vec3 visual(Vec3 u) const { return visual_scale * u + ((1 - visual_scale) * dot(u, axis)) * axis; }
};

}  // namespace sim::SIM_BACKEND
