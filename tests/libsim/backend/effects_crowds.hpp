#pragma once
/// Small sets of particles for the tests of the effects' passes.

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "libsim/solver/stages/stages.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {

/// The passes of an effect; empty if the program was built without it.
inline std::vector<Stage> passes_of(EffectKind kind) {
  std::vector<Stage> out;
  for (const Stage& stage : all_stages())
    if (stage.effect == kind) out.push_back(stage);
  return out;
}
inline std::size_t index_of(EffectKind kind) { return static_cast<std::size_t>(kind); }

/// Particles at rest. A pair is in the neighbour lists if it is nearer than 1.1 times the mean of its
/// supports.
inline FluidState state_of(const std::vector<Vec4>& points, bool one_level) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.one_level = one_level;
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(points.size()));
  p.all().position.from_host(points);
  p.all().predicted.from_host(points);
  std::vector<int> id(points.size());
  std::iota(id.begin(), id.end(), 0);
  p.all().id.from_host(id);
  p.all().level.zero();
  p.all().velocity.zero();
  std::vector<std::vector<int>> lists(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Vec3 offset = xyz(points[i]) - xyz(points[j]);
      const float hbar = (points[i].w + points[j].w) / 2;
      if (j != i && dot(offset, offset) < 1.21f * hbar * hbar) lists[i].push_back(static_cast<int>(j));
    }
  }
  state.neighbours.assign(lists);
  return state;
}

/// The velocities after the density constraint and then only this effect's passes have run once.
inline std::vector<Vec4> velocities_by(EffectKind kind, FluidState& state) {
  constrain_density(state, DensityView(state.particles));
  for (const Stage& stage : passes_of(kind)) stage.run(state);
  return state.particles.all().velocity.to_host();
}

inline double mass(const Vec4& p) { return 1000.0 * std::pow(static_cast<double>(p.w) / 2, 3); }

/// A cube of side^3 particles of spacing d, with its low corner at 0.
inline std::vector<Vec4> cube(int side, float d) {
  std::vector<Vec4> out;
  const auto at = [&](int k) { return d * (static_cast<float>(k) + 0.5f); };
  for (int i = 0; i < side * side * side; ++i)
    out.push_back({at(i % side), at(i / side % side), at(i / side / side), 2 * d});
  return out;
}

/// A loose ball of particles of four sizes.
inline std::vector<Vec4> mixed_ball() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(-0.5f, 0.5f);
  std::vector<Vec4> out;
  while (out.size() < 160) {
    const Vec3 x{at(random), at(random), at(random)};
    if (dot(x, x) > 0.25f) continue;
    const auto level = static_cast<float>(out.size() % 4);
    out.push_back(with_w(x, 0.25f * std::exp2(level / 3)));
  }
  return out;
}

}  // namespace sim::SIM_BACKEND
