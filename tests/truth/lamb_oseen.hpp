#pragma once
/// A Lamb-Oseen vortex in a tank, and a fit of its core.

#include "tests/truth/truth_helpers.hpp"

namespace truth_test {

/// A Lamb-Oseen vortex upright in the middle of a square tank, with its images behind the walls: circulation
/// 1, core c.
struct Vortex {
  double width;
  Vec3d at(const Vec3d& x, double c2) const {
    Vec3d out{};
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const double dx = x[0] - width / 2 - i * width, dz = x[2] - width / 2 - j * width;
        const double r2 = std::max(dx * dx + dz * dz, 1e-12);
        // An image in one wall turns the other way.
        const double u = ((i + j) % 2 ? -1 : 1) / (2 * pi * r2) * (i || j ? 1 : -std::expm1(-r2 / c2));
        out[0] += u * dz;
        out[2] -= u * dx;
      }
    }
    return out;
  }
  bool counts(const Vec3d& x, double c) const {
    return std::hypot(x[0] - width / 2, x[2] - width / 2) < 3 * c;
  }
};

/// c^2 of the vortex, of any circulation, that best fits the water within three initial cores.
inline double core_of(const State& state, const Vortex& vortex, double c0) {
  double best = 0, least = 1e300;
  for (double c2 = 0.5 * c0 * c0; c2 < 8 * c0 * c0; c2 *= 1.01) {
    double along = 0, norm = 0, all = 0;
    for (const auto& p : state) {
      const Vec3d x = place(p), v = velocity(p);
      if (!vortex.counts(x, c0)) continue;
      const Vec3d e = vortex.at(x, c2);
      along += mass(p) * (v[0] * e[0] + v[2] * e[2]);
      norm += mass(p) * (e[0] * e[0] + e[2] * e[2]);
      all += mass(p) * (v[0] * v[0] + v[2] * v[2]);
    }
    const double left = all - along * along / norm;
    if (left < least) {
      least = left;
      best = c2;
    }
  }
  return best;
}

}  // namespace truth_test
