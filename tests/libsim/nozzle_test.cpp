/// Nozzles and recirculation: the schedule of layers, scenes with nozzles, and their mass balance.

#include "libsim/scene/nozzle.hpp"
#include "libsim/scene/gaze.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <limits>
#include <random>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;
using sim::MethodKind;

constexpr double pi = 3.14159265358979;

sim::Scene jet_impact() { return sim::read_scene("data/scenes/jet_impact.toml"); }
sim::Scene faucet() { return sim::read_scene("data/scenes/faucet.toml"); }

TEST(JetLayer, HasTheSitesOfItsDescription) {
  EXPECT_EQ(sim::jet_layer(jet_impact().nozzles[0], 0.3).sites, 79);
  EXPECT_EQ(sim::jet_layer(jet_impact().nozzles[0], 0.15).sites, 314);
  EXPECT_EQ(sim::jet_layer(faucet().nozzles[0], 0.3).sites, 28);
  EXPECT_EQ(sim::jet_layer(faucet().nozzles[0], 0.15).sites, 113);
  // A mouth narrower than a particle still pours.
  sim::Nozzle thin = faucet().nozzles[0];
  thin.diameter_m = 0.01;
  EXPECT_EQ(sim::jet_layer(thin, 0.15).sites, 1);
}

TEST(LayersDue, PourTheSameVolumeAtEverySpacing) {
  for (const auto& scene : {jet_impact(), faucet()}) {
    const auto& nozzle = scene.nozzles[0];
    const double flow = pi / 4 * nozzle.diameter_m * nozzle.diameter_m * nozzle.speed_m_s;
    for (const double spacing : {0.0945, 0.15, 0.3, 0.6}) {
      const double layer = sim::jet_layer(nozzle, spacing).sites * spacing * spacing * spacing;
      sim::Poured poured;
      const int frames = 5 * (nozzle.on_frames + nozzle.off_frames);
      for (int frame = 0; frame < frames; ++frame) {
        const auto before = sim::poured_before(nozzle, spacing, frame, 1.0 / 60);
        ASSERT_EQ(before.layers, poured.layers) << "no layer is skipped or poured twice";
        const auto due = sim::layers_due(nozzle, spacing, before, frame, 1.0 / 60);
        poured.layers += due.count;
        if (due.count) {
          ASSERT_GE(due.first_time_s, -1e-12);
          ASSERT_LT(due.first_time_s + (due.count - 1) * due.interval_s, 1.0 / 60);
        }
      }
      const double open_s = 5 * nozzle.on_frames / 60.0;
      EXPECT_NEAR(static_cast<double>(poured.layers) * layer, flow * open_s, 0.51 * layer) << spacing;
    }
  }
  EXPECT_NEAR(pi / 4 * 9 * 12, 84.8, 0.05);
}

TEST(LayersDue, KeepTheFlowWhenTheSpacingChangesFromFrameToFrame) {
  const auto nozzle = jet_impact().nozzles[0];
  const double flow = pi / 4 * nozzle.diameter_m * nozzle.diameter_m * nozzle.speed_m_s;
  std::mt19937 random(1);
  sim::Poured poured;
  double volume = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const double spacing = 0.15 * std::cbrt(1 << random() % 4);
    const auto layer = sim::jet_layer(nozzle, spacing);
    const auto due = sim::layers_due(nozzle, spacing, poured, frame, 1.0 / 60);
    volume += due.count * layer.sites * std::pow(spacing, 3);
    poured.length_m += due.count * layer.pitch_m;
    const double open_s = (frame / 200 * 80 + std::min(frame % 200 + 1, 80)) / 60.0;
    // The poured volume is off by at most half a layer of the coarsest level.
    ASSERT_NEAR(volume, flow * open_s, 0.51 * 0.31 * flow / nozzle.speed_m_s) << frame;
  }
}

