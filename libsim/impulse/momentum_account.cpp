#include "libsim/impulse/momentum_account.hpp"

#include <algorithm>

namespace sim {

double area_m2(const Gauge& gauge, const Vec3d& room_m) {
  const Vec3d normal = inward_normal(gauge.wall);
  double out = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    if (normal[k] != 0) continue;
    const double low = std::max(gauge.min_m[k], 0.0);
    out *= std::max(std::min(gauge.max_m[k], room_m[k]) - low, 0.0);
  }
  return out;
}

Vec3d MomentumAccount::walls_sum() const {
  Vec3d out{};
  for (std::size_t wall = 0; wall < wall_count; ++wall) {
    const Vec3d normal = inward_normal(static_cast<Wall>(wall));
    for (std::size_t k = 0; k < 3; ++k) out[k] += normal[k] * walls[wall].sum();
  }
  return out;
}

}  // namespace sim
