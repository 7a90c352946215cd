/// Splitting and merging (paper 3.3), on the CPU and, with suites that end in Gpu, on CUDA: mass, momentum,
/// stability, hysteresis, capacity.

#include <gtest/gtest.h>

#include <omp.h>

#include <array>
#include <random>
#include <set>

#include "libsim/methods/preset.hpp"
#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;

constexpr double d = 0.15;      // finest spacing
constexpr double far_m = 1000;  // holds everything
constexpr double gravity = 9.81;

sim::TargetRegion everywhere(int level) { return {{0, 0, 0}, far_m, level, level}; }

/// Options for a block of 8 n_* particles of level 0 whose targets the test gives.
sim::SimulationOptions options_for(Backend backend, std::int64_t n_star, sim::TargetRegion targets) {
  sim::SimulationOptions out;
  out.method = sim::MethodKind::Ours;
  out.backend = backend;
  out.n_star = n_star;
  out.forced_targets = targets;
  return out;
}

std::int64_t mass_units(const std::vector<ParticleState>& state) {
  std::int64_t sum = 0;
  for (const auto& p : state) sum += std::int64_t{1} << p.level;
  return sum;
}

/// Total momentum over m_*, m/s.
std::array<double, 3> momentum(const std::vector<ParticleState>& state) {
  std::array<double, 3> sum{};
  for (const auto& p : state) {
    const double m = 1 << p.level;
    sum[0] += m * static_cast<double>(p.vx_m_s);
    sum[1] += m * static_cast<double>(p.vy_m_s);
    sum[2] += m * static_cast<double>(p.vz_m_s);
  }
  return sum;
}

double mass_centre_height(const std::vector<ParticleState>& state) {
  double sum = 0;
  for (const auto& p : state) sum += static_cast<double>(p.y_m) * (1 << p.level);
  return sum / static_cast<double>(mass_units(state));
}

double share_at(const sim::FrameReport& report, std::size_t level) {
  if (report.particles_by_level.size() <= level) return 0;
  return static_cast<double>(report.particles_by_level[level] << level) /
         static_cast<double>(report.mass_units);
}

/// The ledger closes, the mass is what it was, ids are unique.
void expect_sound(sim::Simulation& fluid, std::int64_t start, std::int64_t mass) {
  const auto report = fluid.report();
  const auto state = fluid.read_state();
  EXPECT_EQ(report.particles, static_cast<std::int64_t>(state.size()));
  EXPECT_EQ(report.particles, start + static_cast<std::int64_t>(report.levels.born) -
                                  static_cast<std::int64_t>(report.levels.merges));
  EXPECT_EQ(mass_units(state), mass);
  EXPECT_EQ(report.mass_units, mass);
  EXPECT_LE(report.particles, fluid.particle_capacity());
  std::set<int> ids;
  for (const auto& p : state) {
    ids.insert(p.id);
    ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.z_m + p.vx_m_s + p.vy_m_s + p.vz_m_s)) << p.id;
  }
  EXPECT_EQ(ids.size(), state.size());
}

/// Tank of 10 x 12 x 10 finest spacings of settled water, twice as high, and its state.
struct Settled {
  sim::Scene scene = fluid_test::tank({12 * d, 30 * d, 12 * d}, {12 * d, 16 * d, 12 * d}, 60);
  static constexpr std::int64_t n_star = 288;  // 2,304 particles
  std::vector<ParticleState> state;

  explicit Settled(Backend backend) {
    sim::SimulationOptions options;
    options.n_star = n_star;
    options.backend = backend;
    state = sim::make_simulation(scene, options)->read_state();
  }
};

void tank_coarsens(Backend backend) {
  const Settled tank(backend);
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = tank.state;
  const auto fluid = sim::make_simulation(tank.scene, options);
  double densest = 0;
  double jumps = 0;
  int reached = -1;
  for (int frame = 1; frame <= 120; ++frame) {
    fluid->step_frame();
    const auto report = fluid->report();
    densest = std::max(densest, report.density_max);
    jumps = std::max(jumps, report.jump_share);
    if (reached < 0 && share_at(report, 3) >= 0.9) reached = frame;
    if (frame % 20 == 0) {
      std::printf(
          "coarsening, frame %d: %lld particles, mass at levels %.3f %.3f %.3f %.3f, max rho %.3f, jumps "
          "%.4f\n",
          frame, static_cast<long long>(report.particles), share_at(report, 0), share_at(report, 1),
          share_at(report, 2), share_at(report, 3), report.density_max, report.jump_share);
    }
  }
  const auto last = fluid->report();
  std::printf(
      "coarsening: 90 %% of the mass at level 3 in frame %d, max rho %.3f, largest share of jumps %.4f, "
      "refused: overlap %llu, step %llu\n",
      reached, densest, jumps, static_cast<unsigned long long>(last.levels.merge_overlap),
      static_cast<unsigned long long>(last.levels.merge_step));
  EXPECT_GE(share_at(last, 3), 0.9);
  EXPECT_LT(densest, 1.25);
  expect_sound(*fluid, 8 * Settled::n_star, 8 * Settled::n_star);
  EXPECT_EQ(fluid_test::outside(fluid->read_state(), tank.scene.tank_size_m, 0.1 * d), 0);
}
TEST(Levels, UniformTankCoarsens) { tank_coarsens(Backend::Cpu); }
TEST(LevelsGpu, UniformTankCoarsens) { tank_coarsens(Backend::Cuda); }

