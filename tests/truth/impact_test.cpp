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

/// The file's sensor as a gauge: at least three spacings high and wide, moved away from floor and side walls
/// where it would cross them. As wide as the wall if the file has no sensor_across_m.
sim::Gauge gauge_of(const TruthFile& file, const Vec3d& tank, double d) {
  const double size = std::max(file.has("sensor_size_m") ? file.number("sensor_size_m") : 0, 3 * d);
  const auto begin = [&](const std::string& key, double wall) {
    const double middle = file.number(key);
    if (middle > wall)
      file.fail(file.keys.at(key).second, key + " is " + file.text(key) + ", outside the scene's tank",
                "give the place in the tank");
    return std::max(std::min(middle + size / 2, wall) - size, 0.0);
  };
  const double low = begin("sensor_height_m", tank[1]);
  if (!file.has("sensor_across_m"))
    return {file.name(), sim::Wall::HighX, {tank[0], low, 0}, {tank[0], low + size, tank[2]}};
  const double near = begin("sensor_across_m", tank[2]);
  return {file.name(), sim::Wall::HighX, {tank[0], low, near}, {tank[0], low + size, near + size}};
}

/// Compares pressures at the file's gauge, over rho g H, with the file; times are in sqrt(H / g).
void compare(const TruthFile& file, const Run& run, std::vector<double> time,
             const std::vector<double>& pressure, const std::string& where) {
  const Axis x = file.time();
  for (double& t : time) t *= x.factor;
  const auto &t_ref = file.column(x.column), &p_ref = file.column(file.pressure());
  const double from = file.number("plateau_from"), to = file.number("plateau_to");
  const double plateau_ref = plateau_of(t_ref, p_ref, from, to),
               plateau = plateau_of(time, pressure, from, to);
  const double impact_ref = first_above(t_ref, p_ref, plateau_ref / 2),
               impact = first_above(time, pressure, plateau_ref / 2);
  std::printf(
      "%s, %s, %s: impact at %.3f where %.3f (off by %+.4f), plateau %.3f rho g H where %.3f (off by %+.3f), "
      "peak %.2f where %.2f\n",
      file.name().c_str(), run.name().c_str(), where.c_str(), impact, impact_ref, impact / impact_ref - 1,
      plateau, plateau_ref, plateau / plateau_ref - 1, *std::max_element(pressure.begin(), pressure.end()),
      *std::max_element(p_ref.begin(), p_ref.end()));
  expect_within(std::abs(impact / impact_ref - 1), file.gate("gate", run.ours()),
                file.name() + ", impact, " + run.name());
  expect_within(std::abs(plateau / plateau_ref - 1), file.gate("gate_plateau", run.ours()),
                file.name() + ", plateau, " + run.name());
}

/// Makes one run of a scene, and compares it with each of `files`, which have a sensor each.
void dam_strikes(Run run, const std::filesystem::path& path, const std::vector<TruthFile>& files,
                 std::int64_t n_star) {
  const auto scene = sim::read_scene(path);
  sim::SimulationOptions options;
  options.backend = run.backend;
  options.method = run.method;
  options.n_star = n_star;
  const double height = scene.water.front().max_m[1], unit = std::sqrt(height / scene.gravity_m_s2.size());
  const double d = sim::resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  double until = 0;
  for (const auto& file : files) {
    options.gauges.push_back(gauge_of(file, scene.tank_size_m, d));
    until = std::max(until, file.number("plateau_to") / file.time().factor);
  }
  const auto fluid = sim::make_simulation(scene, options);
  std::vector<double> time{0};
  std::vector<std::vector<double>> pressure(files.size(), {0});
  while (time.back() < until) {
    fluid->step_frame();
    time.push_back(fluid->frame() * scene.frame_dt_s / unit);
    for (std::size_t k = 0; k < files.size(); ++k) {
      const double area = sim::area_m2(options.gauges[k], scene.tank_size_m);
      pressure[k].push_back(fluid->momentum().gauges[k].sum() /
                            (scene.frame_dt_s * area * 1000 * scene.gravity_m_s2.size() * height));
    }
  }
  std::printf("%s, n_* %lld: %lld particles of %lld\n", path.filename().c_str(),
              static_cast<long long>(n_star), static_cast<long long>(fluid->particle_count()),
              static_cast<long long>(8 * n_star));
  for (std::size_t k = 0; k < files.size(); ++k) {
    const sim::Gauge& gauge = options.gauges[k];
    std::ostringstream where;
    where << "from " << gauge.min_m[1] << " to " << gauge.max_m[1] << " m above the floor";
    compare(files[k], run, time, pressure[k], where.str());
  }
}

void dams_strike(Run run, std::int64_t n_star) {
  std::map<std::filesystem::path, std::vector<TruthFile>> by_scene;
  for (auto& file : truth_of("wall_pressure")) by_scene[scene_of(file)].push_back(file);
  if (by_scene.empty()) GTEST_SKIP() << "no file of a stroke on a wall";
  for (const auto& [scene, files] : by_scene) dam_strikes(run, scene, files, n_star);
}

TEST(TruthImpact, ASensorIsMeasuredAtItsOwnPlace) {
  const auto gauge = [](const std::string& sensor) {
    const std::string head = "# quantity: wall_pressure\n# gate: none\n# source: a book\n";
    return gauge_of(parse_truth("f.csv", head + sensor + "T,P\n0,1\n"), {2, 0.5, 0.25}, 0.0625);
  };
  const Vec3d end{2, 0.1875, 0.25};
  EXPECT_EQ(gauge("# sensor_height_m: 0.003\n").min_m, (Vec3d{2, 0, 0}));
  EXPECT_EQ(gauge("# sensor_height_m: 0.003\n").max_m, end) << "three spacings from the floor up";
  const auto high = gauge("# sensor_height_m: 0.125\n# sensor_across_m: 0.1875\n");
  EXPECT_EQ(high.min_m, (Vec3d{2, 0.03125, 0.0625}));
  EXPECT_EQ(high.max_m, (Vec3d{2, 0.21875, 0.25})) << "it ends at the side wall";
  const auto large = gauge("# sensor_height_m: 0.375\n# sensor_size_m: 0.25\n");
  EXPECT_EQ(large.min_m, (Vec3d{2, 0.25, 0}));
  EXPECT_EQ(large.max_m, (Vec3d{2, 0.5, 0.25}));
  EXPECT_THROW(gauge("# sensor_height_m: 0.6\n"), base::Error);
}
TEST(TruthImpact, HiResStrikesTheWall) { dams_strike({Backend::Cpu, MethodKind::HiRes}, 512); }
TEST(TruthImpact, OursStrikesTheWall) { dams_strike({Backend::Cpu, MethodKind::Ours}, 512); }
TEST(TruthImpactGpu, HiResStrikesTheWall) { dams_strike({Backend::Cuda, MethodKind::HiRes}, 16 * 1024); }
TEST(TruthImpactGpu, OursStrikesTheWall) { dams_strike({Backend::Cuda, MethodKind::Ours}, 16 * 1024); }

}  // namespace
