/// The first trouble of a run is reported with its frame, particle and cause, and does not spread.

#include <gmock/gmock.h>

#include <limits>

#include "stats/base/error.hpp"
#include "tests/libsim/obstacle_scenes.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;
using sim::Trouble;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
const sim::Vec3d pool_tank{8 * d, 2, 8 * d};

/// 512 particles that fill their tank's floor, after ten frames.
std::unique_ptr<sim::Simulation> pool(Backend backend) {
  auto fluid = start_from(backend, fluid_test::tank(pool_tank, pool_tank), block(8, 8, 8, {0, 0, 0}));
  for (int frame = 0; frame < 10; ++frame) fluid->step_frame();
  EXPECT_FALSE(fluid->divergence());
  return fluid;
}

/// 99th percentiles of the deviations from an undisturbed twin, of the particles first .. last except `but`.
/// The paths of the remaining 1 % are chaotic.
struct Harm {
  double way_m = 0, speed_m_s = 0;
};

Harm harm(const sim::Simulation& fluid, const sim::Simulation& twin, int but = -1, int first = 0,
          int last = 511) {
  const auto a = fluid.read_state(), b = twin.read_state();
  std::vector<double> way, speed;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    if (a[i].id < first || a[i].id > last || a[i].id == but) continue;
    const auto apart = [](float x, float y, float z) {
      const double sum = std::hypot(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
      return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
    };
    way.push_back(apart(a[i].x_m - b[i].x_m, a[i].y_m - b[i].y_m, a[i].z_m - b[i].z_m));
    speed.push_back(apart(a[i].vx_m_s - b[i].vx_m_s, a[i].vy_m_s - b[i].vy_m_s, a[i].vz_m_s - b[i].vz_m_s));
  }
  std::sort(way.begin(), way.end());
  std::sort(speed.begin(), speed.end());
  const std::size_t rank = way.size() * 99 / 100;
  std::printf("off the twin: 99 %% by %.4f d, %.3f m/s; one by %.4f d, %.3f m/s\n", way[rank] / d,
              speed[rank], way.back() / d, speed.back());
  return {way[rank], speed[rank]};
}

void expect_first(const sim::Simulation& fluid, Trouble cause, int particle, int frame) {
  const auto found = fluid.divergence();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cause, cause) << sim::in_words(*found);
  EXPECT_EQ(found->particle, particle);
  EXPECT_EQ(found->frame, frame);
}

void a_lost_velocity(Backend backend) {
  const auto fluid = pool(backend), twin = pool(backend);
  auto particle = fluid->read_state()[100];
  particle.vx_m_s = nan_value;
  fluid->put({particle});
  fluid->step_frame();
  twin->step_frame();
  expect_first(*fluid, Trouble::NotFinite, 100, 11);
  EXPECT_EQ(fluid->divergence()->count, 1u);
  const auto where = fluid->divergence()->where_m;
  ASSERT_TRUE(where);
  EXPECT_NEAR((*where)[0], static_cast<double>(particle.x_m), 0.1 * d);
  EXPECT_NEAR((*where)[1], static_cast<double>(particle.y_m), 0.1 * d);
  EXPECT_NEAR((*where)[2], static_cast<double>(particle.z_m), 0.1 * d);
  const Harm first = harm(*fluid, *twin);
  EXPECT_LT(first.way_m, 0.05 * d);
  EXPECT_LT(first.speed_m_s, 0.2);
  // The first trouble remains the reported one.
  particle = fluid->read_state()[7];
  particle.y_m = nan_value;
  fluid->put({particle});
  fluid->step_frame();
  expect_first(*fluid, Trouble::NotFinite, 100, 11);
  EXPECT_EQ(fluid->divergence()->count, 2u);
}
TEST(Divergence, ALostVelocityIsFoundInItsFrame) { a_lost_velocity(Backend::Cpu); }
TEST(DivergenceGpu, ALostVelocityIsFoundInItsFrame) { a_lost_velocity(Backend::Cuda); }

void a_lost_place(Backend backend) {
  const auto fluid = pool(backend), twin = pool(backend);
  std::vector<ParticleState> lost;
  for (const std::size_t id : {300u, 100u, 200u}) {
    lost.push_back(fluid->read_state()[id]);
    lost.back().z_m = std::numeric_limits<float>::infinity();
  }
  // Trouble found before the guard on speed is reported first, whatever its particle.
  lost.push_back(fluid->read_state()[50]);
  lost.back().vx_m_s = 1000;
  fluid->put(lost);
  fluid->step_frame();
  expect_first(*fluid, Trouble::NotFinite, 100, 11);
  ASSERT_TRUE(fluid->divergence()->where_m);
  EXPECT_NEAR((*fluid->divergence()->where_m)[1], pool_tank[1], d) << "the refuge at the tank's top";
}
TEST(Divergence, TheLowestOfSeveralIsNamed) { a_lost_place(Backend::Cpu); }
TEST(DivergenceGpu, TheLowestOfSeveralIsNamed) { a_lost_place(Backend::Cuda); }