/// Potential energy over m_* g, m, and kinetic over m_*, m2/s2.
double energy(const std::vector<ParticleState>& state) {
  double sum = 0;
  for (const auto& p : state) {
    const auto [x, y, z] = std::array{static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                                      static_cast<double>(p.vz_m_s)};
    sum += (1 << p.level) * (gravity * static_cast<double>(p.y_m) + 0.5 * (x * x + y * y + z * z));
  }
  return sum;
}

void splits_are_calm(Backend backend) {
  // S4: one particle, about 1 % and all of a settled tank of level 3, split by 1, 2 and 3 levels.
  const Settled fine(backend);
  auto coarsening = options_for(backend, Settled::n_star, everywhere(3));
  coarsening.start = fine.state;
  const auto coarse = sim::make_simulation(fine.scene, coarsening);
  for (int frame = 0; frame < 100; ++frame) coarse->step_frame();
  const auto start = coarse->read_state();
  const sim::Vec3d middle{6 * d, 7 * d, 6 * d};
  for (const int to : {2, 1, 0}) {
    for (const double radius : {1.2 * d, 2.5 * d, far_m}) {
      auto options = options_for(backend, Settled::n_star, {middle, radius, to, 3});
      options.start = start;
      options.readings.graded_targets = false;
      const auto fluid = sim::make_simulation(fine.scene, options);
      // Coarse water at rest stands lower than fine water; split as a whole it rises to the fine one's
      // height.
      const double before = radius > 100 ? std::max(energy(start), energy(fine.state)) : energy(start);
      double densest = 0;
      double fastest = 0;
      double gain = 0;
      for (int frame = 0; frame < 30; ++frame) {
        fluid->step_frame();
        const auto report = fluid->report();
        densest = std::max(densest, report.density_max);
        fastest = std::max(fastest, report.speed_max_m_s);
        gain = std::max(gain, energy(fluid->read_state()) / before - 1);
      }
      const auto events = fluid->report().levels;
      std::printf(
          "S4: 3 -> %d within %.2f m: %llu splits, %llu merges, max rho %.3f, fastest %.3f m/s, energy "
          "%+.4f\n",
          to, radius, static_cast<unsigned long long>(events.splits),
          static_cast<unsigned long long>(events.merges), densest, fastest, gain);
      EXPECT_GT(events.splits, 0u);
      EXPECT_LT(densest, radius > 100 ? 1.25 : 1.15);
      // Splitting all of it takes 20 frames in which the whole tank rises: 5 % measured, not the 1 % of a
      // few.
      EXPECT_LT(gain, radius > 100 ? 0.08 : 0.01);
      expect_sound(*fluid, static_cast<std::int64_t>(start.size()), 8 * Settled::n_star);
    }
  }
}
TEST(Levels, SplitsAreCalm) { splits_are_calm(Backend::Cpu); }
TEST(LevelsGpu, SplitsAreCalm) { splits_are_calm(Backend::Cuda); }