TEST(LayersDue, NothingComesWhileTheNozzleRests) {
  const auto nozzle = faucet().nozzles[0];
  for (int frame = 0; frame < 240; ++frame) {
    const bool open = frame % 120 < 60;
    const auto before = sim::poured_before(nozzle, 0.15, frame, 1.0 / 60);
    const auto due = sim::layers_due(nozzle, 0.15, before, frame, 1.0 / 60);
    EXPECT_EQ(due.count > 0, open) << frame;  // 1.78 layers a frame: at least one while open
  }
}

TEST(NozzleScene, ErrorsNameThePlaceAndTheMend) {
  const std::string good = base::read_file(base::resource("data/scenes/jet_impact.toml"), 1 << 20);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return fluid_test::scene_error(text.replace(at, from.size(), to));
  };
  EXPECT_EQ(fluid_test::scene_error(good), "no error");
  EXPECT_THAT(with("position_m = [7.2, 7.7, 7.2]", "position_m = [1.0, 7.7, 7.2]"),
              testing::AllOf(testing::HasSubstr("inside a wall"), testing::HasSubstr("scene.toml:2")));
  EXPECT_THAT(with("position_m = [7.2, 7.7, 7.2]", "position_m = [7.2, 7.7, 13.0]"),
              testing::HasSubstr("inside a wall"));
  EXPECT_THAT(with("position_m = [7.2, 7.7, 7.2]", "position_m = [7.2, 7.7, 15.0]"),
              testing::HasSubstr("outside the tank"));
  EXPECT_THAT(with("position_m = [7.2, 7.7, 7.2]", "position_m = [7.2, -1.0, 7.2]"),
              testing::HasSubstr("below the floor"));
  EXPECT_THAT(with("diameter_m = 3.0", "diameter_m = 0.0"), testing::HasSubstr("out of range"));
  EXPECT_THAT(with("speed_m_s = 12.0", "speed_m_s = -12.0"), testing::HasSubstr("out of range"));
  EXPECT_THAT(with("speed_m_s = 12.0", "speed_m_s = 19.0"), testing::HasSubstr("faster than time.v_ref_m_s"));
  EXPECT_THAT(with("on_frames = 80", "on_frames = 0"), testing::HasSubstr("out of range"));
  EXPECT_THAT(with("corner_m = 2.0", "corner_m = 8.0"), testing::HasSubstr("overlap"));
  EXPECT_THAT(with("[recirculation]", "[recirculations]"), testing::HasSubstr("recirculation' is missing"));
  // A second nozzle as wide and as fast, whose water moves 0.2 m in a frame.
  const auto second = [&](const char* place) {
    return fluid_test::scene_error(good + "\n[[nozzle]]\ndiameter_m = 3.0\nposition_m = " + place +
                                   "\nspeed_m_s = 12.0\non_frames = 80\noff_frames = 80\n");
  };
  EXPECT_THAT(second("[7.2, 7.6, 8.2]"), testing::AllOf(testing::HasSubstr("nozzle[1].position_m"),
                                                        testing::HasSubstr("earlier nozzle")));
  EXPECT_EQ(second("[10.3, 7.6, 7.2]"), "no error");
  EXPECT_EQ(second("[7.2, 7.4, 8.2]"), "no error");
}

TEST(NozzleScene, ScenesHoldTheirVolume) {
  for (const auto& scene : {jet_impact(), faucet()}) {
    EXPECT_NEAR(sim::resolution_of(scene, MethodKind::HiRes, 32768).spacing_m, 0.15, 1e-9) << scene.name;
    EXPECT_EQ(sim::substeps_of(scene, 32 * 1024), 2);
    EXPECT_EQ(sim::substeps_of(scene, 128 * 1024), 4);
  }
}

sim::SimulationOptions small(Backend backend, MethodKind method) {
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = 512;
  return options;
}