void a_place_far_outside(Backend backend) {
  const auto fluid = pool(backend);
  auto far = fluid->read_state()[100];
  far.x_m = 1e4f;
  fluid->put({far});
  fluid->step_frame();
  expect_first(*fluid, Trouble::FarOutside, 100, 11);
  ASSERT_TRUE(fluid->divergence()->where_m);
  EXPECT_NEAR((*fluid->divergence()->where_m)[1], pool_tank[1], d) << "the refuge at the tank's top";
  EXPECT_EQ(fluid->divergence()->count, 1u);
}
TEST(Divergence, APlaceFarOutsideIsNamed) { a_place_far_outside(Backend::Cpu); }
TEST(DivergenceGpu, APlaceFarOutsideIsNamed) { a_place_far_outside(Backend::Cuda); }

void a_bullet(Backend backend) {
  const auto fluid = pool(backend), twin = pool(backend);
  constexpr int id = 292;
  auto particle = fluid->read_state()[id];
  particle.vy_m_s = 1000;
  fluid->put({particle});
  fluid->step_frame();
  twin->step_frame();
  expect_first(*fluid, Trouble::TooFast, id, 11);
  // The guard reduces 1,000 m/s to three times the speed of a fall, 14.6 m/s; the particles that it strikes
  // get a part of that.
  const Harm struck = harm(*fluid, *twin, id);
  EXPECT_LT(struck.speed_m_s, 3 * std::sqrt(2 * gravity * 8 * d));
  for (int frame = 0; frame < 60; ++frame) {
    fluid->step_frame();
    twin->step_frame();
  }
  const auto state = fluid->read_state();
  EXPECT_EQ(fluid_test::outside(state, pool_tank, 0), 0);
  const double lift = fluid_test::centre_height(state) - fluid_test::centre_height(twin->read_state());
  std::printf("a second later the centre is %.3f d higher, v_rms %.3f m/s\n", lift / d,
              fluid_test::rms_speed(state));
  EXPECT_LT(fluid_test::rms_speed(state), 0.7);
}
TEST(Divergence, ABulletIsBrakedAndNamed) { a_bullet(Backend::Cpu); }
TEST(DivergenceGpu, ABulletIsBrakedAndNamed) { a_bullet(Backend::Cuda); }

/// A pool at one end of a tank, and a thousand more particles far away, with ids from 512 on.
std::unique_ptr<sim::Simulation> pool_and_crowd(Backend backend, const sim::SimulationOptions& options = {}) {
  auto start = block(8, 8, 8, {0, 0, 0});
  for (auto p : block(10, 10, 10, {6, 1, 0.2})) {
    p.id += 512;
    start.push_back(p);
  }
  auto fluid = start_from(backend, fluid_test::tank({8, 4, 2}, {8, 1, 2}), start, options);
  for (int frame = 0; frame < 5; ++frame) fluid->step_frame();
  EXPECT_FALSE(fluid->divergence());
  return fluid;
}

void a_crowd(Backend backend) {
  const auto fluid = pool_and_crowd(backend), twin = pool_and_crowd(backend);
  std::vector<ParticleState> crowd;
  for (int i = 0; i < 1000; ++i) crowd.push_back({512 + i, 0, 6.5f, 2, 1, 0, 0, 0});
  fluid->put(crowd);
  fluid->step_frame();
  twin->step_frame();
  expect_first(*fluid, Trouble::Coincident, 512, 6);
  EXPECT_GE(fluid->divergence()->count, 1000u * 999u);
  ASSERT_TRUE(fluid->divergence()->where_m);
  EXPECT_NEAR((*fluid->divergence()->where_m)[0], 6.5, 1);
  for (int frame = 0; frame < 4; ++frame) {
    fluid->step_frame();
    twin->step_frame();
  }
  const Harm pool = harm(*fluid, *twin);
  // The fast crowd shortens the substeps. In short substeps more of the water counts as still: the pool moved
  // by 0.054 d.
  EXPECT_LT(pool.way_m, 0.08 * d);
  // Without the limit on the displacement of slowed particles, some arrived in the pool at once: 5.4 d and
  // 6.5 m/s.
  EXPECT_LT(pool.speed_m_s, 0.5);
}
TEST(Divergence, AThousandInOnePlaceAreNamedAndHarmNobodyFar) { a_crowd(Backend::Cpu); }
TEST(DivergenceGpu, AThousandInOnePlaceAreNamedAndHarmNobodyFar) { a_crowd(Backend::Cuda); }

