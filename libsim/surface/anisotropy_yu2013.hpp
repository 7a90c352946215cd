#pragma once
/// The ellipsoid by which a particle is drawn, after Yu and Turk 2013 ("Reconstructing surfaces of
/// particle-based fluids using anisotropic kernels"): its axes follow the weighted covariance of the
/// particles around it, its centre follows their weighted mean.

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// A symmetric matrix of 3 x 3 values.
struct Symmetric3 {
  float xx, yy, zz, xy, xz, yz;

  SIM_FN Vec3 times(Vec3 v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  /// Adds s v v^T.
  SIM_FN void add(float s, Vec3 v) {
    xx += s * v.x * v.x;
    yy += s * v.y * v.y;
    zz += s * v.z * v.z;
    xy += s * v.x * v.y;
    xz += s * v.x * v.z;
    yz += s * v.y * v.z;
  }
};
SIM_FN Symmetric3 operator*(float s, const Symmetric3& m) {
  return {s * m.xx, s * m.yy, s * m.zz, s * m.xy, s * m.xz, s * m.yz};
}
SIM_FN Symmetric3 operator+(const Symmetric3& a, const Symmetric3& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

/// Eigenvalues, largest first, and unit eigenvectors of a symmetric matrix, by four sweeps of Jacobi
/// rotations.
struct Eigen3 {
  float value[3];
  Vec3 axis[3];

  SIM_FN explicit Eigen3(const Symmetric3& m) {
    float a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    float v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 4; ++sweep) {
      rotate<0, 1>(a, v);
      rotate<0, 2>(a, v);
      rotate<1, 2>(a, v);
    }
    for (int k = 0; k < 3; ++k) {
      value[k] = a[k][k];
      axis[k] = {v[0][k], v[1][k], v[2][k]};
    }
    order<0, 1>();
    order<1, 2>();
    order<0, 1>();
  }

 private:
  template <int P, int Q>
  SIM_FN static void rotate(float (&a)[3][3], float (&v)[3][3]) {
    constexpr int rest = 3 - P - Q;
    if (!(fabsf(a[P][Q]) > 1e-20f)) return;
    const float theta = 0.5f * (a[Q][Q] - a[P][P]) / a[P][Q];
    const float t = (theta < 0 ? -1.0f : 1.0f) / (fabsf(theta) + sqrtf(theta * theta + 1));
    const float c = 1 / sqrtf(t * t + 1);
    const float s = t * c;
    a[P][P] -= t * a[P][Q];
    a[Q][Q] += t * a[P][Q];
    a[P][Q] = a[Q][P] = 0;
    const float p = a[rest][P];
    const float q = a[rest][Q];
    a[rest][P] = a[P][rest] = c * p - s * q;
    a[rest][Q] = a[Q][rest] = s * p + c * q;
    for (int k = 0; k < 3; ++k) {
      const float first = v[k][P];
      const float second = v[k][Q];
      v[k][P] = c * first - s * second;
      v[k][Q] = s * first + c * second;
    }
  }
  template <int P, int Q>
  SIM_FN void order() {
    if (!(value[P] < value[Q])) return;
    const float less = value[P];
    value[P] = value[Q];
    value[Q] = less;
    const Vec3 moved = axis[P];
    axis[P] = axis[Q];
    axis[Q] = moved;
  }
};

/// Numbers of the drawn surface. Lengths are in units of the particle's radius r unless a comment says
/// otherwise; d = 2 r is the spacing and h = 4 r the support.
struct SurfaceRules {
  /// Radius, in supports of the particle, within which others count: further than the spacing of the
  /// coarsest.
  float reach = 1.25f;
  /// lambda of Yu and Turk, Eq. 6: how far a centre follows the mean of the particles around it.
  float smoothing = 0.9f;
  /// Distance from a particle of the top layer of a flat surface to the mean of the particles around it, in
  /// radii of search. The centre is moved by the difference to this distance, so that a flat surface stays
  /// where it is, and a particle that stands out or lies deep is moved to it.
  float flat_mean = 0.217f;
  /// Radius of the sphere of equal volume: RenderOptions::radius_scale of touching spheres without gaps.
  float volume_radius = 1.5f;
  /// Factor of the long axes of a particle at the surface: a smoother outline than at constant volume.
  float widening = 1.2f;
  float least_axis = 1;    ///< shortest half axis in water
  float most_axis = 2.5f;  ///< longest half axis
  /// Weights of neighbours, in particles of the coarser level, between which a drop becomes water.
  float alone = 1, crowded = 4;
  float drop_radius = 0.8f;  ///< radius of a particle without neighbours
  float most_stretch = 2;    ///< largest ratio of a drop's long half axis to drop_radius
  int fading = 4;            ///< a particle that merged into another is drawn for one frame less, fading out
  float newborn = 0.15f;  ///< share of Ellipsoid::square with which a particle without a last picture begins
  /// Way in a frame, in radii of the particle, up to which a particle blends with its last ellipsoid, and
  /// from which it does not: a blend lags behind moving water, whose changes of level are not seen.
  float slow = 0.1f, fast = 0.4f;
};

/// Weighted sums over the particles around a particle, itself included. Offsets are in supports of the
/// particle.
struct SurfaceMoments {
  float mass = 0, crowd = 0;
  Vec3 first{};
  Symmetric3 second{};

