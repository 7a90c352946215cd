/// A dam strikes a wall: time of the impact and pressure afterwards (Lobovsky et al. 2014).

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// Mean of y over the times from .. to.
double plateau_of(const std::vector<double>& t, const std::vector<double>& y, double from, double to) {
  double sum = 0;
  for (int k = 0; k < 100; ++k) sum += interpolate(t, y, from + (k + 0.5) / 100 * (to - from));
  return sum / 100;
}
double first_above(const std::vector<double>& t, const std::vector<double>& y, double level) {
  for (std::size_t i = 1; i < t.size(); ++i)
    if (y[i] > level) return t[i - 1] + (level - y[i - 1]) / (y[i] - y[i - 1]) * (t[i] - t[i - 1]);
  return 0;
}

/// The gauge is three spacings high and as wide as the wall; the real sensor had some millimetres.
void dam_strikes(Run run, const TruthFile& file, std::int64_t n_star) {
  const auto scene = sim::read_scene(scene_of(file));
  sim::SimulationOptions options;
  options.backend = run.backend;
  options.method = run.method;
  options.n_star = n_star;
  const double height = scene.water.front().max_m[1], unit = std::sqrt(height / scene.gravity_m_s2);
  const double d = sim::resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  const Vec3d& tank = scene.tank_size_m;
  options.gauges = {{"sensor", sim::Wall::HighX, {tank[0], 0, 0}, {tank[0], 3 * d, tank[2]}}};
  const auto fluid = sim::make_simulation(scene, options);
  const Axis x = file.time();
  const auto &t_ref = file.column(x.column), &p_ref = file.column(file.pressure());
  const double from = file.number("plateau_from"), to = file.number("plateau_to");
  std::vector<double> time{0}, pressure{0};
  while (time.back() < to) {
    fluid->step_frame();
    const double area = sim::area_m2(options.gauges[0], tank);
    time.push_back(fluid->frame() * scene.frame_dt_s / unit * x.factor);
    pressure.push_back(fluid->momentum().gauges[0].sum() /
                       (scene.frame_dt_s * area * 1000 * scene.gravity_m_s2 * height));
  }
  const double plateau_ref = plateau_of(t_ref, p_ref, from, to),
               plateau = plateau_of(time, pressure, from, to);
  const double impact_ref = first_above(t_ref, p_ref, plateau_ref / 2),
               impact = first_above(time, pressure, plateau_ref / 2);
  std::printf(
      "%s, %s, n_* %lld: impact at %.3f where %.3f (off by %+.4f), plateau %.3f rho g H where %.3f (off by "
      "%+.3f), peak %.2f where %.2f; %lld particles of %lld\n",
      file.name().c_str(), run.name().c_str(), static_cast<long long>(n_star), impact, impact_ref,
      impact / impact_ref - 1, plateau, plateau_ref, plateau / plateau_ref - 1,
      *std::max_element(pressure.begin(), pressure.end()), *std::max_element(p_ref.begin(), p_ref.end()),
      static_cast<long long>(fluid->particle_count()), static_cast<long long>(8 * n_star));
  expect_within(std::abs(impact / impact_ref - 1), file.gate("gate", run.ours()),
                file.name() + ", impact, " + run.name());
  expect_within(std::abs(plateau / plateau_ref - 1), file.gate("gate_plateau", run.ours()),
                file.name() + ", plateau, " + run.name());
}

void dams_strike(Run run, std::int64_t n_star) {
  const auto files = truth_of("wall_pressure");
  if (files.empty()) GTEST_SKIP() << "no file of a stroke on a wall";
  for (const auto& file : files) dam_strikes(run, file, n_star);
}
TEST(TruthImpact, HiResStrikesTheWall) { dams_strike({Backend::Cpu, MethodKind::HiRes}, 512); }
TEST(TruthImpact, OursStrikesTheWall) { dams_strike({Backend::Cpu, MethodKind::Ours}, 512); }
TEST(TruthImpactGpu, HiResStrikesTheWall) { dams_strike({Backend::Cuda, MethodKind::HiRes}, 16 * 1024); }
TEST(TruthImpactGpu, OursStrikesTheWall) { dams_strike({Backend::Cuda, MethodKind::Ours}, 16 * 1024); }

}  // namespace
