#pragma once
/// What an eye sees of a particle: its camera, gaze and last picture, visual acuity as a function of
/// eccentricity and depth (ViP-Fluid Eq. 3-4), the curvature of the surface in front of the particle (Eq. 5)
/// and its depth below that surface (Eq. 7-8).

#include "libsim/exec/vec.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/view/camera.hpp"

namespace sim::SIM_BACKEND {

/// Pointers to a G-buffer (libsim/view/gbuffer.hpp) in the back end's memory. SaliencyInput owns the arrays:
/// copies of a host G-buffer or of the renderer's GL buffers.
struct GBufferView {
  const float* depth = nullptr;   ///< not smoothed, m; +infinity without fluid. nullptr: no picture
  const float* normal = nullptr;  ///< filtered, eye space; 0 without fluid
  int normal_stride = 3;          ///< floats per pixel: 3 from the host, 4 from the renderer's buffer
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

/// One eye in the form that kernels use.
struct Eye {
  Vec3 viewpoint{};  ///< position p_v of the eye, m
  Vec3 gaze{};       ///< direction of the gaze after visual(), of any length
  EyeSpace now{};    ///< camera of the coming frame
  EyeSpace then{};   ///< camera of the picture
  PixelRays rays{};  ///< of the picture's camera
  GBufferView picture{};
  Vec3 axis{0, 0, -1};     ///< the camera's line of sight, a unit vector
  float visual_scale = 1;  ///< EyeLook::visual_scale

  /// Direction in which the eye sees a direction u of the picture: the part of u perpendicular to the axis is
  /// scaled by visual_scale. The result has any length.
  SIM_FN Vec3 visual(Vec3 u) const { return visual_scale * u + ((1 - visual_scale) * dot(u, axis)) * axis; }
};

struct Acuity {
  AcuityFalloff falloff;
  float fovea;        ///< half angle theta_f of the fovea, rad
  float image_plane;  ///< distance z_Pi of the image plane, m

  SIM_FN static constexpr float radians(float degrees) { return degrees * 0.017453292519943f; }

  /// Angle between the gaze and the direction in which the eye sees x (visual()), rad. Computed by atan2f,
  /// because an arc cosine would lose all precision below 0.03 degrees.
  SIM_FN static float eccentricity(const Eye& eye, Vec3 x) {
    const Vec3 u = eye.visual(x - eye.viewpoint);
    const Vec3 g = eye.gaze;
    const Vec3 across = {g.y * u.z - g.z * u.y, g.z * u.x - g.x * u.z, g.x * u.y - g.y * u.x};
    return atan2f(length(across), dot(g, u));
  }

  /// Acuity e(theta) at the eccentricity theta, ViP-Fluid Eq. 3: 1 within the fovea, decreasing outside.
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

  /// ViP-Fluid Eq. 4: |x - p_v| / |ints_Pi - p_v|, the distance of x from the eye p_v divided by that of the
  /// image plane on the same ray, is z / z_Pi by similar triangles.
  SIM_FN float depth_factor(float z) const { return z / image_plane; }