void square_wave_does_not_oscillate(Backend backend) {
  // S5: targets that change every 1, 2 and 3 frames never give a merge.
  const Settled tank(backend);
  auto start = tank.state;
  for (const int half : {1, 2, 3}) {
    auto options = options_for(backend, Settled::n_star, everywhere(0));
    options.start = start;
    const auto fluid = sim::make_simulation(tank.scene, options);
    for (int frame = 0; frame < 36; ++frame) {
      fluid->force_targets(everywhere(frame / half % 2 ? 0 : 3));
      fluid->step_frame();
    }
    EXPECT_EQ(fluid->report().levels.merges, 0u) << "period " << 2 * half;
    EXPECT_EQ(fluid->particle_count(), 8 * Settled::n_star);
  }
  // From coarse particles: split once, then nothing.
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = start;
  auto fluid = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
  options.start = fluid->read_state();
  fluid = sim::make_simulation(tank.scene, options);
  std::int64_t settled = 0;
  for (int frame = 0; frame < 120; ++frame) {
    fluid->force_targets(everywhere(frame / 2 % 2 ? 0 : 3));
    fluid->step_frame();
    if (frame == 100) settled = fluid->particle_count();
  }
  EXPECT_EQ(fluid->report().levels.merges, 0u);
  EXPECT_GT(fluid->report().levels.splits, 0u);
  EXPECT_EQ(fluid->particle_count(), settled);
}
TEST(Levels, SquareWaveDoesNotOscillate) { square_wave_does_not_oscillate(Backend::Cpu); }
TEST(LevelsGpu, SquareWaveDoesNotOscillate) { square_wave_does_not_oscillate(Backend::Cuda); }

void events_conserve(Backend backend) {
  // S6: a blob without gravity, far from walls, with random velocities and a target that comes and goes.
  auto scene = fluid_test::tank({8, 8, 8}, {12 * d, 16 * d, 12 * d});
  scene.gravity_m_s2 = 0;
  std::vector<ParticleState> start;
  std::mt19937 random(8);
  std::normal_distribution<float> speed(0, 0.3f);
  for (int i = 0; i < 12 * 16 * 12; ++i) {
    const auto at = [](int k) { return static_cast<float>(3 + d * k); };
    start.push_back(
        {i, 0, at(i % 12), at(i / 144), at(i / 12 % 12), 0.2f + speed(random), speed(random), speed(random)});
  }
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = start;
  const auto fluid = sim::make_simulation(scene, options);
  const auto before = momentum(start);
  const auto mass = mass_units(start);
  for (int frame = 0; frame < 200; ++frame) {
    // A sphere of fine particles that wanders along with the blob.
    fluid->force_targets({{3.5 + frame / 200.0, 4 + 0.6 * std::sin(frame * 0.1), 4}, 0.7, 0, 3});
    fluid->step_frame();
  }
  const auto state = fluid->read_state();
  const auto after = momentum(state);
  const auto events = fluid->report().levels;
  std::printf("S6: %llu splits, %llu merges, momentum drift %.2e %.2e %.2e m/s, %.3f J lost in merges\n",
              static_cast<unsigned long long>(events.splits), static_cast<unsigned long long>(events.merges),
              (after[0] - before[0]) / static_cast<double>(mass),
              (after[1] - before[1]) / static_cast<double>(mass),
              (after[2] - before[2]) / static_cast<double>(mass), events.energy_lost_j);
  EXPECT_GT(events.splits + events.merges, 2000u);
  EXPECT_GT(events.energy_lost_j, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(after[k], before[k], 1e-4 * static_cast<double>(mass) * std::sqrt(gravity * d));
  }
  expect_sound(*fluid, static_cast<std::int64_t>(start.size()), mass);
}
TEST(Levels, EventsConserveMassAndMomentum) { events_conserve(Backend::Cpu); }
TEST(LevelsGpu, EventsConserveMassAndMomentum) { events_conserve(Backend::Cuda); }

void one_event_is_exact(Backend backend) {
  // One split of each k and one merge, alone in the air without gravity.
  auto scene = fluid_test::tank({8, 8, 8}, {8 * d, 8 * d, 8 * d});
  scene.gravity_m_s2 = 0;
  for (const int k : {1, 2, 3}) {
    auto options = options_for(backend, 64, everywhere(3 - k));
    options.start = std::vector<ParticleState>{{5, 3, 4, 4, 4, 1.25f, -0.7f, 0.3f}};
    options.substeps = 1;
    const auto fluid = sim::make_simulation(scene, options);
    fluid->step_frame();
    const auto state = fluid->read_state();
    ASSERT_EQ(state.size(), std::size_t{1} << k);
    const auto p = momentum(state);
    EXPECT_NEAR(p[0], 8 * 1.25, 8e-6);
    EXPECT_NEAR(p[1], -8 * 0.7, 8e-6);
    EXPECT_NEAR(p[2], 8 * 0.3, 8e-6);
    double x = 0;
    for (const auto& child : state) {
      EXPECT_EQ(child.level, 3 - k);
      x += static_cast<double>(child.x_m) / static_cast<double>(state.size());
    }
    EXPECT_NEAR(x, 4 + 1.25 / 60, 1e-5);
  }
  auto options = options_for(backend, 64, everywhere(1));
  options.start =
      std::vector<ParticleState>{{3, 0, 4, 4, 4, 1, 0.5f, 0}, {9, 0, 4.15f, 4, 4, 1, -0.5f, 0.25f}};
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 3; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->particle_count(), 2) << "a merge before four frames of the same wish";
  fluid->step_frame();
  const auto state = fluid->read_state();
  ASSERT_EQ(state.size(), 1u);
  EXPECT_EQ(state[0].id, 3);
  EXPECT_EQ(state[0].level, 1);
  EXPECT_NEAR(state[0].vx_m_s, 1, 1e-6);
  EXPECT_NEAR(state[0].vz_m_s, 0.125, 1e-6);
  EXPECT_GT(fluid->report().levels.energy_lost_j, 0);
}
TEST(Levels, OneEventIsExact) { one_event_is_exact(Backend::Cpu); }
TEST(LevelsGpu, OneEventIsExact) { one_event_is_exact(Backend::Cuda); }

