/// What water at rest does to a fixed sphere in it: rho g V upwards (Archimedes), whatever the particles.

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

struct Sunk {
  MethodKind method = MethodKind::HiRes;
  std::int64_t n_star = 512;
  double radius = 0.25;
  double height = 0.5;
  bool mixed = false;  ///< level 0 on one side, 3 on the other
  double beta = 1;
  Backend backend = Backend::Cpu;
};

/// Mean force of the water on the sphere over the second of two seconds, over rho g V.
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
  if (sunk.beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(sunk.beta) / (2 * 0.02);  // beta = exp(2 b tau)
  }
  const auto fluid = sim::make_simulation(scene, options);
  Vec3d sum{};
  constexpr int frames = 60;
  for (int frame = 0; frame < 2 * frames; ++frame) {
    fluid->step_frame();
    if (frame < frames) continue;
    const auto account = fluid->momentum();
    for (std::size_t k = 0; k < 3; ++k) sum[k] -= account.obstacles.at(0).push[k];
    if (sunk.beta < 1) continue;
    EXPECT_NEAR(account.unattributed[1], 0, 0.01) << "what the obstacle gave is counted, N s";
  }
  const double lift = 1000 * scene.gravity_m_s2 * sim::volume_m3(sphere);
  for (double& part : sum) part /= frames * scene.frame_dt_s * lift;
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  for (const auto& p : fluid->read_state())
    EXPECT_GE(sim::signed_distance(sphere, sphere.start, place(p)), 0) << p.id;
  return sum;
}

void feels_its_displaced_water(const Sunk& sunk) {
  const Vec3d force = force_on(sunk);
  EXPECT_NEAR(force[1], 1, 0.05);
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
TEST(SunkSphereGpu, FeelsItsDisplacedWater) {
  for (const double beta : {1.0, 0.67}) {
    for (const Sunk& sunk : {finest, coarsest, both}) {
      SCOPED_TRACE(testing::Message() << sim::method_name(sunk.method) << " at beta " << beta);
      feels_its_displaced_water(with(sunk, beta, Backend::Cuda));
    }
  }
}

}  // namespace
namespace {
TEST(TmpPartition, Measures) {
  for (const auto method : {MethodKind::HiRes, MethodKind::LoRes, MethodKind::Ours}) {
    auto scene = fluid_test::tank({2, 1.5, 1}, {0.8, 1, 1}, 60);
    scene.v_ref_m_s = 3;
    sim::Obstacle box;
    box.shape = sim::ObstacleShape::Box;
    box.size_m = {0.4, 1.4, 1.0};
    box.start.centre_m = {1.0, 0.7, 0.5};
    scene.obstacles = {box};
    sim::SimulationOptions options;
    options.method = method;
    options.n_star = method == MethodKind::HiRes ? 512 : 2048;
    options.wall_impulse = true;
    const auto fluid = sim::make_simulation(scene, options);
    double thrust = 0, lift = 0, left = 0;
    int over = 0;
    double stir = 0, near_body = 0, near_wall = 0, top = 0, n = 0;
    for (int frame = 0; frame < 120; ++frame) {
      fluid->step_frame();
      if (frame < 60) continue;
      const auto account = fluid->momentum();
      thrust -= account.obstacles.at(0).push[0];
      lift -= account.obstacles.at(0).push[1];
      left += account.walls.at(0).sum();
      const auto state = fluid->read_state();
      over = 0;
      for (const auto& p : state) {
        const auto at = place(p);
        const auto v = velocity(p);
        over += at[0] > 1.0;
        stir += v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        n += 1;
        top = std::max(top, at[1]);
        if (at[0] > 0.66) near_body += mass(p);
        if (at[0] < 0.14) near_wall += mass(p);
      }
    }
    const double given = 0.5 * 1000 * 9.81 * 60 * scene.frame_dt_s;
    std::printf("%s thrust %.3f lift %.3f left %.3f over %d stir %.4f near body/wall %.4f top %.3f n %.0f\n",
                std::string(sim::method_name(method)).c_str(), thrust / given, lift / given, left / given,
                over, std::sqrt(stir / n), near_body / near_wall, top, n / 60);
  }
}
TEST(TmpPartSunk, Measures) {
  for (const Sunk& sunk : {finest, coarsest, both})
    for (const double radius : {0.2, 0.25})
      for (const double height : {0.5, 0.85, 1.0, 1.1}) {
        Sunk now = sunk;
        now.radius = radius;
        now.height = height;
        const double dip = std::clamp((1 + 0.0 - (height - radius)) / (2 * radius), 0.0, 1.0);
        const auto f = force_on(now);
        std::printf("%d R %.2f height %.2f share %.3f force %.3f over %.3f side %.3f\n", int(sunk.method), radius, height,
                    dip * dip * (3 - 2 * dip), f[1], f[1] / (dip * dip * (3 - 2 * dip)), f[0]);
      }
}
}  // namespace
