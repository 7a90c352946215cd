#pragma once
/// Features of a particle from the last picture: the curvature of the surface in front of it (paper Eq. 5)
/// and its depth below that surface (Eq. 7-8).

#include "libsim/methods/preset.hpp"
#include "libsim/saliency/eye.hpp"

namespace sim::SIM_BACKEND {

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

/// |grad Phi_n| of Eq. 5, dimensionless: the mean of |n(q) - n(p)| over the fluid pixels q of a square window
/// of half side R = clamp(round(window), 1, most) px around p. At most 64 pixels are read, in a fixed pattern
/// with equally dense columns and rows. A window of R px covers R + 1/2; the last factor corrects this, so
/// that a surface has the same value at every resolution.
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

/// Numerator of Eq. 5 for a particle of radius r; 0 without a fluid pixel.
SIM_FN float manifold_feature(const Eye& eye, const Spot& spot, float r, int window_max_px) {
  if (spot.kind != Spot::Kind::Fluid) return 0;
  const float pixels_per_slope = 1 / eye.rays.scale_y;
  const float window = 5 * r * pixels_per_slope / spot.depth;
  return normal_variation(eye.picture, spot.x, spot.y, window, window_max_px);
}

/// d_t of Eq. 8 with positive eye depths, m. 0 without a picture or without fluid.
SIM_FN float thickness(const Eye& eye, const Spot& spot, float r) {
  if (spot.kind != Spot::Kind::Fluid) return 0;
  const float front = eye.picture.depth[eye.picture.at(spot.x, spot.y)];
  return fmaxf(spot.depth - front - eye.picture.radius_scale * r, 0.0f);
}

struct Attenuation {
  ThicknessWeight reading;
  float per_m;

  /// gamma_t of Eq. 7. Out of view a particle counts as occluded, with the constant 5 of Eq. 7.
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
