/// The fluid against closed forms and experiments.

#include <gtest/gtest.h>

#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;

/// x_front of a plane dam: 99.5th percentile among particles with at least five neighbours, plus r.
double front_of(const std::vector<ParticleState>& state, double spacing) {
  const auto counts = fluid_test::neighbour_counts(state, 2 * spacing);
  std::vector<double> x;
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (counts[i] >= 5) x.push_back(static_cast<double>(state[i].x_m));
  }
  const auto rank = static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(x.size()));
  std::nth_element(x.begin(), x.begin() + rank, x.end());
  return x[static_cast<std::size_t>(rank)] + spacing / 2;
}

double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto above = std::upper_bound(xs.begin(), xs.end(), x);
  if (above == xs.begin()) return ys.front();
  if (above == xs.end()) return ys.back();
  const auto i = static_cast<std::size_t>(above - xs.begin());
  const double t = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return ys[i - 1] + t * (ys[i] - ys[i - 1]);
}

/// Root mean square over the experiment's points, after the best time shift within 0.2 (the gate takes time
/// to open).
double best_rmse(const std::vector<double>& t, const std::vector<double>& z, const std::vector<double>& t_ref,
                 const std::vector<double>& z_ref, double& best_shift) {
  double best = 1e9;
  for (double shift = -0.2; shift <= 0.2001; shift += 0.01) {
    double sum = 0;
    for (std::size_t i = 0; i < t_ref.size(); ++i) {
      const double error = interpolate(t, z, t_ref[i] + shift) - z_ref[i];
      sum += error * error;
    }
    const double rmse = std::sqrt(sum / static_cast<double>(t_ref.size()));
    if (rmse < best) {
      best = rmse;
      best_shift = shift;
    }
  }
  return best;
}

void front_follows_martin_and_moyce(sim::Backend backend) {
  const auto scene = sim::read_scene("data/scenes/martin_moyce.toml");
  sim::SimulationOptions options;
  options.backend = backend;
  options.n_star = 2 * 1024;
  const auto fluid = sim::make_simulation(scene, options);
  EXPECT_EQ(fluid->particle_count(), 16 * 1024);
  const double a = scene.fill_max_m[0];
  std::vector<double> time{0};
  std::vector<double> front{front_of(fluid->read_state(), fluid->spacing_m()) / a};
  for (int frame = 1; frame <= 75; ++frame) {
    fluid->step_frame();
    if (frame % 3) continue;
    time.push_back(frame * scene.frame_dt_s * std::sqrt(2 * scene.gravity_m_s2 / a));
    front.push_back(front_of(fluid->read_state(), fluid->spacing_m()) / a);
  }
  const auto truth = fluid_test::read_columns("data/truth/martin_moyce_1952_table2_front.csv");
  double shift = 0;
  const double rmse = best_rmse(time, front, truth.at("T"), truth.at("Z"), shift);
  const double largest = *std::max_element(truth.at("Z").begin(), truth.at("Z").end());
  std::printf("Martin and Moyce front: RMSE(Z)/max(Z) = %.4f at a time shift of %.2f\n", rmse / largest,
              shift);
  EXPECT_LE(rmse / largest, 0.05);
}
TEST(MartinMoyce, FrontFollowsTheExperiment) { front_follows_martin_and_moyce(sim::Backend::Cpu); }
TEST(MartinMoyceGpu, FrontFollowsTheExperiment) { front_follows_martin_and_moyce(sim::Backend::Cuda); }

TEST(FreeFall, EqualsSymplecticEuler) {
  auto scene = fluid_test::tank({10, 10, 10}, {10, 10, 10});
  sim::SimulationOptions options;
  options.n_star = 64;
  options.substeps = 1;
  std::vector<ParticleState> start{{0, 0, 5, 10, 5, 0, 0, 0}};
  options.start = start;
  const auto fluid = sim::make_simulation(scene, options);
  constexpr int frames = 60;
  for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
  const double dt = scene.frame_dt_s;
  const auto state = fluid->read_state();
  // z0 - g dt^2 n (n + 1) / 2 (data/truth/free_fall.csv).
  EXPECT_NEAR(static_cast<double>(state[0].y_m), 10 - 9.81 * dt * dt * frames * (frames + 1) / 2, 1e-5);
  EXPECT_NEAR(static_cast<double>(state[0].vy_m_s), -9.81 * dt * frames, 1e-5);
  EXPECT_EQ(state[0].x_m, 5);
}

void settled_dam_keeps_its_height(sim::Backend backend) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  sim::SimulationOptions options;
  options.n_star = 512;
  options.backend = backend;
  const auto fluid = sim::make_simulation(scene, options);
  const auto state = fluid->read_state();
  std::vector<double> heights;
  for (const auto& p : state) heights.push_back(static_cast<double>(p.y_m));
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() * 98 / 100),
                   heights.end());
  const double d = fluid->spacing_m();
  // 98 % of the block's height lie below the 98th percentile of a block that has kept it.
  const double top = heights[heights.size() * 98 / 100] / 0.98;
  std::printf("settled dam: top %.3f m of 7.2, d = %.3f m, centre %.3f m\n", top, d,
              fluid_test::centre_height(state));
  EXPECT_NEAR(top, 7.2, d);
  EXPECT_NEAR(fluid_test::centre_height(state), 3.6, 0.04 * 3.6);
  EXPECT_EQ(fluid_test::outside(state, {9.6, 0, 12.8}, 0.1 * d), 0);
  EXPECT_LT(fluid->report().speed_max_m_s, 1);
}
TEST(SettledDam, KeepsItsHeight) { settled_dam_keeps_its_height(sim::Backend::Cpu); }
TEST(SettledDamGpu, KeepsItsHeight) { settled_dam_keeps_its_height(sim::Backend::Cuda); }

}  // namespace