/// A short pulse into a settled pool at n_* = 512.
void counts_flow_and_walls_hold(Backend backend) {
  for (auto scene : {jet_impact(), faucet()}) {
    scene.settle_frames = 20;
    auto& nozzle = scene.nozzles[0];
    nozzle.on_frames = 30;
    nozzle.off_frames = 20;
    const double flow = pi / 4 * nozzle.diameter_m * nozzle.diameter_m * nozzle.speed_m_s;
    for (const auto method : {MethodKind::LoRes, MethodKind::HiRes}) {
      const auto options = small(backend, method);
      const auto fluid = sim::make_simulation(scene, options);
      const auto n = sim::particle_count(method, options.n_star);
      const double finest = sim::resolution_of(scene, method, options.n_star).finest_spacing_m;
      for (int frame = 0; frame < 80; ++frame) {
        fluid->step_frame();
        ASSERT_EQ(fluid->particle_count(), n);
        if (frame % 20 == 0) {
          ASSERT_EQ(fluid_test::outside(fluid->read_state(), scene.tank_size_m, 0), 0) << frame;
        }
      }
      const auto state = fluid->read_state();
      ASSERT_EQ(static_cast<std::int64_t>(state.size()), n);
      for (std::size_t i = 0; i < state.size(); ++i) ASSERT_EQ(state[i].id, static_cast<int>(i));
      const auto report = fluid->report();
      const double volume = static_cast<double>(report.poured) * std::pow(finest, 3);
      const double layer = sim::jet_layer(nozzle, fluid->spacing_m()).pitch_m * flow / nozzle.speed_m_s;
      std::printf("%s %s: poured %.2f m3 of %.2f, a layer is %.2f\n", scene.name.c_str(),
                  sim::method_name(method).c_str(), volume, flow, layer);
      EXPECT_NEAR(volume, flow * 1.0, 0.51 * layer);
      EXPECT_EQ(report.guards.nozzle_waited, 0u);
      EXPECT_EQ(report.guards.not_finite, 0u);
    }
  }
}
TEST(Nozzle, CountsFlowAndWallsHold) { counts_flow_and_walls_hold(Backend::Cpu); }
TEST(NozzleGpu, CountsFlowAndWallsHold) { counts_flow_and_walls_hold(Backend::Cuda); }

/// Poured mass, in masses of a particle of level 0, at the end of each frame that ends at a whole multiple of
/// 1/60 s.
std::vector<std::int64_t> poured_over_time(const sim::Scene& scene, double frame_dt_s, int frames) {
  auto options = small(Backend::Cpu, MethodKind::LoRes);
  options.frame_dt_s = frame_dt_s;
  options.substeps = 1;
  const auto fluid = sim::make_simulation(scene, options);
  std::vector<std::int64_t> out;
  for (int frame = 1; frame <= frames; ++frame) {
    fluid->step_frame();
    if (frame * 60 % frames == 0) out.push_back(fluid->report().poured);
  }
  return out;
}

TEST(Nozzle, GazeKeysCountTheScenesFramesToo) {
  const auto scene = faucet();
  EXPECT_EQ(sim::scene_frame(scene, 45, scene.frame_dt_s), 45);
  EXPECT_EQ(sim::scene_frame(scene, 45, scene.frame_dt_s / 1.5), 30);
  EXPECT_EQ(sim::scene_frame(scene, 45, 2 * scene.frame_dt_s), 90);
}

TEST(Nozzle, PulsesLastAsLongWhateverTheRunsFrames) {
  auto scene = faucet();
  scene.settle_frames = 0;
  scene.nozzles.front().on_frames = 20;
  scene.nozzles.front().off_frames = 30;
  const auto usual = poured_over_time(scene, 0, 60);
  ASSERT_EQ(usual.size(), 60u);
  EXPECT_GT(usual[19], 0);
  EXPECT_EQ(usual[49], usual[19]) << "off from frame 20 to 50";
  EXPECT_GT(usual[59], usual[49]);
  EXPECT_EQ(poured_over_time(scene, 1.0 / 120, 120), usual);
  const auto at_90 = poured_over_time(scene, 1.0 / 90, 90);  // every 30th of a second
  ASSERT_EQ(at_90.size(), 30u);
  for (std::size_t i = 0; i < at_90.size(); ++i) EXPECT_EQ(at_90[i], usual[2 * i + 1]) << i;
}

