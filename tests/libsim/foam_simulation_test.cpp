/// Foam in whole runs: its counts, its reproducibility, its file, and no influence on the water.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>
#include <filesystem>

#include "tests/common/needs_effects.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::EffectKind;
using sim::EffectOption;
using sim::MethodKind;
using testing::HasSubstr;

void set(sim::Effect& effect, EffectOption option, double value) {
  effect.options[static_cast<std::size_t>(option)] = value;
}

/// A dam of 1.2 m that makes much foam.
sim::Scene dam(double emission_per_s = 1) {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.viscosity_m2_s = 0.005;
  sim::Effect foam{EffectKind::Foam, emission_per_s};
  set(foam, EffectOption::FoamEnergyFrom, 0.2);
  set(foam, EffectOption::FoamEnergySpan, 2);
  set(foam, EffectOption::FoamDiameter, 0.03);
  set(foam, EffectOption::FoamLifetime, 0.3);
  set(foam, EffectOption::FoamMost, 2000);
  scene.effects = {foam};
  return scene;
}

sim::SimulationOptions options_of(Backend backend, MethodKind method) {
  sim::SimulationOptions out;
  out.backend = backend;
  out.method = method;
  out.n_star = 64;
  if (sim::traits_of(method).temporal) out.temporal.fixed_tau = -20;
  return out;
}

template <class T>
std::string bits(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string foam_of(const sim::Simulation& fluid) {
  std::vector<sim::RenderParticle> out;
  fluid.read_foam(out);
  return bits(out);
}
void run(sim::Simulation& fluid, int frames) {
  for (int k = 0; k < frames; ++k) fluid.step_frame();
}

void the_water_does_not_know_of_it(Backend backend) {
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    auto scene = dam();
    const auto with = sim::make_simulation(scene, options_of(backend, method.kind));
    scene.effects.clear();
    const auto without = sim::make_simulation(scene, options_of(backend, method.kind));
    run(*with, 50);
    run(*without, 50);
    EXPECT_EQ(bits(with->read_state()), bits(without->read_state()));
    const auto report = with->report().foam;
    EXPECT_GT(report.emitted, 500u);
    EXPECT_EQ(without->report().foam.emitted, 0u);
    EXPECT_EQ(without->foam_capacity(), 0);
    const bool some_rest = with->report().temporal.active < with->particle_count();
    EXPECT_EQ(some_rest, method.temporal);
  }
}
TEST(FoamInSimulations, TheWaterDoesNotKnowOfIt) {
  NEEDS_EFFECTS;
  the_water_does_not_know_of_it(Backend::Cpu);
}
TEST(FoamInSimulationsGpu, TheWaterDoesNotKnowOfIt) {
  NEEDS_EFFECTS;
  the_water_does_not_know_of_it(Backend::Cuda);
}

void the_books_close(Backend backend) {
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    auto scene = dam(4);
    scene.outlets = {{sim::Wall::HighX, {0.1, 0.1}, {0.9, 1.1}}};
    set(scene.effects[0], EffectOption::FoamMost, 300);
    const auto fluid = sim::make_simulation(scene, options_of(backend, method.kind));
    sim::FoamReport last;
    for (int frame = 0; frame < 8; ++frame) {
      run(*fluid, 12);
      last = fluid->report().foam;
      EXPECT_EQ(last.emitted,
                last.spray + last.foam + last.bubbles + last.dissolved + last.dropped + last.left);
      EXPECT_LE(last.spray + last.foam + last.bubbles, 300u);
    }
    EXPECT_GT(last.dissolved, 0u);
    EXPECT_GT(last.dropped, 0u);
    EXPECT_GT(last.left, 0u);
  }
}
TEST(FoamInSimulations, TheBooksCloseWithAFullPoolAndAnOutlet) {
  NEEDS_EFFECTS;
  the_books_close(Backend::Cpu);
}
TEST(FoamInSimulationsGpu, TheBooksCloseWithAFullPoolAndAnOutlet) {
  NEEDS_EFFECTS;
  the_books_close(Backend::Cuda);
}

TEST(FoamInSimulations, DoesNotDependOnTheNumberOfThreads) {
  NEEDS_EFFECTS;
  std::string by_threads[2];
  const int usual = omp_get_max_threads();
  for (int k = 0; k < 2; ++k) {
    omp_set_num_threads(k == 0 ? 1 : 3);
    const auto fluid = sim::make_simulation(dam(), options_of(Backend::Cpu, MethodKind::Ours));
    run(*fluid, 40);
    by_threads[k] = foam_of(*fluid);
  }
  omp_set_num_threads(usual);
  EXPECT_GT(by_threads[0].size(), 100 * sizeof(sim::RenderParticle));
  EXPECT_EQ(by_threads[0], by_threads[1]);
}