  /// Acuity feature f_a, ViP-Fluid Eq. 3, at most 1; 0 behind the viewer.
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

/// Level of ViP-Fluid Eq. 9, with the floor function and the clamp that the printed equation lacks. The
/// caller handles s outside [0, 1] or NaN.
SIM_FN int level_of_saliency(float s, int levels) {
  const int level = static_cast<int>(floorf(static_cast<float>(levels) * (1 - s)));
  return level < 0 ? 0 : level < levels ? level : levels - 1;
}

/// A particle's position in a picture.
struct Spot {
  enum class Kind { NoPicture, OutOfView, Background, Fluid };
  Kind kind;
  int x, y;     ///< px
  float depth;  ///< of the particle, m
};

SIM_FN Spot find_spot(const Eye& eye, Vec3 x) {
  const GBufferView& g = eye.picture;
  if (!g.depth) return {Spot::Kind::NoPicture, 0, 0, 0};
  const Vec3 e = eye.then(x);
  const float z = -e.z;
  if (!(z > 0)) return {Spot::Kind::OutOfView, 0, 0, z};
  const float px = floorf((e.x / z - eye.rays.offset_x) / eye.rays.scale_x);
  const float py = floorf((e.y / z - eye.rays.offset_y) / eye.rays.scale_y);
  // Compared as floats: far-off positions overflow an int, and NaN counts as out of view too.
  const bool inside =
      px >= 0 && py >= 0 && px < static_cast<float>(g.width) && py < static_cast<float>(g.height);
  if (!inside) return {Spot::Kind::OutOfView, 0, 0, z};
  const int column = static_cast<int>(px);
  const int row = static_cast<int>(py);
  const bool fluid = std::isfinite(g.depth[g.at(column, row)]);
  return {fluid ? Spot::Kind::Fluid : Spot::Kind::Background, column, row, z};
}

/// Variation of the surface normal n, |grad Phi_n| of ViP-Fluid Eq. 5, dimensionless: the mean of |n(q) -
/// n(p)| over the fluid pixels q of a square window of half side R = clamp(round(window), 1, most) px around
/// p. At most 64 pixels are read, in a fixed pattern with equally dense columns and rows. The pixels of the
/// window extend R + 1/2 px from the centre of p; the last factor corrects for this, so that a surface has
/// the same value at every resolution.
SIM_FN float normal_variation(const GBufferView& g, int x, int y, float window, int most) {
  const Vec3 centre = g.normal_at(x, y);
  if (!(dot(centre, centre) > 0.25f)) return 0;
  const float wanted = fminf(fmaxf(window, 1.0f), static_cast<float>(most));
  const int reach = static_cast<int>(wanted + 0.5f);
  const int side = 2 * reach + 1;
  constexpr int pattern = 64;
  const bool whole = side * side <= pattern;
  const int taps = whole ? side * side : pattern;
  float sum = 0;
  int found = 0;
  for (int k = 0; k < taps; ++k) {
    const int mirrored =
        (k & 1) << 5 | (k & 2) << 3 | (k & 4) << 1 | (k & 8) >> 1 | (k & 16) >> 3 | (k & 32) >> 5;
    const int qx = x - reach + (whole ? k % side : (2 * k + 1) * side / (2 * pattern));
    const int qy = y - reach + (whole ? k / side : (2 * mirrored + 1) * side / (2 * pattern));
    if (!g.holds(qx, qy)) continue;
    const Vec3 other = g.normal_at(qx, qy);
    if (!(dot(other, other) > 0.25f)) continue;
    sum += length(other - centre);
    ++found;
  }
  if (found == 0) return 0;
  return sum / static_cast<float>(found) * (wanted / (static_cast<float>(reach) + 0.5f));
}

/// Numerator of the manifold feature, ViP-Fluid Eq. 5, for a particle of radius r; 0 without a fluid pixel.
SIM_FN float manifold_feature(const Eye& eye, const Spot& spot, float r, int window_max_px) {
  if (spot.kind != Spot::Kind::Fluid) return 0;
  const float pixels_per_slope = 1 / eye.rays.scale_y;
  const float window = 5 * r * pixels_per_slope / spot.depth;
  return normal_variation(eye.picture, spot.x, spot.y, window, window_max_px);
}

/// Thickness d_t of the water in front of a particle, ViP-Fluid Eq. 8 with positive eye depths, m. 0 without
/// a picture or without fluid.
SIM_FN float thickness(const Eye& eye, const Spot& spot, float r) {
  if (spot.kind != Spot::Kind::Fluid) return 0;
  const float front = eye.picture.depth[eye.picture.at(spot.x, spot.y)];
  return fmaxf(spot.depth - front - eye.picture.radius_scale * r, 0.0f);
}

struct Attenuation {
  ThicknessWeight reading;
  float per_m;

  /// Occlusion gamma_t, ViP-Fluid Eq. 7, for the thickness d_t in m. Out of view a particle counts as
  /// occluded, with the constant 5 of Eq. 7.
  SIM_FN float operator()(const Spot& spot, float d_t) const {
    if (spot.kind == Spot::Kind::OutOfView) return 5;
    return at(d_t);
  }
  SIM_FN float at(float d_t) const {
    const float rise = expf(per_m * fmaxf(d_t, 0.0f));
    return reading == ThicknessWeight::Min ? fminf(rise, 5.0f) : fmaxf(rise, 5.0f);
  }
};

}  // namespace sim::SIM_BACKEND
