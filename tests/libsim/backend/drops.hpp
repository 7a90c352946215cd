#pragma once
/// Random drops over a small domain, for the parts of temporal acceleration.

#include <cmath>
#include <random>
#include <vector>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {

constexpr float h = 0.3f;  // support of level 0, m; its spacing is 0.15 m, cells are 1.5 m wide

struct Drop {
  Vec3 x, v;
  int id, level;
};

inline std::vector<Drop> drops(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(0, 6);
  std::uniform_real_distribution<float> speed(-4, 4);
  std::vector<Drop> out;
  for (int i = 0; i < n; ++i) {
    out.push_back(
        {{at(random), at(random), at(random)}, {speed(random), speed(random), speed(random)}, i, i % 4});
  }
  return out;
}

inline FluidState state_of(const std::vector<Drop>& drops) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.finest_support = h;
  state.domain = {{0, 0, 0}, {6, 4.5f, 6}};  // 4 x 3 x 4 cells; some drops lie above
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(drops.size()));
  std::vector<Vec4> position;
  std::vector<Vec4> velocity;
  std::vector<int> id;
  std::vector<std::uint8_t> level;
  for (const auto& drop : drops) {
    position.push_back(with_w(drop.x, h * std::cbrt(static_cast<float>(1 << drop.level))));
    velocity.push_back(with_w(drop.v, 0));
    id.push_back(drop.id);
    level.push_back(static_cast<std::uint8_t>(drop.level));
  }
  p.all().position.from_host(position);
  p.all().predicted.from_host(position);
  p.all().velocity.from_host(velocity);
  p.all().id.from_host(id);
  p.all().level.from_host(level);
  p.all().age.from_host(std::vector<std::uint8_t>(drops.size(), 255));
  p.all().active.from_host(std::vector<std::uint8_t>(drops.size(), 1));
  p.all().saliency.zero();
  p.all().density.from_host(std::vector<float>(drops.size(), 1));
  return state;
}

/// Measures the grid's mean velocities V from all particles.
inline void update_velocity(VelocityGrid& grid, FluidState& state) {
  CellMomentum sums;
  sums.measure(MovingView(state.particles), nullptr, {{Whose::All, grid.frame()}});
  for_each_pass("mean velocity", grid.finish_velocity(sums.of(0)));
}

}  // namespace sim::SIM_BACKEND
