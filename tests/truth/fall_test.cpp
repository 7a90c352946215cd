/// Free fall, and a column at rest.

#include "stats/inference/linear_fit.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// One particle falls from the file's first height. The error must be that of symplectic Euler, g dt t / 2.
void particle_falls(Run run, const TruthFile& file) {
  const auto& times = file.column("t");
  const auto& heights = file.column("z");
  auto scene = fluid_test::tank({10, 10, 10}, {});
  sim::SimulationOptions options;
  options.substeps = 1;
  const State start{{0, 0, 5, static_cast<float>(heights.front()), 5, 0, 0, 0}};
  const auto fluid = start_from(run, scene, 0.15, start, options);
  const double dt = scene.frame_dt_s;
  double off_euler = 0, off_truth = 0;
  while (fluid->frame() * dt < times.back() - 1e-9) {
    fluid->step_frame();
    const auto state = fluid->read_state();
    const int n = fluid->frame();
    const double z = place(state[0])[1];
    off_euler = std::max(off_euler, std::abs(heights.front() - gravity * dt * dt * n * (n + 1) / 2 - z));
    for (std::size_t i = 0; i < times.size(); ++i)
      if (std::abs(times[i] - n * dt) < 1e-9) off_truth = std::max(off_truth, heights[i] - z);
    EXPECT_EQ(state[0].x_m, 5);
    EXPECT_NEAR(velocity(state[0])[1], -gravity * dt * n, 1e-4);
  }
  std::printf("%s, %s: %.1e m off symplectic Euler, %.4f m below the parabola, where g dt t / 2 is %.4f m\n",
              file.name().c_str(), run.name().c_str(), off_euler, off_truth, gravity * dt * times.back() / 2);
  expect_within(off_euler, file.gate("gate", run.ours()), file.name() + ", " + run.name());
  EXPECT_NEAR(off_truth, gravity * dt * times.back() / 2, 1e-4);
}
void particles_fall(Backend backend) {
  const auto files = truth_of("free_fall");
  if (files.empty()) GTEST_SKIP() << "no file of free fall";
  for (const auto& file : files)
    for (const auto method : methods) particle_falls({backend, method}, file);
}
TEST(TruthFall, EqualsSymplecticEuler) { particles_fall(Backend::Cpu); }
TEST(TruthFallGpu, EqualsSymplecticEuler) { particles_fall(Backend::Cuda); }

/// A projectile after 0.8 s, with four frame steps: its distance from the parabola, and the order of that
/// error in the step. In theory symplectic Euler has order 1.
void projectile_is_of_first_order(Run run) {
  constexpr double end_s = 0.8, up = 4, along = 3;
  const auto scene = fluid_test::tank({10, 10, 10}, {});
  const State start{{0, 0, 2, 5, 5, static_cast<float>(along), static_cast<float>(up), 0}};
  std::vector<double> log_dt, log_error;
  for (const int rate : {30, 60, 120, 240}) {
    sim::SimulationOptions options;
    options.substeps = 1;
    options.frame_dt_s = 1.0 / rate;
    const auto fluid = start_from(run, scene, 0.15, start, options);
    for (int frame = 0; frame < end_s * rate - 0.5; ++frame) fluid->step_frame();
    const auto at = place(fluid->read_state()[0]);
    const double error =
        std::hypot(at[0] - (2 + along * end_s), at[1] - (5 + up * end_s - gravity * end_s * end_s / 2));
    EXPECT_NEAR(error, gravity * end_s / (2 * rate), 2e-5) << rate;
    log_dt.push_back(-std::log(rate));
    log_error.push_back(std::log(error));
  }
  const auto fit = stats::fit_linear({log_dt}, log_error);
  ASSERT_TRUE(fit);
  std::printf("projectile, %s: %.4f m off at 30 frames/s, %.4f m at 240; order %.4f\n", run.name().c_str(),
              std::exp(log_error.front()), std::exp(log_error.back()), fit->coefficients[1]);
  EXPECT_NEAR(fit->coefficients[1], 1, 0.005);
}
TEST(TruthProjectile, IsOfFirstOrderInTheStep) {
  for (const auto method : methods) projectile_is_of_first_order({Backend::Cpu, method});
}
TEST(TruthProjectileGpu, IsOfFirstOrderInTheStep) {
  for (const auto method : methods) projectile_is_of_first_order({Backend::Cuda, method});
}

/// Mean pressure on the floor and on bands of one wall, from impulses, against rho g (H - z).
void column_rests(Run run, const TruthFile& file, int layers, const State& rest, double d) {
  const double height = layers * d, width = 10 * d, full = 1000 * gravity * height;
  constexpr int bands = 6, frames = 30;
  sim::SimulationOptions options;
  options.gauges.push_back({"floor", sim::Wall::Floor, {0, 0, 0}, {width, 0, width}});
  for (int k = 0; k < bands; ++k)
    options.gauges.push_back(
        {"band", sim::Wall::HighX, {0, k * height / bands, 0}, {0, (k + 1) * height / bands, width}});
  const auto scene = fluid_test::tank({width, 2 * height, width}, {});
  const auto fluid = start_from(run, scene, d, rest, options);
  for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
  double centre = 0;
  std::vector<double> pressure(options.gauges.size(), 0);
  for (int frame = 0; frame < frames; ++frame) {
    fluid->step_frame();
    centre += mean(fluid->read_state(), [](const auto& p) { return place(p)[1]; }) / frames;
    const auto account = fluid->momentum();
    for (std::size_t g = 0; g < pressure.size(); ++g)
      pressure[g] += account.gauges[g].sum() /
                     (frames * scene.frame_dt_s * sim::area_m2(options.gauges[g], scene.room_m()));
  }
  const double lost = 1 - centre / (height / 2);
  double worst = 0;
  for (int k = 0; k < bands; ++k) {
    const double z = (k + 0.5) / bands;
    const double asked =
        interpolate(file.column("z_over_H"), file.column("p_Pa_for_H_1m"), z) / (1000 * gravity);
    worst = std::max(worst, std::abs(pressure[static_cast<std::size_t>(k) + 1] / full - asked));
  }
  std::printf(
      "%s, %s, %d layers: centre of mass lower by %.4f of H / 2; floor feels %.4f of rho g H, a wall's six "
      "bands off by %.4f of it at most; %s\n",
      file.name().c_str(), run.name().c_str(), layers, lost, pressure[0] / full, worst,
      share(*fluid, rest).c_str());
  expect_within(std::abs(lost), file.gate("gate", run.ours()), file.name() + ", " + run.name());
  expect_within(std::abs(pressure[0] / full - 1), 0.03, file.name() + ", weight on the floor, " + run.name());
  expect_within(worst, file.gate("gate_pressure", run.ours()), file.name() + ", pressure, " + run.name());
}

void columns_rest(Backend backend, int layers) {
  const auto files = truth_of("column_at_rest");
  if (files.empty()) GTEST_SKIP() << "no file of a column at rest";
  const double d = 1.2 / layers;
  const State rest = settled(backend, {10 * d, 1.2, 10 * d}, d, 60);
  for (const auto& file : files)
    for (const auto method : methods) column_rests({backend, method}, file, layers, rest, d);
}
TEST(TruthColumn, KeepsItsHeightAndItsWeight) { columns_rest(Backend::Cpu, 24); }
TEST(TruthColumnGpu, KeepsItsHeightAndItsWeight) { columns_rest(Backend::Cuda, 80); }

}  // namespace
