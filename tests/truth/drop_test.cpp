/// Drops without gravity, as slabs between two smooth walls: one that stretches (Monaghan 1994), and one that
/// oscillates in a central force (Monaghan and Rafiee 2013).

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// A disc of `radius` spacings, six thick, in the middle of a tank six radii wide; d = 0.05 m.
struct Disc {
  static constexpr double d = 0.05;
  double radius;
  sim::Scene scene;
  State start;
  Disc(int spacings, double strain) : radius(spacings * d) {
    const double width = 6 * radius, middle = width / 2;
    scene = fluid_test::tank({width, width, 6 * d}, {width, width, 6 * d});
    scene.gravity_m_s2 = 0;
    start = lattice(
        d, scene.tank_size_m,
        [&](const Vec3d& x) { return std::hypot(x[0] - middle, x[1] - middle) < radius; },
        [&](const Vec3d& x) {
          return Vec3d{-strain * (x[0] - middle), strain * (x[1] - middle), 0};
        });
  }
};

/// Half axis of an ellipse of uniform density: twice the root of its second moment.
double half_axis(const State& state, std::size_t axis) {
  const double middle = mean(state, [&](const auto& p) { return place(p)[axis]; });
  return 2 * std::sqrt(mean(state, [&](const auto& p) { return std::pow(place(p)[axis] - middle, 2); }));
}

void drop_stretches(Run run, const TruthFile& file, int spacings) {
  const auto& times = file.column("t_s");
  const auto& b = file.column("b_major");
  const double strain = file.column("A_strain").front();
  Disc disc(spacings, 1);  // one second of the run is the time to strain by 1
  disc.scene.frame_dt_s = 0.02;
  const auto fluid = start_from(run, disc.scene, Disc::d, disc.start, inviscid());
  const double unit = half_axis(disc.start, 1);
  double worst = 0, time = 0, major = 0;
  while (time < times.back() - 1e-9) {
    fluid->step_frame();
    time = fluid->frame() * disc.scene.frame_dt_s / strain;
    major = half_axis(fluid->read_state(), 1) / unit;
    worst = std::max(worst, std::abs(major / interpolate(times, b, time) - 1));
  }
  std::printf("%s, %s, radius of %d spacings: b off by %.4f at most, area off by %+.3f at last; %s\n",
              file.name().c_str(), run.name().c_str(), spacings, worst,
              major * half_axis(fluid->read_state(), 0) / unit - 1, share(*fluid, disc.start).c_str());
  expect_within(worst, file.gate("gate", run.ours()), file.name() + ", " + run.name());
}

void drops_stretch(Backend backend, int spacings) {
  const auto files = truth_of("elliptical_drop");
  if (files.empty()) GTEST_SKIP() << "no file of an elliptical drop";
  for (const auto& file : files)
    for (const auto method : methods) drop_stretches({backend, method}, file, spacings);
}
/// Largest y at the times t in [from, until].
double peak_after(const std::vector<double>& t, const std::vector<double>& y, double from, double until) {
  double out = 0;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (t[i] >= from && t[i] <= until) out = std::max(out, y[i]);
  return out;
}

/// Time of the second upward crossing of 1, the first being the start.
double period_of(const std::vector<double>& t, const std::vector<double>& y) {
  for (std::size_t i = 2; i < t.size(); ++i)
    if (y[i - 1] < 1 && y[i] >= 1) return t[i - 1] + (1 - y[i - 1]) / (y[i] - y[i - 1]) * (t[i] - t[i - 1]);
  return 0;
}

void drop_swings(Run run, const TruthFile& file, int spacings) {
  const auto& times = file.column("t");
  const auto& longs = file.column("A");
  Disc disc(spacings, -file.column("sigma").front());
  disc.scene.central_force = sim::CentralForce{1, {3 * disc.radius, 3 * disc.radius, 0}, {0, 0, 1}};
  const double period = period_of(times, longs);
  const auto fluid = start_from(run, disc.scene, Disc::d, disc.start, inviscid());
  // Uses the ratio of both half axes: jitter that spreads the drop does not change it.
  std::vector<double> time{0}, ratio{1}, ratio_ref;
  for (std::size_t i = 0; i < times.size(); ++i) ratio_ref.push_back(longs[i] / file.column("B")[i]);
  while (time.back() < 1.4 * period) {
    for (int k = 0; k < 2; ++k) fluid->step_frame();
    const auto state = fluid->read_state();
    time.push_back(fluid->frame() * disc.scene.frame_dt_s);
    ratio.push_back(half_axis(state, 0) / half_axis(state, 1));
  }
  const double measured = period_of(time, ratio);
  // A and 1 / B are equal for an incompressible drop, so the root of the ratio is the amplitude.
  const double peak = std::sqrt(peak_after(time, ratio, measured, 2 * period));
  const double swing = (peak - 1) / (std::sqrt(peak_after(times, ratio_ref, period, 2 * period)) - 1);
  std::printf(
      "%s, %s, radius of %d spacings: period off by %+.4f, longest axis %.3f where %.3f (swing %.3f) after a "
      "period; %s\n",
      file.name().c_str(), run.name().c_str(), spacings, measured / period - 1, peak,
      std::sqrt(peak_after(times, ratio_ref, period, 2 * period)), swing, share(*fluid, disc.start).c_str());
  expect_within(std::abs(measured / period - 1), file.gate("gate", run.ours()),
                file.name() + ", period, " + run.name());
  expect_within(std::abs(1 - swing), file.gate("gate_amplitude", run.ours()),
                file.name() + ", amplitude, " + run.name());
}

void drops_swing(Run run, int spacings) {
  const auto files = truth_of("oscillating_drop");
  if (files.empty()) GTEST_SKIP() << "no file of a swinging drop";
  for (const auto& file : files) drop_swings(run, file, spacings);
}
TEST(TruthDrop, HiResSwings) { drops_swing({Backend::Cpu, MethodKind::HiRes}, 12); }
TEST(TruthDrop, OursSwings) { drops_swing({Backend::Cpu, MethodKind::Ours}, 12); }
TEST(TruthDropGpu, HiResSwings) { drops_swing({Backend::Cuda, MethodKind::HiRes}, 48); }
TEST(TruthDropGpu, OursSwings) { drops_swing({Backend::Cuda, MethodKind::Ours}, 48); }
TEST(TruthDrop, EllipticalDropStretches) { drops_stretch(Backend::Cpu, 16); }
TEST(TruthDropGpu, EllipticalDropStretches) { drops_stretch(Backend::Cuda, 48); }

}  // namespace
