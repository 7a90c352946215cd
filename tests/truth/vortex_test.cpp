/// Upright vortices in a tank: the method's own viscosity. The pool needs g depth >= 2 U^2, because a
/// unilateral constraint cannot hold negative pressure.

#include "tests/truth/lamb_oseen.hpp"

namespace {

using namespace truth_test;

constexpr double speed = 1;  ///< m/s, the largest at the start

/// Bound of the viscosity that a method has in addition to the given nu, over d U (spacing times largest
/// speed). Measured: 0.10 to 0.23, at two substeps.
constexpr double own_most = 0.35;

void report_viscosity(const Run& run, const TruthFile& file, double nu, double measured, double d,
                      const std::string& rest) {
  std::printf("%s, %s: viscosity %.5f m2/s where %.5f is asked, %.3f d U of its own; %s\n",
              file.name().c_str(), run.name().c_str(), measured, nu, (measured - nu) / (d * speed),
              rest.c_str());
  EXPECT_GE(measured, 0.8 * nu) << file.name() << ", " << run.name();
}

/// Amplitude of `flow` in the water, 1 at the start.
double strength(const State& state, const std::function<Vec3d(const Vec3d&)>& flow) {
  double along = 0, norm = 0;
  for (const auto& p : state) {
    const Vec3d v = velocity(p), e = flow(place(p));
    along += mass(p) * (v[0] * e[0] + v[2] * e[2]);
    norm += mass(p) * (e[0] * e[0] + e[2] * e[2]);
  }
  return along / norm;
}

/// One cell of Taylor-Green vortices between four walls: u = U sin kx cos kz, w = -U cos kx sin kz.
void cell_decays(Run run, const TruthFile& file, int spacings, const State& rest, double length) {
  const double d = length / spacings, k = pi / length;
  const auto flow = [k](const Vec3d& x) {
    return Vec3d{speed * std::sin(k * x[0]) * std::cos(k * x[2]), 0,
                 -speed * std::cos(k * x[0]) * std::sin(k * x[2])};
  };
  const State start = moving(rest, flow);
  const double unit =
      2 * length / speed;  // the file's wavelength and speed are 1; two cells are a wavelength
  const auto scene = fluid_test::tank({length, 2 * length, length}, {});
  for (const double asked : {0.0, file.number("viscosity")}) {
    sim::SimulationOptions options;
    options.viscosity_m2_s = asked * speed * 2 * length;
    // XSPH may remove at most half of a difference per substep: 22 nu dt / h^2 <= 1 / 2.
    options.substeps = std::max(
        2, static_cast<int>(std::ceil(44 * options.viscosity_m2_s * scene.frame_dt_s / (4 * d * d))));
    const auto fluid = start_from(run, scene, d, start, options);
    std::vector<double> time, logs;
    double error = 0;
    while (fluid->frame() < 90) {
      fluid->step_frame();
      time.push_back(fluid->frame() * scene.frame_dt_s);
      const double now = strength(fluid->read_state(), flow);
      logs.push_back(std::log(now));
      error = std::max(error, std::abs(now - interpolate(file.column("t"), file.column("Umax_over_U0"),
                                                         time.back() / unit)));
    }
    const double measured = -fit(time, logs).slope / (2 * k * k);
    report_viscosity(run, file, options.viscosity_m2_s, measured, d,
                     std::to_string(spacings) + " spacings a cell, speed off by " + std::to_string(error) +
                         " U, " + share(*fluid, start));
    if (asked > 0) {
      expect_within(error, file.gate("gate", run.ours()), file.name() + ", " + run.name());
    } else {
      EXPECT_LE(measured, own_most * d * speed) << file.name() << ", " << run.name();
    }
  }
}

void cells_decay(Backend backend, int spacings) {
  constexpr double length = 0.8;
  const auto files = truth_of("taylor_green");
  if (files.empty()) GTEST_SKIP() << "no file of Taylor and Green's vortices";
  const State rest = settled(backend, {length, length, length}, length / spacings, 40);
  for (const auto& file : files)
    for (const auto method : methods) cell_decays({backend, method}, file, spacings, rest, length);
}
TEST(TruthVortex, TaylorGreenCellDecays) { cells_decay(Backend::Cpu, 16); }
TEST(TruthVortexGpu, TaylorGreenCellDecays) { cells_decay(Backend::Cuda, 48); }

/// The core grows as c^2 + 4 nu t.
void core_grows(Run run, const TruthFile& file, int spacings, const State& rest, double d) {
  const double c0 = 4 * d, scale = c0 / 0.1;  // the file's core is 0.1, its circulation 1
  const Vortex vortex{spacings * d};
  const State start = moving(rest, [&](const Vec3d& x) {
    Vec3d v = vortex.at(x, c0 * c0);
    for (double& one : v) one *= scale * speed;  // circulation 1 in the file's units of length and speed
    return v;
  });
  sim::SimulationOptions options;
  options.viscosity_m2_s = file.number("viscosity") * scale * speed;
  const auto scene = fluid_test::tank({vortex.width, 1, vortex.width}, {});
  const auto fluid = start_from(run, scene, d, start, options);
  std::vector<double> time{0}, c2{core_of(start, vortex, c0)};
  for (int frame = 10; frame <= 60; frame += 10) {
    while (fluid->frame() < frame) fluid->step_frame();
    time.push_back(frame * scene.frame_dt_s);
    c2.push_back(core_of(fluid->read_state(), vortex, c0));
  }
  const double measured = fit(time, c2).slope / 4;
  EXPECT_LE(measured - options.viscosity_m2_s, own_most * d * speed) << file.name() << ", " << run.name();
  report_viscosity(run, file, options.viscosity_m2_s, measured, d,
                   "core of 4 spacings, " + share(*fluid, start));
}

void cores_grow(Backend backend, int spacings) {
  const double d = 1.6 / spacings;
  const auto files = truth_of("lamb_oseen");
  if (files.empty()) GTEST_SKIP() << "no file of a Lamb-Oseen vortex";
  const State rest = settled(backend, {1.6, 0.4, 1.6}, d, 40);
  for (const auto& file : files)
    for (const auto method : methods) core_grows({backend, method}, file, spacings, rest, d);
}
TEST(TruthVortex, LambOseenCoreGrows) { cores_grow(Backend::Cpu, 32); }
TEST(TruthVortexGpu, LambOseenCoreGrows) { cores_grow(Backend::Cuda, 64); }

}  // namespace
