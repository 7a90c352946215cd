#pragma once
/// Water and pools of foam for kernels of foam.

#include <numeric>
#include <random>

#include "libsim/foam/motion.hpp"
#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND::foam_crowds {

using Speed = Vec3 (*)(Vec3);

/// Water at these positions with these supports (w) in a tank of 4 m, sorted into the grid, with a pool of
/// `most` foam particles.
struct Water {
  FluidState state;
  FoamRules rules;

  Water(const std::vector<Vec4>& points, bool one_level, Speed speed, int most = 4096) {
    state.guards.resize(1);
    state.guards.zero();
    state.one_level = one_level;
    state.supports = level_supports(0.2);
    state.lightest_support = points.empty() ? 0.2f : points[0].w;
    state.domain = {{0, 0, 0}, {4, 4, 4}};
    auto& p = state.particles;
    p.allocate(all_columns(), static_cast<int>(points.size()));
    std::vector<int> id(points.size());
    std::iota(id.begin(), id.end(), 0);
    std::vector<std::uint8_t> level;
    std::vector<Vec4> velocity;
    for (const Vec4& x : points) {
      level.push_back(one_level ? 0 : static_cast<std::uint8_t>(std::lround(3 * std::log2(x.w / 0.2f))));
      velocity.push_back(with_w(speed(xyz(x)), 0));
    }
    p.all().position.from_host(points);
    p.all().predicted.from_host(points);
    p.all().velocity.from_host(velocity);
    p.all().id.from_host(id);
    p.all().level.from_host(level);
    find_neighbours(state, NeighboursView(p));
    state.finest_support = one_level && !points.empty() ? points[0].w : 0.2f;
    state.foam.begin(most, static_cast<int>(points.size()));
    state.foam.cells.lay(state.domain, 0.4f, state.finest_support);
    state.foam.approach.resize(points.size());
    rules.dt = 0.02f;
    rules.rate = 1;
    rules.approach = rules.crest = {1e9f, 1};
    rules.energy = {0, 1e-6f};
    rules.volume = 1e-6f;
  }

  FoamView view() { return FoamView(state.particles); }
  template <class Bounds>
  void find_surface(const Bounds& bounds) {
    find_meeting(state.foam.cells, view(), bounds);
    find_foam_surface(state.foam, view(), state.grid, bounds, rules);
  }
  std::vector<int> births() {
    find_surface(state.walls);
    count_foam_births(state.foam, view(), state.grid, rules);
    return state.foam.births.to_host();
  }
  void emit() {
    births();
    emit_foam(state.foam, view(), state.walls, rules);
  }
  void move() { move_foam(state.foam, view(), state.grid, state.walls, rules); }
  FoamLedger ledger() { return state.foam.ledger.to_host()[0]; }
  std::uint64_t alive() {
    std::uint64_t out = 0;
    for (const Vec4& x : state.foam.place.to_host()) out += x.w > 0;
    return out;
  }
};

/// Lattice points of spacing h / 2 in [low, high]^3.
inline std::vector<Vec4> cube(float low, float high, float h) {
  std::vector<Vec4> out;
  const float d = h / 2;
  for (float x = low + d / 2; x < high; x += d)
    for (float y = low + d / 2; y < high; y += d)
      for (float z = low + d / 2; z < high; z += d) out.push_back({x, y, z, h});
  return out;
}

inline std::vector<Vec4> mixed_crowd() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(1, 2);
  std::vector<Vec4> out;
  for (int i = 0; i < 400; ++i)
    out.push_back({at(random), at(random), at(random), 0.2f * std::exp2(static_cast<float>(i % 4) / 3)});
  return out;
}

inline Vec3 stirred(Vec3 x) { return {3 + std::sin(9 * x.y), std::cos(7 * x.z), std::sin(5 * x.x + x.y)}; }

/// Replaces the first foam particle of the pool by one at x with velocity v.
inline void put(Water& water, Vec4 x, Vec3 v) {
  auto place = water.state.foam.place.to_host();
  auto velocity = water.state.foam.velocity.to_host();
  place[0] = x;
  velocity[0] = with_w(v, 1);
  water.state.foam.place.from_host(place);
  water.state.foam.velocity.from_host(velocity);
}

}  // namespace sim::SIM_BACKEND::foam_crowds
