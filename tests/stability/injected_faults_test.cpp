/// Faults injected into running water: the run continues, counters rise, and water far from the fault behaves
/// like that of an undisturbed twin. Divergence.* tests the report of the first trouble.

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "libsim/cases/watch.hpp"
#include "libsim/scene/extent.hpp"
#include "stats/base/error.hpp"
#include "tests/libsim/levels_helpers.hpp"

namespace {

using sim::Backend;
using sim::MethodKind;
using sim::cases::State;

constexpr double d = sim::cases::d;
constexpr double length = 24 * d, width = 8 * d, depth = 6 * d;
const std::vector<MethodKind> methods{MethodKind::HiRes, MethodKind::Ours, MethodKind::OursTsp};

/// A long pool. Methods with levels are finest around the view's axis.
sim::Scene pool_scene() { return sim::cases::tank({length, 3, width}, {length, depth, width}); }

State lattice() { return sim::cases::block(MethodKind::HiRes, {0, 0, 0}, {length, depth, width}); }

std::unique_ptr<sim::Simulation> pool(Backend backend, MethodKind method, const State& start,
                                      double frame_dt_s = 0) {
  sim::Scene scene = pool_scene();
  auto options =
      sim::cases::options_of({.method = method, .backend = backend, .frame_dt_s = frame_dt_s}, scene, start);
  // Room for all water at level 0, even if it starts coarser.
  if (sim::traits_of(method).adaptive()) {
    options.particle_capacity = static_cast<std::int64_t>(lattice().size());
  }
  return sim::make_simulation(scene, options);
}

std::unique_ptr<sim::Simulation> running_pool(Backend backend, MethodKind method) {
  auto fluid = pool(backend, method, lattice());
  for (int frame = 0; frame < 20; ++frame) fluid->step_frame();
  return fluid;
}

void expect_whole(const sim::Simulation& fluid) {
  const auto state = fluid.read_state();
  EXPECT_EQ(sim::cases::mass(state), static_cast<double>(lattice().size()));
  EXPECT_EQ(sim::cases::outside(state, pool_scene().tank_size_m, 0.1 * d), 0);
  for (const auto& p : state) {
    ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.z_m + p.vx_m_s + p.vy_m_s + p.vz_m_s)) << p.id;
  }
}

State far_third(const sim::Simulation& fluid) {
  State state = fluid.read_state();
  std::erase_if(state, [](const auto& p) { return static_cast<double>(p.x_m) < length * 2 / 3; });
  return state;
}

/// 99th percentile of the distance, m, between a particle of `fluid` and the particle with its id in `twin`,
/// over the particles that lie in the far third of `twin`. Both runs must have the same ids.
double way_far_away(const sim::Simulation& fluid, const sim::Simulation& twin) {
  const State all = fluid.read_state();
  std::vector<double> way;
  for (const auto& p : far_third(twin)) {
    const auto& q = all.at(static_cast<std::size_t>(p.id));
    EXPECT_EQ(p.id, q.id);
    way.push_back(static_cast<double>(std::hypot(p.x_m - q.x_m, p.y_m - q.y_m, p.z_m - q.z_m)));
  }
  std::sort(way.begin(), way.end());
  return way.at(way.size() * 99 / 100);
}

/// The `count` particles nearest to the pool's low end, at mid-height.
State at_the_low_end(const sim::Simulation& fluid, std::size_t count) {
  auto state = fluid.read_state();
  const auto away = [](const sim::ParticleState& p) {
    return std::hypot(static_cast<double>(p.x_m), static_cast<double>(p.y_m) - depth / 2,
                      static_cast<double>(p.z_m) - width / 2);
  };
  std::sort(state.begin(), state.end(), [&](const auto& a, const auto& b) { return away(a) < away(b); });
  state.resize(count);
  return state;
}

/// Runs five frames with and without the fault: `counted` must see the fault, and water far from it must
/// hardly differ between the two runs.
void expect_local(const char* fault, Backend backend, MethodKind method, const auto& inject,
                  const auto& counted) {
  const auto fluid = running_pool(backend, method), twin = running_pool(backend, method);
  EXPECT_EQ(counted(fluid->report().guards), 0u) << fault;
  inject(*fluid);
  for (int frame = 0; frame < 5; ++frame) {
    fluid->step_frame();
    twin->step_frame();
  }
  EXPECT_GT(counted(fluid->report().guards), 0u) << fault;
  EXPECT_EQ(counted(twin->report().guards), 0u) << fault;
  expect_whole(*fluid);
  const State far = far_third(*fluid), usual = far_third(*twin);
  const double rise = sim::cases::centre_height(far) - sim::cases::centre_height(usual);
  const double stir = sim::cases::rms_speed(far) - sim::cases::rms_speed(usual);
  std::printf("%s, %s: far water %+.4f d higher than its twin, %+.4f m/s faster, largest rho %.3f\n", fault,
              sim::method_name(method).c_str(), rise / d, stir, fluid->report().density_max);
  EXPECT_LT(std::abs(rise), 0.05 * d) << fault;
  EXPECT_LT(std::abs(stir), 0.1) << fault;
  // With levels, splits are chosen over the whole water, so particles have no twin.
  if (method == MethodKind::HiRes) {
    EXPECT_LT(way_far_away(*fluid, *twin), 0.1 * d) << fault;
  }
  EXPECT_LT(fluid->report().density_max, 1.3) << fault;
}