void capacity_refuses_gracefully(Backend backend) {
  // S20: room for 1,000 particles, water for 2,304.
  const Settled tank(backend);
  auto options = options_for(backend, Settled::n_star, everywhere(3));
  options.start = tank.state;
  const auto coarse = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 100; ++frame) coarse->step_frame();
  options.start = coarse->read_state();
  std::int64_t next = 0;
  for (auto& p : *options.start) p.id = static_cast<int>(next++);
  options.particle_capacity = 1000;
  options.forced_targets = everywhere(0);
  const auto fluid = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 120; ++frame) fluid->step_frame();
  const auto full = fluid->report();
  EXPECT_EQ(fluid->particle_capacity(), 1000);
  EXPECT_GT(full.levels.split_no_room, 0u);
  EXPECT_GT(full.particles, 990);
  for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->report().levels.splits, full.levels.splits) << "it goes on splitting without room";
  EXPECT_EQ(fluid->report().levels.merges, 0u);
  expect_sound(*fluid, next, 8 * Settled::n_star);
}
TEST(Levels, CapacityRefusesGracefully) { capacity_refuses_gracefully(Backend::Cpu); }
TEST(LevelsGpu, CapacityRefusesGracefully) { capacity_refuses_gracefully(Backend::Cuda); }

void order_does_not_matter(Backend backend) {
  const Settled tank(backend);
  auto shuffled = tank.state;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(4));
  const sim::TargetRegion region{{6 * d, 8 * d, 6 * d}, 5 * d, 0, 3};
  std::vector<std::vector<ParticleState>> ends;
  for (const int threads : {1, 2, 5}) {
    auto options = options_for(backend, Settled::n_star, region);
    options.start = threads == 2 ? shuffled : tank.state;
    const int usual = omp_get_max_threads();
    omp_set_num_threads(threads);
    const auto fluid = sim::make_simulation(tank.scene, options);
    for (int frame = 0; frame < 25; ++frame) {
      fluid->step_frame();
      if (threads == 5 && frame == 11) fluid->report();
      if (frame == 15) fluid->force_targets(everywhere(0));
    }
    omp_set_num_threads(usual);
    ends.push_back(fluid->read_state());
  }
  for (const auto& end : ends) {
    ASSERT_EQ(end.size(), ends[0].size());
    for (std::size_t i = 0; i < end.size(); ++i) {
      const auto& a = end[i];
      const auto& b = ends[0][i];
      ASSERT_TRUE(a.id == b.id && a.level == b.level && a.x_m == b.x_m && a.y_m == b.y_m && a.z_m == b.z_m &&
                  a.vx_m_s == b.vx_m_s && a.vy_m_s == b.vy_m_s && a.vz_m_s == b.vz_m_s)
          << i;
    }
  }
}
TEST(Levels, OrderThreadsAndReportsChangeNoBit) { order_does_not_matter(Backend::Cpu); }
TEST(LevelsGpu, OrderAndReportsChangeNoBit) { order_does_not_matter(Backend::Cuda); }

