/// Effects that leave out coarse water: which particles take part, and what is conserved.

#include <array>
#include <cstring>

#include "tests/libsim/backend/effects_crowds.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// A ball of several levels with random velocities and temperatures, before and after one effect that acts up
/// to the level `coarsest`.
struct Crowd {
  EffectKind kind;
  int coarsest;
  int levels = 4;      ///< number of levels in the ball
  bool walled = true;  ///< adds a warm wall beside it
  bool whole = true;   ///< includes the particles that are too coarse for the effect

  std::vector<Vec4> points = {}, before = {}, after = {};
  std::vector<int> level = {};
  std::vector<float> warmth_before = {}, warmth_after = {};

  void run() {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> any(-1, 1);
    std::vector<std::uint8_t> levels_column;
    int number = 0;
    for (const Vec4& at : mixed_ball()) {
      const int own = number++ % levels;
      const Vec4 v{any(random), any(random), any(random), 0};
      const float warmth = any(random) > 0 ? 10.0f : 2.0f;
      if (!whole && own > coarsest) continue;
      points.push_back(with_w(xyz(at), 0.25f * std::exp2(static_cast<float>(own) / 3)));
      before.push_back(v);
      warmth_before.push_back(warmth);
      level.push_back(own);
      levels_column.push_back(static_cast<std::uint8_t>(own));
    }
    auto state = state_of(points, false);
    state.finest_support = 0.25f;
    state.supports = level_supports(0.25);
    if (walled) state.walls.planes[state.walls.count++] = {{1, 0, 0}, -0.42f};
    state.heat.resize(1);
    state.heat.zero();
    auto& p = state.particles.all();
    p.level.from_host(levels_column);
    p.velocity.from_host(before);
    p.temperature.from_host(warmth_before);
    set(state.parameters.effects);
    constrain_density(state, DensityView(state.particles));
    if (kind == EffectKind::Adhesion) passes_of(EffectKind::Cohesion).front().run(state);
    for (const Stage& stage : passes_of(kind)) stage.run(state);
    after = p.velocity.to_host();
    warmth_after = p.temperature.to_host();
  }

  void set(EffectCoefficients& effects) const {
    effects = coefficients_of({{EffectKind::Viscosity, 2},
                               {EffectKind::Cohesion, 50},
                               {EffectKind::Adhesion, 40},
                               {EffectKind::AirDrag, 5},
                               {EffectKind::Vorticity, 1},
                               {EffectKind::Friction, 1},
                               {EffectKind::Heat, 0.2}});
    effects.options[static_cast<std::size_t>(EffectOption::VorticityMost)] = 1e6;
    effects.options[static_cast<std::size_t>(EffectOption::HeatWall)] = walled ? 400 : 0;
    effects.options[static_cast<std::size_t>(*coarsest_level_of(kind))] = coarsest;
  }
  bool changed(std::size_t i) const {
    const Vec4 a = before[i], b = after[i];
    return a.x != b.x || a.y != b.y || a.z != b.z || a.w != b.w || warmth_before[i] != warmth_after[i];
  }
};

constexpr EffectKind kinds[] = {EffectKind::Viscosity, EffectKind::Cohesion,  EffectKind::Adhesion,
                                EffectKind::AirDrag,   EffectKind::Vorticity, EffectKind::Friction,
                                EffectKind::Heat};

SIM_TEST(OwnLevels, CoarserWaterIsNotTouchedAndOtherWaterIs) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : kinds) {
    for (int coarsest = 0; coarsest < 4; ++coarsest) {
      SCOPED_TRACE(std::string(traits_of(kind).word) + " to level " + std::to_string(coarsest));
      Crowd crowd{.kind = kind, .coarsest = coarsest};
      crowd.run();
      std::array<int, 4> changed{};
      for (std::size_t i = 0; i < crowd.points.size(); ++i)
        changed[static_cast<std::size_t>(crowd.level[i])] += crowd.changed(i);
      for (int level = 0; level < 4; ++level) {
        if (level > coarsest) {
          EXPECT_EQ(changed[static_cast<std::size_t>(level)], 0) << level;
        } else {
          EXPECT_GT(changed[static_cast<std::size_t>(level)], 0) << level;
        }
      }
    }
  }
}

SIM_TEST(OwnLevels, WaterThatIsFineThroughoutHasTheSameBits) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : kinds) {
    Crowd all{.kind = kind, .coarsest = 3, .levels = 2}, own = all;
    own.coarsest = 1;
    all.run();
    own.run();
    EXPECT_EQ(std::memcmp(all.after.data(), own.after.data(), all.after.size() * sizeof(Vec4)), 0)
        << traits_of(kind).word;
    EXPECT_EQ(all.warmth_after, own.warmth_after) << traits_of(kind).word;
  }
}

/// An effect on pairs acts on both particles of a pair.
SIM_TEST(OwnLevels, MomentumAndHeatStayAtEveryLevel) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : {EffectKind::Viscosity, EffectKind::Cohesion, EffectKind::Heat}) {
    for (int coarsest = 0; coarsest < 4; ++coarsest) {
      SCOPED_TRACE(std::string(traits_of(kind).word) + " to level " + std::to_string(coarsest));
      Crowd crowd{.kind = kind, .coarsest = coarsest, .walled = false};
      crowd.run();
      double gain[4] = {}, exchanged[4] = {};
      for (std::size_t i = 0; i < crowd.points.size(); ++i) {
        const double m = mass(crowd.points[i]);
        const Vec3 dv = xyz(crowd.after[i]) - xyz(crowd.before[i]);
        const float warmer = crowd.warmth_after[i] - crowd.warmth_before[i];
        const float each[4] = {dv.x, dv.y, dv.z, warmer};
        for (int k = 0; k < 4; ++k) {
          gain[k] += m * static_cast<double>(each[k]);
          exchanged[k] += m * std::abs(static_cast<double>(each[k]));
        }
      }
      const bool heat = kind == EffectKind::Heat;
      for (int k = heat ? 3 : 0; k < (heat ? 4 : 3); ++k) {
        ASSERT_GT(exchanged[k], 0) << "something must move for the test to mean anything";
        EXPECT_LT(std::abs(gain[k]), 3e-6 * exchanged[k]) << k;
      }
    }
  }
}

/// An effect on pairs gives the same result if the water that it leaves out is removed.
SIM_TEST(OwnLevels, CoarserWaterHoldsNothingBack) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : {EffectKind::Viscosity, EffectKind::Heat}) {
    SCOPED_TRACE(std::string(traits_of(kind).word));
    Crowd among{.kind = kind, .coarsest = 1}, alone = among;
    alone.whole = false;
    among.run();
    alone.run();
    std::size_t k = 0;
    for (std::size_t i = 0; i < among.points.size(); ++i) {
      if (among.level[i] > 1) continue;
      EXPECT_LT(length(xyz(among.after[i]) - xyz(alone.after[k])), 1e-5f) << i;
      EXPECT_NEAR(among.warmth_after[i], alone.warmth_after[k], 1e-5f) << i;
      ++k;
    }
    EXPECT_EQ(k, alone.points.size());
  }
}

}  // namespace
}  // namespace sim::SIM_BACKEND
