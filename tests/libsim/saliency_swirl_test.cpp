/// Vortices raise saliency if the scene lists vorticity.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::EffectKind;
using sim::MethodKind;
using testing::HasSubstr;
using State = std::vector<sim::ParticleState>;

constexpr double core = 0.6,
                 middle = 1.2;  // m: radius of the vortex, and distance of its axis from two walls

/// A long tank of water; none of it is in the eye's fovea.
sim::Scene tank_with(std::vector<sim::Effect> effects) {
  auto out = fluid_test::tank({4.8, 1.6, 2.4}, {4.8, 0.7, 2.4});
  out.view.eye_m = {2.4, 4, 1.3};
  out.view.target_m = {2.4, 0, 1.2};
  out.effects = std::move(effects);
  return out;
}
std::vector<sim::Effect> vorticity(double weight, double speed = 0.02) {
  sim::Effect out{EffectKind::Vorticity, speed};
  out.options[static_cast<std::size_t>(sim::EffectOption::VorticitySaliency)] = weight;
  return {out};
}

struct Outcome {
  std::string explanation;
  std::size_t bytes = 0;
  State state;
};
/// Runs water that is at rest except for a Lamb-Oseen vortex at one end, whose vorticity is at most 8 / s.
Outcome run(const sim::Scene& scene, MethodKind method, int frames, Backend backend = Backend::Cpu) {
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = 512;
  options.temporal.fixed_tau = -6;
  options.start = sim::make_simulation(scene, options)->read_state();
  for (auto& p : *options.start) {
    const double x = static_cast<double>(p.x_m) - middle, z = static_cast<double>(p.z_m) - middle;
    const double r2 = x * x + z * z;
    const double turn = 4 * core * core / r2 * -std::expm1(-r2 / (core * core));
    p.vx_m_s = static_cast<float>(r2 < 1.44 ? turn * z : 0);
    p.vz_m_s = static_cast<float>(r2 < 1.44 ? -turn * x : 0);
  }
  const auto fluid = sim::make_simulation(scene, options);
  sim::EyeLook eye{{scene.view.eye_m, {0, 1, 0.2}, true}, sim::make_view(scene.view, 160, 120), nullptr};
  fluid->look({{eye}});
  for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
  return {fluid->explain(), fluid->particle_bytes(), fluid->read_state()};
}
bool same_bits(const State& a, const State& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

/// Mean level, by mass, of the water in the vortex's core, or of the water more than 1.8 m from its axis.
double mean_level(const State& state, bool in_core) {
  double sum = 0, all = 0;
  for (const auto& p : state) {
    const double r = std::hypot(static_cast<double>(p.x_m) - middle, static_cast<double>(p.z_m) - middle);
    if (in_core ? r > core : r < 1.8) continue;
    const double m = 1 << p.level;
    sum += m * p.level;
    all += m;
  }
  return sum / all;
}

void makes_a_vortex_finer_and_not_still_water(Backend backend) {
  for (const MethodKind method : {MethodKind::Ours, MethodKind::OursTsp}) {
    const State seen = run(tank_with(vorticity(1)), method, 24, backend).state;
    const State unseen = run(tank_with(vorticity(0)), method, 24, backend).state;
    EXPECT_LT(mean_level(seen, true), mean_level(unseen, true) - 0.25);
    EXPECT_GT(mean_level(seen, false), mean_level(unseen, false) - 0.2);
    EXPECT_LT(seen.size(), 1.05 * static_cast<double>(unseen.size()));
  }
}
TEST(SaliencyOfSwirl, MakesAVortexFinerAndNotStillWater) {
  NEEDS_EFFECTS;
  makes_a_vortex_finer_and_not_still_water(Backend::Cpu);
}
TEST(SaliencyOfSwirlGpu, MakesAVortexFinerAndNotStillWater) {
  NEEDS_EFFECTS;
  makes_a_vortex_finer_and_not_still_water(Backend::Cuda);
}

TEST(SaliencyOfSwirl, CostsNothingWhereItIsNotSeen) {
  NEEDS_EFFECTS;
  // Nothing reads the swirl if its weight in saliency is 0, or if the method has no saliency.
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    const bool sees = method.target == sim::TargetSource::Saliency;
    const Outcome seen = run(tank_with(vorticity(1)), method.kind, 4);
    const Outcome unseen = run(tank_with(vorticity(0)), method.kind, 4);
    EXPECT_THAT(unseen.explanation, HasSubstr("-  swirl               not called for"));
    EXPECT_EQ(seen.explanation.find("-  swirl") == std::string::npos, sees);
    EXPECT_EQ(seen.bytes > unseen.bytes, sees);
    EXPECT_EQ(same_bits(seen.state, unseen.state), !sees);
    // A coefficient of 0 turns the effect off.
    const Outcome bare = run(tank_with({}), method.kind, 4);
    const Outcome zero = run(tank_with(vorticity(1, 0)), method.kind, 4);
    EXPECT_TRUE(same_bits(bare.state, zero.state));
    EXPECT_EQ(bare.bytes, zero.bytes);
    EXPECT_THAT(zero.explanation, HasSubstr("-  swirl               dropped"));
  }
}

std::unique_ptr<sim::Simulation> dam(const std::vector<sim::Effect>& effects,
                                     const std::filesystem::path& resume_from = {}) {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.effects = effects;
  sim::SimulationOptions options;
  options.method = MethodKind::OursTsp;
  options.n_star = 64;
  options.temporal.fixed_tau = -6;
  options.resume_from = resume_from;
  return sim::make_simulation(scene, options);
}
void step(sim::Simulation& fluid, int frames) {
  for (int k = 0; k < frames; ++k) fluid.step_frame();
}

TEST(SaliencyOfSwirl, StandsInSavedStates) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  // Levels run in the first six frames and in every fourth later, among them 9 and 13.
  for (const int frames : {10, 11, 13}) {
    const auto fluid = dam(vorticity(5));
    step(*fluid, frames);
    fluid->save_state(folder / "state");
    const auto resumed = dam(vorticity(5), folder / "state");
    step(*fluid, 4);
    step(*resumed, 4);
    EXPECT_TRUE(same_bits(fluid->read_state(), resumed->read_state())) << frames;
  }
}

TEST(SaliencyOfSwirl, GoesWithItsEffectWhileTheWaterGoesOn) {
  NEEDS_EFFECTS;
  const auto bare = dam({}), turned = dam(vorticity(1));
  step(*turned, 6);
  EXPECT_EQ(turned->explain().find("-  swirl"), std::string::npos);
  const auto columns_of = [](const sim::Simulation& fluid) {
    const std::string all = fluid.explain();
    return all.substr(all.find("  columns:"));
  };
  EXPECT_NE(columns_of(*turned), columns_of(*bare));
  turned->set_effects({});
  step(*turned, 1);
  EXPECT_EQ(columns_of(*turned), columns_of(*bare));
  turned->set_effects(vorticity(1));
  step(*turned, 3);
  EXPECT_EQ(turned->explain().find("-  swirl"), std::string::npos);
}

}  // namespace
