/// Force of water at rest on a fixed sphere: rho g V upwards (Archimedes), at every level of particles.

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

struct Sunk {
  MethodKind method = MethodKind::HiRes;
  std::int64_t n_star = 512;
  double radius = 0.25;
  double height = 0.5;  ///< height of its centre, m
  bool mixed = false;   ///< level 0 on one side, 3 on the other
  double beta = 1;
  Backend backend = Backend::Cpu;
  int rest_frames = 60;  ///< frames before the force is measured
};

/// Mean force of the water on the sphere over a second, over rho g V.
Vec3d force_on(const Sunk& sunk) {
  auto scene = fluid_test::tank({1, 1.5, 1}, {1, 1, 1}, 60);
  scene.v_ref_m_s = 3;
  sim::Obstacle sphere;
  sphere.radius_m = sunk.radius;
  sphere.start.centre_m = {0.5, sunk.height, 0.5};
  scene.obstacles = {sphere};
  sim::SimulationOptions options;
  options.backend = sunk.backend;
  options.method = sunk.method;
  options.n_star = sunk.n_star;
  options.wall_impulse = true;
  if (sunk.mixed) options.forced_targets = sim::TargetRegion{{0, 0.5, 0.5}, 0.5, 0, 3};
  rest_at(sunk.beta, options);
  const auto fluid = sim::make_simulation(scene, options);
  Vec3d sum{};
  constexpr int frames = 60;
  for (int frame = 0; frame < sunk.rest_frames + frames; ++frame) {
    fluid->step_frame();
    if (frame < sunk.rest_frames) continue;
    const auto account = fluid->momentum();
    for (std::size_t k = 0; k < 3; ++k) sum[k] -= account.obstacles.at(0).push[k];
    if (sunk.beta < 1) continue;
    EXPECT_NEAR(account.unattributed[1], 0, 0.01) << "what the obstacle gave is counted, N s";
  }
  const double lift = 1000 * scene.gravity_m_s2.size() * sim::volume_m3(sphere);
  for (double& part : sum) part /= frames * scene.frame_dt_s * lift;
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  for (const auto& p : fluid->read_state())
    EXPECT_GE(sim::signed_distance(sphere, sphere.start, place(p)), 0) << p.id;
  return sum;
}

/// The calming of still water lets the water come to rest later: in the second second its force is still 1.06
/// of rho g V. So the test measures after three seconds.
void feels_its_displaced_water(Sunk sunk) {
  sunk.rest_frames = 180;
  const Vec3d force = force_on(sunk);
  // With temporal acceleration the force is larger: 1.01, 1.04 and 1.06 at level 3 with beta (the lowest
  // probability that a particle is solved) 1, 0.8 and 0.67.
  EXPECT_NEAR(force[1], 1, sunk.beta < 1 ? 0.08 : 0.05);
  EXPECT_NEAR(force[0], 0, 0.05);
  EXPECT_NEAR(force[2], 0, 0.05);
}

constexpr Sunk finest{};
constexpr Sunk coarsest{.method = MethodKind::LoRes, .n_star = 4096};
constexpr Sunk both{.method = MethodKind::Ours, .n_star = 2048, .radius = 0.3, .mixed = true};
Sunk with(Sunk sunk, double beta, Backend backend) {
  sunk.beta = beta;
  sunk.backend = backend;
  return sunk;
}

TEST(SunkSphere, FeelsItsDisplacedWaterAtLevel0) { feels_its_displaced_water(finest); }
TEST(SunkSphere, FeelsItsDisplacedWaterAtLevel3) { feels_its_displaced_water(coarsest); }
TEST(SunkSphere, FeelsItsDisplacedWaterAtMixedLevels) { feels_its_displaced_water(both); }
TEST(SunkSphere, FeelsItsDisplacedWaterWithTemporalAcceleration) {
  feels_its_displaced_water(with(finest, 0.67, Backend::Cpu));
}
/// The water level is some 2 % low, which is 3 % of the submerged half.
void is_carried_by_its_half_below(Sunk sunk) {
  sunk.height = 1;
  const double share = force_on(sunk)[1] / 0.5;
  EXPECT_GE(share, 0.65);
  EXPECT_LE(share, 1.05);
}
TEST(SunkSphere, StandsOutOfTheWaterAtLevel0) { is_carried_by_its_half_below(finest); }
TEST(SunkSphere, StandsOutOfTheWaterAtLevel3) { is_carried_by_its_half_below(coarsest); }
TEST(SunkSphere, StandsOutOfTheWaterAtMixedLevels) { is_carried_by_its_half_below(both); }

/// A box across the tank on the floor, with water on one side.
void holds_the_water(MethodKind method, std::int64_t n_star, Backend backend = Backend::Cpu) {
  auto scene = fluid_test::tank({2, 1.5, 1}, {0.8, 1, 1}, 60);
  scene.v_ref_m_s = 3;
  sim::Obstacle dam;
  dam.shape = sim::ObstacleShape::Box;
  dam.size_m = {0.4, 1.4, 1};
  dam.start.centre_m = {1, 0.7, 0.5};
  scene.obstacles = {dam};
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = n_star;
  options.wall_impulse = true;
  const auto fluid = sim::make_simulation(scene, options);
  double thrust = 0, lift = 0, squares = 0;
  constexpr int frames = 90, settled = 60;
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    const State state = fluid->read_state();
    for (const auto& p : state)
      ASSERT_GE(sim::signed_distance(dam, dam.start, place(p)), -1e-6) << "frame " << frame << ", " << p.id;
    if (frame < settled) continue;
    const Vec3d push = fluid->momentum().obstacles.at(0).push;
    thrust -= push[0];
    lift -= push[1];
    squares += mean(state, [](auto& p) {
      const Vec3d v = velocity(p);
      return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    });
  }
  // Theory: rho g H^2 / 2 per metre.
  const double given = 0.5 * 1000 * scene.gravity_m_s2.size() * (frames - settled) * scene.frame_dt_s;
  EXPECT_NEAR(thrust / given, 1, 0.15);
  EXPECT_NEAR(lift / given, 0, 0.15) << "its face is upright";
  EXPECT_LE(std::sqrt(squares / (frames - settled)), 0.07) << "m/s";
}
TEST(Dam, HoldsTheWaterAtLevel0) { holds_the_water(MethodKind::HiRes, 512); }
TEST(Dam, HoldsTheWaterAtLevel3) { holds_the_water(MethodKind::LoRes, 2048); }
TEST(Dam, HoldsTheWaterAtMixedLevels) { holds_the_water(MethodKind::Ours, 2048); }
TEST(DamGpu, HoldsTheWater) {
  for (const auto method : {MethodKind::HiRes, MethodKind::LoRes, MethodKind::Ours}) {
    SCOPED_TRACE(sim::method_name(method));
    holds_the_water(method, method == MethodKind::HiRes ? 512 : 2048, Backend::Cuda);
  }
}

TEST(SunkSphereGpu, FeelsItsDisplacedWater) {
  for (const double beta : {1.0, 0.67}) {
    for (const Sunk& sunk : {finest, coarsest, both}) {
      SCOPED_TRACE(testing::Message() << sim::method_name(sunk.method) << " at beta " << beta);
      feels_its_displaced_water(with(sunk, beta, Backend::Cuda));
    }
  }
}

}  // namespace
