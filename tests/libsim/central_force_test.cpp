/// A central force towards an axis: its table in a scene file, one particle against a closed form, a rotating
/// drop.

#include "libsim/scene/central_force.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;

std::string scene_with(const std::string& axis, const std::string& omega = "omega_per_s = 2.5") {
  return base::read_file(base::resource("data/scenes/peers_dam.toml"), 1 << 20) + "\n[central_force]\n" +
         omega + "\ncentre_m = [1.5, 1.0, 0.5]\naxis = " + axis + "\n";
}

TEST(CentralForce, IsReadFromASceneFile) {
  EXPECT_FALSE(sim::read_scene("data/scenes/peers_dam.toml").central_force);
  const auto scene = sim::parse_scene(scene_with("[0.0, 3.0, 4.0]"), "scene.toml");
  ASSERT_TRUE(scene.central_force);
  EXPECT_EQ(scene.central_force->omega_per_s, 2.5);
  EXPECT_EQ(scene.central_force->centre_m, (sim::Vec3d{1.5, 1, 0.5}));
  EXPECT_NEAR(scene.central_force->axis[1], 0.6, 1e-15);
  EXPECT_NEAR(scene.central_force->axis[2], 0.8, 1e-15);
  EXPECT_NEAR(sim::distance_from_axis(*scene.central_force, {4.5, 1 + 0.6, 0.5 + 0.8}), 3, 1e-12);
}

TEST(CentralForce, ErrorsNameThePlaceAndTheMend) {
  EXPECT_THAT(fluid_test::scene_error(scene_with("[0.0, 0.0, 0.0]")),
              testing::AllOf(testing::HasSubstr("axis"), testing::HasSubstr("has no direction")));
  EXPECT_THAT(fluid_test::scene_error(scene_with("[0.0, 1.0]")), testing::HasSubstr("axis"));
  EXPECT_THAT(fluid_test::scene_error(scene_with("[0.0, 0.0, 1.0]", "omega_per_s = 0.0")),
              testing::HasSubstr("out of range"));
  EXPECT_THAT(fluid_test::scene_error(scene_with("[0.0, 0.0, 1.0]", "omega = 1.0")),
              testing::HasSubstr("'central_force.omega_per_s' is missing"));
  EXPECT_THAT(fluid_test::scene_error(scene_with("[0.0, 0.0, 1.0]\nspeed = 1.0")),
              testing::HasSubstr("is not a known key"));
}

sim::Scene space(double omega, const sim::Vec3d& axis) {
  auto scene = fluid_test::tank({8, 8, 8}, {1.2, 1.2, 1.2});
  scene.gravity_m_s2 = 0;
  scene.central_force = sim::CentralForce{omega, {4, 4, 4}, axis};
  return scene;
}

void a_particle_swings(Backend backend) {
  constexpr double omega = 2;
  constexpr double amplitude = 3;
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = 64;
  options.substeps = 2;
  // 2 m above the centre along the axis, which adds no force.
  options.start = std::vector<ParticleState>{{0, 0, 4 + amplitude, 4, 6, 0, 0, 0}};
  const auto fluid = sim::make_simulation(space(omega, {0, 0, 1}), options);
  // v -= Omega^2 dt x, x += dt v has the solution x_n = A cos((n + 1/2) theta) / cos(theta / 2) with the
  // amplitude A.
  const double dt = 1.0 / 120;
  const double theta = 2 * std::asin(omega * dt / 2);
  EXPECT_NEAR(theta, omega * dt, 1e-5) << "the period is 2 pi / Omega but for the method's error";
  for (int frame = 1; frame <= 200; ++frame) {
    fluid->step_frame();
    const auto p = fluid->read_state()[0];
    const double expected = amplitude * std::cos((2 * frame + 0.5) * theta) / std::cos(theta / 2);
    ASSERT_NEAR(static_cast<double>(p.x_m) - 4, expected, 2e-4) << frame;
    ASSERT_EQ(p.y_m, 4) << frame;
    ASSERT_EQ(p.z_m, 6) << frame;
  }
  EXPECT_EQ(fluid->report().guards.speed_limited, 0u);
}
TEST(CentralForce, AParticleSwingsWithItsPeriod) { a_particle_swings(Backend::Cpu); }
TEST(CentralForceGpu, AParticleSwingsWithItsPeriod) { a_particle_swings(Backend::Cuda); }

/// Angular momentum about the y axis through (4, ., 4), over the mass of a particle of level 0, m2/s.
double angular_momentum(const std::vector<ParticleState>& state) {
  double sum = 0;
  for (const auto& p : state) {
    sum += (1 << p.level) * ((static_cast<double>(p.z_m) - 4) * static_cast<double>(p.vx_m_s) -
                             (static_cast<double>(p.x_m) - 4) * static_cast<double>(p.vz_m_s));
  }
  return sum;
}

void a_turning_drop_keeps_its_spin(Backend backend) {
  constexpr double d = 0.15;
  constexpr double omega = 2;
  constexpr double spin = 1;
  std::vector<ParticleState> start;
  for (int i = 0; i < 12 * 12 * 12; ++i) {
    const auto at = [](int k) { return d * (k - 5.5); };
    const double x = at(i % 12), y = at(i / 144), z = at(i / 12 % 12);
    if (x * x + z * z > 0.81) continue;
    start.push_back({static_cast<int>(start.size()), 0, static_cast<float>(4 + x), static_cast<float>(4 + y),
                     static_cast<float>(4 + z), static_cast<float>(spin * z), 0,
                     static_cast<float>(-spin * x)});
  }
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = 64;  // spacing d
  options.substeps = 4;
  options.start = start;
  const auto fluid = sim::make_simulation(space(omega, {0, 1, 0}), options);
  const double before = angular_momentum(start);
  for (int frame = 0; frame < 120; ++frame) fluid->step_frame();
  const double after = angular_momentum(fluid->read_state());
  std::printf("central force: angular momentum %.5f of the start's after 120 frames\n", after / before);
  // The pull acts at a substep's begin, the pressure at its end, dt later in the rotation: the supported
  // water speeds up by at most Omega^2 dt a second.
  EXPECT_NEAR(after / before, 1, omega * omega * (1.0 / 240) * 2);
}
TEST(CentralForce, ATurningDropKeepsItsSpin) { a_turning_drop_keeps_its_spin(Backend::Cpu); }
TEST(CentralForceGpu, ATurningDropKeepsItsSpin) { a_turning_drop_keeps_its_spin(Backend::Cuda); }

}  // namespace
