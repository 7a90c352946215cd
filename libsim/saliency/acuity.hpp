#pragma once
/// Visual acuity as a function of eccentricity and depth (paper Eq. 3-4).

#include "libsim/methods/preset.hpp"
#include "libsim/saliency/eye.hpp"

namespace sim::SIM_BACKEND {

struct Acuity {
  AcuityFalloff falloff;
  float fovea;        ///< theta_f, rad
  float image_plane;  ///< z_Pi, m

  SIM_FN static constexpr float radians(float degrees) { return degrees * 0.017453292519943f; }

  /// Angle between the gaze and the direction to x, as seen in the picture, rad. An arc cosine would lose all
  /// precision below 0.03 degrees.
  SIM_FN static float eccentricity(const Eye& eye, Vec3 x) {
    const Vec3 u = eye.visual(x - eye.viewpoint);
    const Vec3 g = eye.gaze;
    const Vec3 across = {g.y * u.z - g.z * u.y, g.z * u.x - g.x * u.z, g.x * u.y - g.y * u.x};
    return atan2f(length(across), dot(g, u));
  }

  /// e(theta): 1 within the fovea, decreasing outside.
  SIM_FN float falloff_at(float theta) const {
    const float beyond = theta - fovea;
    if (beyond <= 0) return 1;
    if (falloff == AcuityFalloff::Smoothstep) {
      const float t = fminf(beyond / fmaxf(radians(30) - fovea, 1e-6f), 1.0f);
      return 1 - t * t * (3 - 2 * t);
    }
    const float e2 = falloff == AcuityFalloff::Hyperbolic ? radians(2.3f) : radians(0.85f);
    return 1 / (1 + beyond / e2);
  }

  /// Eq. 4: |x - p_v| / |ints_Pi - p_v| = z / z_Pi by similar triangles.
  SIM_FN float depth_factor(float z) const { return z / image_plane; }

  /// f_a, Eq. 3; 0 behind the viewer.
  SIM_FN float feature(const Eye& eye, Vec3 x, float z) const {
    if (z <= 0) return 0;
    const float quotient = falloff_at(eccentricity(eye, x)) / depth_factor(z);
    return quotient > 1 ? 1 : quotient;  // preserves a NaN, unlike fminf
  }

  /// s of a gaze-only method (FovFluid-like): 1 in the fovea, falling to 0 over a band of width `band` (m)
  /// outside its cone. Near the axis an angle at the eye is visual_scale times the camera's angle.
  SIM_FN float gaze_saliency(const Eye& eye, Vec3 x, float band) const {
    const float beyond = (eccentricity(eye, x) - fovea) / eye.visual_scale;
    if (beyond <= 0) return 1;
    if (beyond >= 1.5f) return 0;
    const float way = length(x - eye.viewpoint) * sinf(beyond);
    return 1 - fminf(way / band, 1.0f);
  }
};

/// Eq. 9 with the floor and the clamp that the printed version lost; the caller handles s outside [0, 1] or
/// NaN.
SIM_FN int level_of_saliency(float s, int levels) {
  const int level = static_cast<int>(floorf(static_cast<float>(levels) * (1 - s)));
  return level < 0 ? 0 : level < levels ? level : levels - 1;
}

}  // namespace sim::SIM_BACKEND
