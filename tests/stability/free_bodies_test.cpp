/// Bodies much lighter than water: the water that moves along has most of the inertia, so a body that reacts
/// to its push at once becomes unstable.

#include "tests/stability/stability_helpers.hpp"

namespace {

/// A ball of this density falls into a pool.
void comes_to_float(sim::MethodKind method, double density, sim::Backend backend) {
  auto scene = fluid_test::tank({1, 2, 1}, {1, 0.75, 1}, 20);
  scene.v_ref_m_s = 3;
  sim::Obstacle ball;
  ball.radius_m = 0.25;
  ball.start.centre_m = {0.5, 1.25, 0.5};
  ball.motion = sim::ObstacleMotion::Free;
  ball.density_kg_m3 = density;
  scene.obstacles = {ball};
  sim::SimulationOptions options;
  options.method = method;
  options.backend = backend;
  options.n_star = 256;
  if (method == sim::MethodKind::OursTsp) options.temporal.fixed_tau = -10;
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 240; ++frame) {
    fluid->step_frame();
    const auto now = fluid->read_obstacles().at(0);
    ASSERT_TRUE(std::isfinite(now.pose.centre_m[1])) << frame;
    ASSERT_LT(now.pose.centre_m[1], 1.2501) << frame << ": it rises no higher than it fell from";
    for (const std::size_t side : {0, 2}) {
      EXPECT_GE(now.pose.centre_m[side], 0.25 - 1e-4) << frame;
      EXPECT_LE(now.pose.centre_m[side], 0.75 + 1e-4) << frame;
    }
  }
  const auto last = fluid->read_obstacles().at(0);
  EXPECT_NEAR(last.velocity_m_s[1], 0, 0.3);
  EXPECT_GT(last.pose.centre_m[1], 0.75) << "it floats";
  EXPECT_LT(last.pose.centre_m[1], 1.1);
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
}

TEST(LightBodies, ComeToFloat) {
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::LoRes, sim::MethodKind::OursTsp}) {
    for (const double density : {50.0, 100.0}) {
      SCOPED_TRACE(sim::method_name(method) + std::string(", ") + std::to_string(density));
      comes_to_float(method, density, sim::Backend::Cpu);
    }
  }
}
TEST(LightBodiesGpu, ComeToFloat) {
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::LoRes, sim::MethodKind::OursTsp}) {
    SCOPED_TRACE(sim::method_name(method));
    comes_to_float(method, 100, sim::Backend::Cuda);
  }
}

}  // namespace
