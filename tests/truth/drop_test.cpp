/// Drops without gravity, as slabs between two smooth walls: an elliptical drop (Monaghan 1994).

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

/// Half axis of an ellipse of even density: twice the root of its second moment.
double half_axis(const State& state, std::size_t axis) {
  const double middle = mean(state, [&](const auto& p) { return place(p)[axis]; });
  return 2 * std::sqrt(mean(state, [&](const auto& p) { return std::pow(place(p)[axis] - middle, 2); }));
}

void drop_stretches(Run run, const TruthFile& file, int spacings) {
  const auto& times = file.column("t_s");
  const auto& b = file.column("b_major");
  const double strain = file.column("A_strain").front();
  Disc disc(spacings, 1);  // a run's second is as long as it takes to strain by 1
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
TEST(TruthDrop, EllipticalDropStretches) { drops_stretch(Backend::Cpu, 16); }
TEST(TruthDropGpu, EllipticalDropStretches) { drops_stretch(Backend::Cuda, 48); }

}  // namespace
