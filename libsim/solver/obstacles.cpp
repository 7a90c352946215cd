#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

void begin_obstacles(FluidState& state, const Scene& scene, double time_s, bool told) {
  auto& o = state.obstacles;
  // A substep takes a particle no farther than the finest spacing.
  const auto least = static_cast<double>(state.finest_support);
  for (const Obstacle& obstacle : scene.obstacles) {
    if (thickness_m(obstacle) >= least) continue;
    throw base::Error(std::string("obstacle: ") + shape_name(obstacle.shape),
                      "is " + base::shortest(thickness_m(obstacle)) +
                          " m thick: particles of this size could pass through it",
                      "make it at least " + base::shortest(least) + " m thick, or use a larger --n-star");
  }
  o.obstacles = scene.obstacles;
  if (o.obstacles.empty()) return;
  o.bodies.from_host(bodies_at(o.obstacles, time_s, 0));
  if (!told) return;
  o.sums.resize(o.bodies.size());
  o.sums.zero();
}

void count_obstacles(const FluidState& state, MomentumAccount& account) {
  if (!state.impulse.on() || !state.obstacles.told()) return;
  const auto edge = static_cast<double>(state.finest_support) / 2;
  const double unit = static_cast<double>(state.parameters.rest_density) * edge * edge * edge *
                      static_cast<double>(MassWay::unit) / static_cast<double>(state.parameters.dt);
  const auto vector = [&](const MassWay& sum) {
    const auto part = [&](std::uint64_t fixed) {
      return unit * static_cast<double>(static_cast<std::int64_t>(fixed));
    };
    return Vec3d{part(sum.x), part(sum.y), part(sum.z)};
  };
  for (const BodySum& sum : state.obstacles.sums.to_host()) {
    account.obstacles.push_back({vector(sum.push), vector(sum.moment)});
    for (std::size_t k = 0; k < 3; ++k) account.unattributed[k] -= account.obstacles.back().push[k];
  }
}

}  // namespace sim::SIM_BACKEND
