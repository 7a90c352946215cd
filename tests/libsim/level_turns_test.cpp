/// The frames in which saliency, splits and merges run.

#include "libsim/methods/level_turns.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::MethodKind;

std::string turns_of(const sim::Readings& readings, const std::vector<double>& turned_deg) {
  sim::LevelTurns turns;
  std::string out;
  for (const double deg : turned_deg) {
    turns.begin_frame(readings, deg);
    out += turns.due ? 'x' : '.';
    turns.end_frame();
  }
  return out;
}

TEST(LevelTurns, AreFrequentAfterASaccadeAndRareBesides) {
  sim::Readings readings;
  readings.levels_period_frames = 4;
  readings.saccade_frames = 3;
  std::vector<double> still(20, 0.0);
  EXPECT_EQ(turns_of(readings, still), "xxxx...x...x...x...x");
  still[10] = 2.5;
  EXPECT_EQ(turns_of(readings, still), "xxxx...x..xxxx...x..");
  still[10] = 1.9;
  EXPECT_EQ(turns_of(readings, still), "xxxx...x...x...x...x");
  readings.levels_period_frames = 1;
  EXPECT_EQ(turns_of(readings, still), std::string(20, 'x'));
}

/// A wide pool of 8,192 finest particles, seen from above the middle of a long side.
sim::Scene pool() {
  auto out = fluid_test::tank({9.6, 3, 2.4}, {9.6, 0.9, 2.4});
  out.view.eye_m = {4.8, 2.5, 4.5};
  out.view.target_m = {4.8, 0.5, 1.2};
  return out;
}

sim::EyeLook eye_at(double x_m) {
  const sim::Vec3d eye = pool().view.eye_m;
  return {{eye, {x_m - eye[0], 0.8 - eye[1], 1.2 - eye[2]}, true}, sim::make_view(pool().view, 320, 240)};
}

std::unique_ptr<sim::Simulation> make(Backend backend, MethodKind method, int period_frames) {
  sim::SimulationOptions options;
  options.method = method;
  options.backend = backend;
  options.n_star = 1024;
  options.readings.levels_period_frames = period_frames;
  return sim::make_simulation(pool(), options);
}

/// Share of level 0 in the water within half a metre of the gaze point.
double fine_share(const sim::Simulation& fluid, double x_m) {
  double fine = 0;
  double all = 0;
  for (const auto& p : fluid.read_state()) {
    if (std::hypot(static_cast<double>(p.x_m) - x_m, static_cast<double>(p.z_m) - 1.2) > 0.5) continue;
    all += 1 << p.level;
    fine += p.level == 0;
  }
  return all > 0 ? fine / all : 0;
}

/// Where the gaze jumps to, water becomes fine as soon as if levels ran in every frame. Which particles split
/// first is random: shares of a frame differ by up to 0.09 (a CPU and a GPU); a delay of one frame costs up
/// to 0.4.
void a_saccade_does_not_wait(Backend backend) {
  for (const MethodKind method : {MethodKind::Ours, MethodKind::FovFluid}) {
    std::vector<double> shares[2];
    for (const int period : {1, 4}) {
      const auto fluid = make(backend, method, period);
      for (int frame = 0; frame < 30; ++frame) {
        fluid->look({{eye_at(2)}});
        fluid->step_frame();
      }
      auto& shown = shares[period == 4];
      shown.push_back(fine_share(*fluid, 7.6));
      for (int frame = 0; frame < 12; ++frame) {
        fluid->look({{eye_at(7.6)}});
        fluid->step_frame();
        shown.push_back(fine_share(*fluid, 7.6));
      }
      std::printf("%s, a turn in %d frames: share of level 0 after a saccade",
                  sim::method_name(method).c_str(), period);
      for (const double share : shown) std::printf(" %.2f", share);
      std::printf("\n");
    }
    EXPECT_LT(shares[0].front(), 0.2);
    EXPECT_GT(shares[0].back(), 0.6);
    for (std::size_t k = 0; k < shares[0].size(); ++k) EXPECT_GT(shares[1][k], shares[0][k] - 0.15) << k;
  }
}
TEST(LevelTurnsOfSimulations, ASaccadeDoesNotWait) { a_saccade_does_not_wait(Backend::Cpu); }
TEST(LevelTurnsOfSimulationsGpu, ASaccadeDoesNotWait) { a_saccade_does_not_wait(Backend::Cuda); }

void nothing_changes_between_turns(Backend backend) {
  const auto fluid = make(backend, MethodKind::Ours, 5);
  int changed = 0;
  std::uint64_t before = 0;
  for (int frame = 0; frame < 60; ++frame) {
    fluid->look({{eye_at(2)}});
    fluid->step_frame();
    const auto levels = fluid->report().levels;
    const std::uint64_t now = levels.splits + levels.merges;
    if (frame > 20) changed += now != before;
    before = now;
  }
  EXPECT_GT(changed, 3);
  EXPECT_LE(changed, 8) << "39 frames hold eight turns";
}
TEST(LevelTurnsOfSimulations, NothingChangesBetweenThem) { nothing_changes_between_turns(Backend::Cpu); }
TEST(LevelTurnsOfSimulationsGpu, NothingChangesBetweenThem) { nothing_changes_between_turns(Backend::Cuda); }

}  // namespace