void one_is_no_number(Backend backend) {
  for (const auto method : methods) {
    expect_local(
        "NaN", backend, method,
        [](sim::Simulation& fluid) {
          State one = at_the_low_end(fluid, 1);
          one[0].vy_m_s = std::numeric_limits<float>::quiet_NaN();
          fluid.put(one);
        },
        [](const sim::GuardCounts& guards) { return guards.not_finite; });
  }
}
TEST(InjectedFaults, NotANumberStaysWhereItIs) { one_is_no_number(Backend::Cpu); }
TEST(InjectedFaultsGpu, NotANumberStaysWhereItIs) { one_is_no_number(Backend::Cuda); }

void ten_kilometres_away(Backend backend) {
  for (const auto method : methods) {
    for (const float away_m : {1e4f, -1e4f}) {
      expect_local(
          "10 km away", backend, method,
          [&](sim::Simulation& fluid) {
            State one = at_the_low_end(fluid, 1);
            one[0].x_m = away_m;
            fluid.put(one);
          },
          [](const sim::GuardCounts& guards) { return guards.not_finite; });
    }
  }
}
TEST(InjectedFaults, AParticleTenKilometresAwayComesBack) { ten_kilometres_away(Backend::Cpu); }
TEST(InjectedFaultsGpu, AParticleTenKilometresAwayComesBack) { ten_kilometres_away(Backend::Cuda); }

void several_in_one_place(Backend backend) {
  for (const auto method : methods) {
    expect_local(
        "coincident", backend, method,
        [](sim::Simulation& fluid) {
          State some = at_the_low_end(fluid, 4);
          for (auto& p : some) {
            const int id = p.id, level = p.level;
            p = some[0];
            p.id = id;
            p.level = level;
          }
          fluid.put(some);
        },
        [](const sim::GuardCounts& guards) { return guards.coincident_pairs; });
  }
}
TEST(InjectedFaults, CoincidentParticlesHarmNobodyFar) { several_in_one_place(Backend::Cpu); }
TEST(InjectedFaultsGpu, CoincidentParticlesHarmNobodyFar) { several_in_one_place(Backend::Cuda); }

void a_hitch(Backend backend) {
  for (const auto method : methods) {
    const State before = running_pool(backend, method)->read_state();
    // One frame of 0.25 s, then usual frames. Each part starts from the end of the one before.
    const auto hitch = pool(backend, method, before, 0.25);
    hitch->step_frame();
    double fastest = hitch->report().speed_max_m_s, densest = hitch->report().density_max;
    const auto after = pool(backend, method, hitch->read_state());
    const auto twin = pool(backend, method, before);
    for (int frame = 0; frame < 15; ++frame) {
      after->step_frame();
      twin->step_frame();
      fastest = std::max(fastest, after->report().speed_max_m_s);
      densest = std::max(densest, after->report().density_max);
    }
    expect_whole(*after);
    const double height = sim::cases::centre_height(after->read_state());
    const double usual = sim::cases::centre_height(twin->read_state());
    std::printf("hitch, %s: fastest %.2f m/s, largest rho %.3f, centre %.4f of its twin's height\n",
                sim::method_name(method).c_str(), fastest, densest, height / usual);
    EXPECT_LT(fastest, 1.5 * std::sqrt(2 * sim::cases::gravity * depth));
    EXPECT_LT(densest, 1.3);
    EXPECT_NEAR(height / usual, 1, 0.05);
  }
}
TEST(InjectedFaults, AHitchLeavesThePool) { a_hitch(Backend::Cpu); }
TEST(InjectedFaultsGpu, AHitchLeavesThePool) { a_hitch(Backend::Cuda); }

void a_gaze_that_jumps(Backend backend) {
  for (const auto method : {MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp}) {
    const auto fluid = pool(backend, method, lattice());
    std::mt19937 random(5);
    const auto draw = [&](double size) { return size * static_cast<double>(random()) / 4294967296.0; };
    const auto start = static_cast<std::int64_t>(lattice().size());
    std::uint64_t splits = 0;
    std::int64_t particles = start;
    double densest = 0, share = 0;
    for (int frame = 0; frame < 90; ++frame) {
      const double x = draw(length), y = draw(depth);
      fluid->look(sim::cases::look_at(pool_scene(), {x, y, draw(width)}));
      fluid->step_frame();
      const auto now = fluid->report();
      share =
          std::max(share, static_cast<double>(now.levels.splits - splits) / static_cast<double>(particles));
      splits = now.levels.splits;
      particles = now.particles;
      densest = std::max(densest, now.density_max);
    }
    const double rms = sim::cases::rms_speed(fluid->read_state());
    std::printf(
        "jumping gaze, %s: %llu splits, %.3f of the particles in a frame at most, rho %.3f, %.2f m/s\n",
        sim::method_name(method).c_str(), static_cast<unsigned long long>(splits), share, densest, rms);
    EXPECT_GT(splits, 0u);
    EXPECT_LE(share, 0.05) << "the throttle";
    EXPECT_LT(densest, 1.3);
    EXPECT_LT(rms, 0.8);
    EXPECT_EQ(fluid->report().guards.not_finite, 0u);
    expect_whole(*fluid);
    levels_test::expect_sound(*fluid, start, start);
  }
}
TEST(InjectedFaults, AGazeThatJumpsEveryFrame) { a_gaze_that_jumps(Backend::Cpu); }
TEST(InjectedFaultsGpu, AGazeThatJumpsEveryFrame) { a_gaze_that_jumps(Backend::Cuda); }