  /// `offset`: from the particle to the other one; `size`: support of the other one; both in supports of the
  /// particle.
  SIM_FN void add(const SurfaceRules& rules, Vec3 offset, float size) {
    const float r = rules.reach;
    const float square = dot(offset, offset);
    if (!(square < r * r)) return;
    const float share = quotient(square, r * r);
    const float volume = size * size * size;
    const float falloff = 1 - share * rough_root(share);  // 1 - (distance / r)^3, Yu and Turk Eq. 11
    const float weight = falloff * volume;
    mass += weight;
    crowd += falloff * at_most(volume, 1.0f);
    first += weight * offset;
    second.add(weight, offset);
  }
};

/// An ellipsoid: the points x with (x - centre)^T square^-1 (x - centre) <= 1.
struct Ellipsoid {
  Vec3 centre;        ///< relative to the particle, m
  Symmetric3 square;  ///< sum over the axes of (half axis)^2 (direction) (direction)^T, m2
  float radius;       ///< of the particle, for the depth filter and the thickness, m
};

/// A drop of a particle of radius r: stretched along its way in one frame, at constant volume.
SIM_FN Symmetric3 drop_of(const SurfaceRules& rules, float r, Vec3 way) {
  const float length_m = length(way);
  const float a = rules.drop_radius * r;
  const float stretch = at_most(1 + 0.25f * length_m / r, rules.most_stretch);
  const float across = a * a / stretch;
  Symmetric3 out{across, across, across, 0, 0, 0};
  if (length_m > 0 && length_m < 1e6f)
    out.add((a * a * stretch * stretch - across) / (length_m * length_m), way);
  return out;
}

SIM_FN float smooth_rise(float from, float to, float x) {
  const float t = at_most(at_least((x - from) / (to - from), 0.0f), 1.0f);
  return t * t * (3 - 2 * t);
}

/// Half axes, longest first, of the ellipsoid with these variances along its axes: in proportion to their
/// roots, with the volume of a sphere of rules.volume_radius, and within the bounds of the rules.
SIM_FN void half_axes(const SurfaceRules& rules, const float (&variance)[3], float (&axis)[3]) {
  // All particles may lie at one place: the variances are then 0.
  const float most = at_least(variance[0], 1e-6f);
  const float least = 0.04f * most;
  const float b = sqrtf(at_most(at_least(variance[1], least), most) / most);
  const float c = sqrtf(at_most(at_least(variance[2], least), most) / most);
  const float v = rules.volume_radius;
  const float one = v / cbrtf(b * c);
  axis[2] = at_least(c * one, rules.least_axis);
  const float area = v * v * v / axis[2];
  axis[1] = at_least(b * sqrtf(area / b), rules.least_axis);
  axis[0] = at_most(area / axis[1], rules.most_axis);
}

/// The ellipsoid of a particle with the support h, m. `way`: its motion in one frame, m.
SIM_FN Ellipsoid ellipsoid_of(const SurfaceRules& rules, const SurfaceMoments& sum, float h, Vec3 way) {
  const float r = 0.25f * h;
  const Symmetric3 drop = drop_of(rules, r, way);
  const float water = smooth_rise(rules.alone, rules.crowded, sum.crowd - 1);
  if (!(water > 0)) return {{0, 0, 0}, drop, r};
  const float inverse = 1 / sum.mass;
  const Vec3 mean = inverse * sum.first;
  Symmetric3 covariance = inverse * sum.second;
  covariance.add(-1, mean);
  const float away = length(mean);
  const float flat = rules.flat_mean * rules.reach;
  const float exposed = smooth_rise(0.2f, 0.6f, away / flat);
  const Eigen3 eigen(covariance);
  float axis[3];
  half_axes(rules, eigen.value, axis);
  const float wider = exposed * (rules.widening - 1);
  axis[1] *= 1 + wider * axis[1] / axis[0];
  axis[0] *= 1 + wider;
  Symmetric3 square{};
  for (int k = 0; k < 3; ++k) square.add(r * r * axis[k] * axis[k], eigen.axis[k]);
  Vec3 shift{};
  if (exposed > 0) {
    const Vec3 out = (-1 / away) * mean;
    const float extent = sqrtf(at_least(dot(out, square.times(out)), 0.0f));
    shift = (water * exposed * (rules.smoothing * (flat - away) * h + r - extent)) * out;
  }
  return {shift, water * square + (1 - water) * drop, r};
}

/// How much a particle of radius r blends with its last ellipsoid: 1 for a slow one, 0 for a fast one. `way`:
/// its motion in one frame, m.
SIM_FN float blend_share(const SurfaceRules& rules, float r, Vec3 way) {
  return 1 - smooth_rise(rules.slow, rules.fast, length(way) / r);
}

/// The ellipsoid `target` as it is drawn if the last picture had `last` (its centre relative to the
/// particle's present place, moved along with the water). `last_r`: the particle's radius then; 0: there was
/// none. follow: share of the way to `target` of a slow particle. share: blend_share(). So a split or a merge
/// changes the picture gradually.
SIM_FN Ellipsoid blended(const SurfaceRules& rules, const Ellipsoid& target, Ellipsoid last, float last_r,
                         float r, float follow, float share) {
  const Vec3 way = target.centre - last.centre;
  const float furthest = 4 * at_least(r, last_r);
  if (!(last_r > 0) || !(dot(way, way) <= furthest * furthest))
    return {target.centre, (1 - share * (1 - rules.newborn)) * target.square, r};
  const float left = share * (1 - follow);
  return {target.centre - left * way, (1 - left) * target.square + left * last.square,
          (1 - left) * r + left * last.radius};
}

}  // namespace sim::SIM_BACKEND