void a_squeeze(Backend backend) {
  // With one projection a frame the density stays as it was put.
  sim::SimulationOptions options;
  options.substeps = 1;
  options.iterations = 1;
  options.coarse_cycles = 0;
  const auto fluid = pool_and_crowd(backend, options);
  auto crowd = block(10, 10, 10, {0, 0, 0});
  for (auto& p : crowd) {
    p.id += 512;
    p.x_m = 6 + 0.85f * p.x_m;
    p.y_m = 2 + 0.85f * p.y_m;
    p.z_m = 0.3f + 0.85f * p.z_m;
  }
  fluid->put(crowd);
  fluid->step_frame();
  const auto found = fluid->divergence();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cause, Trouble::TooDense) << sim::in_words(*found);
  EXPECT_EQ(found->frame, 6);
  EXPECT_GE(found->particle, 512);
}
TEST(Divergence, WaterFarTooDenseIsNamed) { a_squeeze(Backend::Cpu); }
TEST(DivergenceGpu, WaterFarTooDenseIsNamed) { a_squeeze(Backend::Cuda); }

void more_than_the_store_holds(Backend backend) {
  std::vector<ParticleState> crowd;
  for (int i = 0; i < 1500; ++i) crowd.push_back({i, 0, 1, 1, 1, 0, 0, 0});
  const auto fluid = start_from(backend, fluid_test::tank({2, 2, 2}, {1, 1, 1}), crowd);
  fluid->step_frame();
  const auto found = fluid->divergence();
  ASSERT_TRUE(found);
  // The order of the threads decides which particle finds no room in the store.
  EXPECT_EQ(found->cause, Trouble::NeighboursDropped) << sim::in_words(*found);
  EXPECT_EQ(found->frame, 1);
}
TEST(Divergence, NeighboursWithoutRoomAreNamed) { more_than_the_store_holds(Backend::Cpu); }
TEST(DivergenceGpu, NeighboursWithoutRoomAreNamed) { more_than_the_store_holds(Backend::Cuda); }

void sound_runs_have_none(Backend backend, std::int64_t n_star, int frames) {
  const auto scene = sim::read_scene("data/scenes/peers_dam.toml");
  for (const auto method : {sim::MethodKind::LoRes, sim::MethodKind::HiRes, sim::MethodKind::FovFluid,
                            sim::MethodKind::Ours, sim::MethodKind::OursTsp}) {
    sim::SimulationOptions options;
    options.n_star = n_star;
    options.method = method;
    options.backend = backend;
    const auto fluid = sim::make_simulation(scene, options);
    for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
    const auto found = fluid->divergence();
    EXPECT_FALSE(found) << sim::method_name(method) << ": " << (found ? sim::in_words(*found) : "");
  }
}
TEST(Divergence, SoundRunsHaveNone) { sound_runs_have_none(Backend::Cpu, 128, 30); }
TEST(DivergenceGpu, SoundRunsHaveNone) { sound_runs_have_none(Backend::Cuda, 4096, 120); }

/// A box 1 m wide swings into a pool 1.2 m wide, and presses water out through gaps of 0.1 m beside it, at
/// more than three times the box's largest speed.
void a_stamp(Backend backend) {
  auto scene = fluid_test::tank({1.2, 1.6, 1.2}, {1.2, 0.4, 1.2}, 30);
  scene.v_ref_m_s = 8;
  scene.viscosity_m2_s = 0.001;
  auto stamp = obstacle_test::box({0.6, 0.8, 0.6}, {1, 0.3, 1});
  stamp.motion = sim::ObstacleMotion::Swings;
  stamp.way_m = {0, -0.55, 0};
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = 512;
  for (const double period_s : {0.5, 1.0}) {
    stamp.period_s = period_s;
    scene.obstacles = {stamp};
    const auto fluid = sim::make_simulation(scene, options);
    double fastest = 0;
    for (int frame = 0; frame < 30; ++frame) {
      fluid->step_frame();
      fastest = std::max(fastest, fluid->report().speed_max_m_s);
    }
    const auto found = fluid->divergence();
    EXPECT_FALSE(found) << sim::in_words(*found);
    EXPECT_GT(fastest, 3 * sim::top_speed(stamp)) << "or the scene squeezes nothing";
  }
}
TEST(Divergence, WaterThatAStampSqueezesOutIsNotBraked) { a_stamp(Backend::Cpu); }
TEST(DivergenceGpu, WaterThatAStampSqueezesOutIsNotBraked) { a_stamp(Backend::Cuda); }

TEST(Divergence, IsSaidInWords) {
  sim::Divergence found{.frame = 12, .particle = 40, .cause = Trouble::NotFinite, .where_m = {}, .count = 3};
  EXPECT_EQ(sim::in_words(found), "frame 12, particle 40 is not finite; 3 cases so far");
  found.where_m = sim::Vec3d{1.2, 0.31, -0.0004};
  found.cause = Trouble::Coincident;
  found.count = 1;
  EXPECT_EQ(sim::in_words(found),
            "frame 12, particle 40 at (1.200, 0.310, -0.000) m has the same position as another particle; 1 "
            "case so far");
}

TEST(Divergence, NobodyIsPutWhoIsNotThere) {
  const auto fluid = pool(Backend::Cpu);
  EXPECT_THROW(fluid->put({{512, 0, 0, 0, 0, 0, 0, 0}}), base::Error);
}

}  // namespace