bool same(const std::vector<ParticleState>& a, const std::vector<ParticleState>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
           return p.id == q.id && p.x_m == q.x_m && p.y_m == q.y_m && p.z_m == q.z_m &&
                  p.vx_m_s == q.vx_m_s && p.vy_m_s == q.vy_m_s && p.vz_m_s == q.vz_m_s;
         });
}

/// Runs twenty frames across the end of a pulse.
std::vector<ParticleState> run_on(const sim::Scene& scene, sim::SimulationOptions options,
                                  std::vector<ParticleState> start, int start_frame) {
  options.start = std::move(start);
  options.start_frame = start_frame;
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 20; ++frame) fluid->step_frame();
  EXPECT_GT(fluid->report().poured, 0);
  return fluid->read_state();
}

void runs_are_bit_equal(Backend backend) {
  const auto scene = faucet();
  auto options = small(backend, MethodKind::HiRes);
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 50; ++frame) fluid->step_frame();
  const auto middle = fluid->read_state();
  for (int frame = 0; frame < 20; ++frame) fluid->step_frame();
  const auto through = fluid->read_state();
  auto shuffled = middle;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  EXPECT_TRUE(same(through, run_on(scene, options, middle, 50))) << "a run from a checkpoint differs";
  EXPECT_TRUE(same(through, run_on(scene, options, shuffled, 50))) << "the input's order matters";
  if (backend != Backend::Cpu) return;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(threads > 1 ? 1 : 3);
  EXPECT_TRUE(same(through, run_on(scene, options, middle, 50))) << "the number of threads matters";
  omp_set_num_threads(threads);
}
/// Runs of several levels, with exchanges and splits, are bit-equal too. They start without a history of
/// levels.
void mixed_levels_are_bit_equal(Backend backend) {
  const auto scene = faucet();
  auto fine = scene;
  fine.settle_frames = 20;
  const auto options = small(backend, MethodKind::FovFluid);
  const auto settled = sim::make_simulation(fine, options)->read_state();
  auto shuffled = settled;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  const auto once = run_on(scene, options, settled, 40);
  EXPECT_TRUE(same(once, run_on(scene, options, shuffled, 40))) << "the input's order matters";
  if (backend != Backend::Cpu) return;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(threads > 1 ? 1 : 3);
  EXPECT_TRUE(same(once, run_on(scene, options, settled, 40))) << "the number of threads matters";
  omp_set_num_threads(threads);
}
TEST(Nozzle, MixedLevelsAreBitEqual) { mixed_levels_are_bit_equal(Backend::Cpu); }
TEST(NozzleGpu, MixedLevelsAreBitEqual) { mixed_levels_are_bit_equal(Backend::Cuda); }

TEST(Nozzle, RunsAreBitEqual) { runs_are_bit_equal(Backend::Cpu); }
TEST(NozzleGpu, RunsAreBitEqual) { runs_are_bit_equal(Backend::Cuda); }

/// A defective tracker: a NaN ray marked as valid.
sim::EyeLook lost_eye(const sim::Scene& scene) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {{{nan, 0, 0}, {nan, nan, nan}, true}, sim::make_view(scene.view, 320, 240), nullptr};
}