void interface_rests(Backend backend) {
  // S3: level 3 below, level 0 above, adaptivity off, 5 s.
  const auto scene = fluid_test::tank({12 * d, 30 * d, 12 * d}, {12 * d, 16 * d, 12 * d});
  std::vector<ParticleState> start;
  const auto at = [](double k) { return static_cast<float>(d * k); };
  for (int i = 0; i < 6 * 6 * 4; ++i) {
    start.push_back({static_cast<int>(start.size()), 3, at(2 * (i % 6) + 1), at(2 * (i / 36) + 1),
                     at(2 * (i / 6 % 6) + 1), 0, 0, 0});
  }
  for (int i = 0; i < 12 * 12 * 8; ++i) {
    start.push_back({static_cast<int>(start.size()), 0, at(i % 12 + 0.5), at(8 + i / 144 + 0.5),
                     at(i / 12 % 12 + 0.5), 0, 0, 0});
  }
  sim::SimulationOptions options;
  options.n_star = Settled::n_star;
  options.backend = backend;
  options.start = start;
  const auto fluid = sim::make_simulation(scene, options);
  const auto top_of_coarse = [&] {
    double sum = 0;
    int count = 0;
    for (const auto& p : fluid->read_state()) {
      if (p.level == 3) sum += static_cast<double>(p.y_m), ++count;
    }
    return sum / count;
  };
  for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
  const double early = top_of_coarse();
  double densest = 0;
  for (int frame = 0; frame < 240; ++frame) {
    fluid->step_frame();
    if (frame % 20 == 0) densest = std::max(densest, fluid->report().density_max);
  }
  const auto state = fluid->read_state();
  std::printf("S3: coarse particles moved by %.3f d, max rho %.3f, v_rms %.3f m/s, centre %.3f of 1.2 m\n",
              (top_of_coarse() - early) / d, densest, fluid_test::rms_speed(state),
              mass_centre_height(state));
  EXPECT_LT(std::abs(top_of_coarse() - early), d);
  EXPECT_LT(densest, 1.08);
  EXPECT_EQ(mass_units(state), 8 * Settled::n_star);
}
TEST(Levels, MassInterfaceRests) { interface_rests(Backend::Cpu); }
TEST(LevelsGpu, MassInterfaceRests) { interface_rests(Backend::Cuda); }

TEST(Levels, BadInputIsNamed) {
  const auto scene = fluid_test::tank({2, 2, 2}, {8 * d, 8 * d, 8 * d});
  for (const int n : {-1, 0, 5}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.levels = n;
    EXPECT_THROW(sim::make_simulation(scene, options), base::Error) << n;
  }
  for (const auto& bad : std::vector<ParticleState>{{0, 4, 1, 1, 1, 0, 0, 0},
                                                    {0, -1, 1, 1, 1, 0, 0, 0},
                                                    {512, 0, 1, 1, 1, 0, 0, 0},
                                                    {-1, 0, 1, 1, 1, 0, 0, 0}}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.start = std::vector<ParticleState>{bad};
    EXPECT_THROW(sim::make_simulation(scene, options), base::Error) << bad.id;
  }
  auto options = options_for(Backend::Cpu, 64, everywhere(4));
  EXPECT_THROW(sim::make_simulation(scene, options), base::Error);
  options = options_for(Backend::Cpu, 64, everywhere(0));
  options.start = std::vector<ParticleState>{{1, 0, 1, 1, 1, 0, 0, 0}, {1, 0, 1, 1, 1, 0, 0, 0}};
  EXPECT_THROW(sim::make_simulation(scene, options), base::Error);
  // No particles at all.
  options.start = std::vector<ParticleState>{};
  const auto fluid = sim::make_simulation(scene, options);
  fluid->step_frame();
  EXPECT_EQ(fluid->report().particles, 0);
}

TEST(Levels, OneLevelMethodsRunAndHoldNothingOfThem) {
  const auto scene = fluid_test::tank({2, 2, 2}, {8 * d, 8 * d, 8 * d});
  std::size_t bytes[3] = {};
  int at = 0;
  for (const auto kind : {sim::MethodKind::LoRes, sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    auto options = options_for(Backend::Cpu, 64, everywhere(0));
    options.method = kind;
    if (kind != sim::MethodKind::Ours) options.forced_targets.reset();
    const auto fluid = sim::make_simulation(scene, options);
    fluid->step_frame();
    const std::string said = fluid->explain();
    for (const char* pass : {"split and merge", "graded targets", "frame neighbours"}) {
      const bool runs = said.find(std::string("frame start  ") + pass) != std::string::npos;
      EXPECT_EQ(runs, kind == sim::MethodKind::Ours) << pass;
    }
    for (const char* column : {" target", " history", " waiting", " age"}) {
      const bool held = said.substr(said.find("columns:")).find(column) != std::string::npos;
      EXPECT_EQ(held, kind == sim::MethodKind::Ours) << column;
    }
    bytes[at++] = fluid->particle_bytes();
  }
  EXPECT_EQ(bytes[1], 8 * bytes[0]);
  EXPECT_GT(bytes[2], bytes[1]);
}

}  // namespace