void goes_on_bit_for_bit(Backend backend) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("vip_foam_state_" + std::to_string(static_cast<int>(backend)));
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    auto options = options_of(backend, method.kind);
    const auto through = sim::make_simulation(dam(), options);
    run(*through, 33);
    through->save_state(path);
    options.resume_from = path;
    const auto resumed = sim::make_simulation(dam(), options);
    EXPECT_EQ(foam_of(*resumed), foam_of(*through));
    run(*through, 17);
    run(*resumed, 17);
    EXPECT_EQ(foam_of(*resumed), foam_of(*through));
    EXPECT_EQ(resumed->report().foam.emitted, through->report().foam.emitted);
    EXPECT_GT(foam_of(*through).size(), 100 * sizeof(sim::RenderParticle));
  }
  std::filesystem::remove(path);
}
TEST(FoamInSimulations, GoesOnBitForBitFromASavedState) {
  NEEDS_EFFECTS;
  goes_on_bit_for_bit(Backend::Cpu);
}
TEST(FoamInSimulationsGpu, GoesOnBitForBitFromASavedState) {
  NEEDS_EFFECTS;
  goes_on_bit_for_bit(Backend::Cuda);
}

TEST(FoamInSimulations, IsWhatProgramsRead) {
  NEEDS_EFFECTS;
  const auto fluid = sim::make_simulation(dam(), options_of(Backend::Cpu, MethodKind::HiRes));
  EXPECT_EQ(fluid->foam_capacity(), 2000);
  run(*fluid, 40);
  std::vector<sim::RenderParticle> foam;
  fluid->read_foam(foam);
  const auto report = fluid->report().foam;
  EXPECT_EQ(foam.size(), report.spray + report.foam + report.bubbles);
  for (const auto& particle : foam) {
    EXPECT_GT(particle.radius_m, 0);
    EXPECT_LE(particle.radius_m, 0.015f);
    EXPECT_GE(particle.x_m, 0);
    EXPECT_LE(particle.x_m, 2.4f);
  }
}

void stays_outside_obstacles(Backend backend) {
  for (const auto method : {MethodKind::HiRes, MethodKind::OursTsp}) {
    SCOPED_TRACE(sim::traits_of(method).name);
    auto scene = dam(4);
    sim::Obstacle post;
    post.shape = sim::ObstacleShape::Box;
    post.size_m = {0.4, 1.2, 0.4};
    post.start.centre_m = {1.45, 0.6, 0.6};
    sim::Obstacle paddle = post;
    paddle.size_m = {0.5, 0.4, 0.8};
    paddle.start.centre_m = {2.0, 0.4, 0.6};
    paddle.motion = sim::ObstacleMotion::Turns;
    paddle.about_m = paddle.start.centre_m;
    paddle.axis = {0, 0, 1};
    paddle.rate_rad_s = 3;
    scene.obstacles = {post, paddle};
    const auto fluid = sim::make_simulation(scene, options_of(backend, method));
    int near = 0;
    for (int k = 0; k < 8; ++k) {
      run(*fluid, 5);
      std::vector<sim::RenderParticle> foam;
      fluid->read_foam(foam);
      const auto poses = fluid->read_obstacles();
      for (const auto& x : foam) {
        double away = 1e9;
        for (std::size_t b = 0; b < poses.size(); ++b)
          away =
              std::min(away, sim::signed_distance(scene.obstacles[b], poses[b].pose, {x.x_m, x.y_m, x.z_m}));
        EXPECT_GT(away, -1e-4);
        near += away < 0.05;
      }
    }
    EXPECT_GT(near, 50);
  }
}
TEST(FoamInSimulations, StaysOutsideObstacles) {
  NEEDS_EFFECTS;
  stays_outside_obstacles(Backend::Cpu);
}
TEST(FoamInSimulationsGpu, StaysOutsideObstacles) {
  NEEDS_EFFECTS;
  stays_outside_obstacles(Backend::Cuda);
}

TEST(FoamInSimulations, AsksForNoShorterSubsteps) {
  NEEDS_EFFECTS;
  auto scene = dam();
  const auto explained = sim::make_simulation(scene, options_of(Backend::Cpu, MethodKind::HiRes))->explain();
  EXPECT_THAT(explained, HasSubstr("the scene lists emission_per_s = 1"));
  EXPECT_THAT(explained, HasSubstr("no shorter substeps"));
}

TEST(FoamInSimulations, ParticlesThatAreTooSmallAreAnErrorWithAMend) {
  NEEDS_EFFECTS;
  auto scene = dam(1e5);
  set(scene.effects[0], EffectOption::FoamDiameter, 1e-4);
  EXPECT_THAT([&] { sim::make_simulation(scene, options_of(Backend::Cpu, MethodKind::LoRes)); },
              testing::ThrowsMessage<base::Error>(
                  testing::AllOf(HasSubstr("effect foam"), HasSubstr("raise diameter_m"))));
}

}  // namespace