/// Domain and reservoir together hold the scene's mass through splits, merges and pouring.
void ledger_closes(Backend backend) {
  auto scene = faucet();
  scene.settle_frames = 20;
  auto& nozzle = scene.nozzles[0];
  nozzle.on_frames = 40;
  nozzle.off_frames = 10;
  const double flow = pi / 4 * nozzle.diameter_m * nozzle.diameter_m * nozzle.speed_m_s;
  for (const auto method : {MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp}) {
    auto options = small(backend, method);
    options.temporal.fixed_tau = -6;
    const auto fluid = sim::make_simulation(scene, options);
    const auto start = fluid->particle_count();
    std::size_t levels = 0;
    for (int frame = 1; frame <= 70; ++frame) {
      if (frame == 30) fluid->look({{lost_eye(scene)}});
      fluid->step_frame();
      if (frame % 10) continue;
      const auto report = fluid->report();
      // S15: n = n0 + in - out + split - merge.
      ASSERT_EQ(report.particles, start + report.particles_in - report.particles_out +
                                      static_cast<std::int64_t>(report.levels.born) -
                                      static_cast<std::int64_t>(report.levels.merges))
          << frame;
      ASSERT_EQ(report.mass_units + report.reservoir, 8 * options.n_star) << frame;
      ASSERT_LT(report.reservoir, 8);
      ASSERT_EQ(report.guards.nozzle_waited, 0u);
      levels = std::max(levels, report.particles_by_level.size());
      ASSERT_EQ(fluid_test::outside(fluid->read_state(), scene.tank_size_m, 0), 0) << frame;
    }
    EXPECT_GT(levels, 1u) << "the test must see mixed levels";
    EXPECT_GT(fluid->report().particles_in, 0);
    EXPECT_GT(fluid->report().levels.born + fluid->report().levels.merges, 0u) << "levels must change";
    EXPECT_GE(fluid->report().guards.gaze_lost, 40u);
    const auto state = fluid->read_state();
    for (std::size_t i = 1; i < state.size(); ++i) ASSERT_LT(state[i - 1].id, state[i].id);
    const double finest = sim::resolution_of(scene, method, options.n_star).finest_spacing_m;
    const double volume = static_cast<double>(fluid->report().poured) * std::pow(finest, 3);
    const auto report = fluid->report();
    std::printf("%s: poured %.2f m3 of %.2f, %lld particles for %lld m_*, reservoir %lld, max density %.3f\n",
                sim::method_name(method).c_str(), volume, flow, static_cast<long long>(report.particles),
                static_cast<long long>(report.mass_units), static_cast<long long>(report.reservoir),
                report.density_max);
    // After 60 open frames the poured volume is off by at most half a layer of the coarsest level.
    const double coarsest = sim::jet_layer(nozzle, 2 * finest).pitch_m * flow / nozzle.speed_m_s;
    EXPECT_NEAR(volume, flow, 0.51 * coarsest);
  }
}
TEST(Nozzle, LedgerOfDomainAndReservoirCloses) { ledger_closes(Backend::Cpu); }
TEST(NozzleGpu, LedgerOfDomainAndReservoirCloses) { ledger_closes(Backend::Cuda); }

TEST(Nozzle, IsAbsentWhereTheSceneHasNone) {
  const auto options = small(Backend::Cpu, MethodKind::HiRes);
  auto dam = sim::read_scene("data/scenes/single_dam.toml");
  dam.settle_frames = 0;
  const auto without = sim::make_simulation(dam, options);
  EXPECT_THAT(without->explain(), testing::HasSubstr("-  nozzle              not called for"));
  auto scene = jet_impact();
  scene.settle_frames = 0;
  const auto with = sim::make_simulation(scene, options);
  EXPECT_THAT(with->explain(), testing::HasSubstr("the scene has a nozzle"));
  EXPECT_THAT(with->explain(), testing::Not(testing::HasSubstr("-  nozzle")));
  without->step_frame();
  for (int frame = 0; frame < 3; ++frame) with->step_frame();  // a layer every 2.6 frames
  ASSERT_GT(with->report().poured, 0);
  // A nozzle allocates memory only for the choice of the lowest particles; the dam has none of it.
  auto plain = scene;
  plain.nozzles.clear();
  const auto closed = sim::make_simulation(plain, options);
  closed->step_frame();
  EXPECT_EQ(without->particle_bytes(), closed->particle_bytes());
  EXPECT_GT(with->particle_bytes(), closed->particle_bytes());
}

}  // namespace