void no_room_in_the_middle_of_splits(Backend backend) {
  // Coarse water that splits everywhere, with room for all of it and for a third.
  const levels_test::Settled tank(backend);
  auto options = levels_test::options_for(backend, levels_test::Settled::n_star, levels_test::everywhere(3));
  options.start = tank.state;
  const auto coarse = sim::make_simulation(tank.scene, options);
  for (int frame = 0; frame < 60; ++frame) coarse->step_frame();
  options.start = coarse->read_state();
  int next = 0;
  for (auto& p : *options.start) p.id = next++;
  options.forced_targets = levels_test::everywhere(0);
  const auto twin = sim::make_simulation(tank.scene, options);
  options.particle_capacity = 800;
  const auto fluid = sim::make_simulation(tank.scene, options);
  double densest = 0;
  for (int frame = 0; frame < 45; ++frame) {
    fluid->step_frame();
    twin->step_frame();
    densest = std::max(densest, fluid->report().density_max);
  }
  const double height = sim::cases::centre_height(fluid->read_state());
  const double before = sim::cases::centre_height(*options.start);
  std::printf("no room: largest rho %.3f, centre %.4f of the start's height\n", densest, height / before);
  EXPECT_GT(fluid->report().levels.split_no_room, 0u);
  EXPECT_EQ(twin->report().levels.split_no_room, 0u);
  EXPECT_LE(fluid->report().particles, 800);
  EXPECT_GT(twin->report().particles, 800);
  EXPECT_LT(densest, 1.25);
  // Water of mixed levels has a lower centre: by 4.6 % here.
  EXPECT_NEAR(height / before, 1, 0.08);
  levels_test::expect_sound(*fluid, next, 8 * levels_test::Settled::n_star);
}
TEST(InjectedFaults, NoRoomInTheMiddleOfSplits) { no_room_in_the_middle_of_splits(Backend::Cpu); }
TEST(InjectedFaultsGpu, NoRoomInTheMiddleOfSplits) { no_room_in_the_middle_of_splits(Backend::Cuda); }

TEST(InjectedFaults, TheLeastNStarRuns) {
  auto scene = sim::read_scene("data/scenes/single_dam.toml");
  scene.settle_frames = 20;
  for (const auto& method : sim::all_methods()) {
    sim::SimulationOptions options;
    options.method = method.kind;
    options.n_star = sim::parse_n_star("64");
    if (method.temporal) options.temporal.fixed_tau = -10;
    sim::cases::Watch watch(scene, options, {.density = 1.3, .outside_m = 0.1});
    for (int frame = 0; frame < 120; ++frame)
      ASSERT_TRUE(watch.step()) << method.name << watch.outcome({}).text();
    EXPECT_EQ(watch.report().mass_units, 8 * 64) << method.name;
  }
}

TEST(InjectedFaults, NStarBeyondItsEndsIsOneClearError) {
  for (const char* bad : {"63", "4097k", "5M", "0", "-64"})
    EXPECT_THROW(sim::parse_n_star(bad), base::Error) << bad;
  // The largest n_* does not fit into 16 GiB, except for LoRes with four million particles.
  const auto largest = sim::parse_n_star("4096k");
  constexpr double gib = 1 << 30;
  for (const auto& method : sim::all_methods()) {
    if (method.kind == MethodKind::LoRes) {
      EXPECT_NO_THROW(sim::check_memory(method.kind, largest, 16 * gib));
      continue;
    }
    try {
      sim::check_memory(method.kind, largest, 16 * gib);
      ADD_FAILURE() << method.name;
    } catch (const base::Error& error) {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("n-star"), testing::HasSubstr("mend: ")));
    }
  }
}

TEST(InjectedFaultsGpu, TheLargestNStarRuns) {
  sim::SimulationOptions options;
  options.method = MethodKind::LoRes;
  options.backend = Backend::Cuda;
  options.n_star = sim::parse_n_star("4096k");
  sim::cases::Watch watch(sim::read_scene("data/scenes/peers_dam.toml"), options, {.density = 1.2});
  for (int frame = 0; frame < 10; ++frame) ASSERT_TRUE(watch.step()) << watch.outcome({}).text();
  EXPECT_EQ(watch.report().guards.neighbours_dropped, 0u);
}

}  // namespace
