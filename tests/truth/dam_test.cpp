/// Plane dams on a dry bed: front and column height over time, against experiments (Martin and Moyce 1952).

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// Front and height in units of the base a, over t sqrt(g / a).
struct Collapse {
  std::vector<double> time, front, height;
  std::int64_t particles = 0;
};

/// True for particles with at least five neighbours within the mean of the two supports.
std::vector<bool> in_water(const State& state, double d) {
  const auto support = [&](const ParticleState& p) { return 2 * d * std::cbrt(mass(p)); };
  double widest = 0;
  for (const auto& p : state) widest = std::max(widest, support(p));
  using Cell = std::array<int, 3>;
  const auto cell = [&](const ParticleState& p) {
    const Vec3d x = place(p);
    return Cell{static_cast<int>(std::floor(x[0] / widest)), static_cast<int>(std::floor(x[1] / widest)),
                static_cast<int>(std::floor(x[2] / widest))};
  };
  std::map<Cell, std::vector<const ParticleState*>> cells;
  for (const auto& p : state) cells[cell(p)].push_back(&p);
  std::vector<bool> out;
  for (const auto& p : state) {
    int count = -1;  // excludes the particle itself
    const Cell c = cell(p);
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find({c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      for (const auto* q : found->second) {
        const Vec3d a = place(p), b = place(*q);
        count += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) < (support(p) + support(*q)) / 2;
      }
    }
    out.push_back(count >= 5);
  }
  return out;
}

/// Front: 99.5th percentile, by mass, of x + r over particles in water.
double front_of(const State& state, double d) {
  const auto wet = in_water(state, d);
  std::vector<std::pair<double, double>> edges;
  double sum = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (!wet[i]) continue;
    edges.emplace_back(place(state[i])[0] + d / 2 * std::cbrt(mass(state[i])), mass(state[i]));
    sum += mass(state[i]);
  }
  std::sort(edges.begin(), edges.end());
  double below = 0;
  for (const auto& [x, m] : edges) {
    below += m;
    if (below >= 0.995 * sum) return x;
  }
  return 0;
}

/// Mean depth over the first quarter of the base, by volume.
double height_of(const State& state, double d, const Vec3d& base) {
  double volume = 0;
  for (const auto& p : state) volume += place(p)[0] < base[0] / 4 ? mass(p) * d * d * d : 0;
  return volume / (base[0] / 4 * base[2]);
}

Collapse collapse(const Run& run, const std::filesystem::path& path, std::int64_t n_star, double until) {
  const auto scene = sim::read_scene(path);
  sim::SimulationOptions options;
  options.backend = run.backend;
  options.method = run.method;
  options.n_star = n_star;
  const auto fluid = sim::make_simulation(scene, options);
  const Vec3d base = scene.water.front().max_m;
  const double unit = std::sqrt(base[0] / scene.gravity_m_s2.size()),
               d = sim::resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  Collapse out;
  const auto look = [&] {
    const auto state = fluid->read_state();
    out.time.push_back(fluid->frame() * scene.frame_dt_s / unit);
    out.front.push_back(front_of(state, d) / base[0]);
    out.height.push_back(height_of(state, d, base) / base[0]);
  };
  look();
  while (out.time.back() < until) {
    for (int k = 0; k < 3; ++k) fluid->step_frame();
    look();
  }
  out.particles = fluid->particle_count();
  return out;
}

/// Compares the front or the height of a run, whichever the file has, with the file, in the file's own
/// scales.
void compare(const TruthFile& file, const Run& run, const Collapse& dam, std::int64_t n_star) {
  const Axis x = file.time(), y = file.length();
  auto time = dam.time, value = file.quantity == "dam_front" ? dam.front : dam.height;
  for (auto& t : time) t *= x.factor;
  for (auto& v : value) v *= y.factor;
  const double most = file.has("shift") ? file.number("shift") : 0;
  const Match match = best_match(time, value, file.column(x.column), file.column(y.column), most);
  std::printf(
      "%s, %s, n_* %lld: RMSE %.4f of the largest %s at a time shift of %.2f; %lld particles of %lld\n",
      file.name().c_str(), run.name().c_str(), static_cast<long long>(n_star), match.error, y.column.c_str(),
      match.shift, static_cast<long long>(dam.particles), static_cast<long long>(8 * n_star));
  expect_within(match.error, file.gate("gate", run.ours()), file.name() + ", " + run.name());
}

void dams_follow_experiments(Run run, std::int64_t n_star) {
  std::map<std::filesystem::path, std::vector<TruthFile>> by_scene;
  for (const char* quantity : {"dam_front", "dam_height"})
    for (auto& file : truth_of(quantity)) by_scene[scene_of(file)].push_back(file);
  if (by_scene.empty()) GTEST_SKIP() << "no file of a dam";
  for (const auto& [scene, files] : by_scene) {
    double until = 0;
    for (const auto& file : files) {
      const auto& times = file.column(file.time().column);
      until = std::max(until, (*std::max_element(times.begin(), times.end()) + 0.2) / file.time().factor);
    }
    const Collapse dam = collapse(run, scene, n_star, until);
    for (const auto& file : files) compare(file, run, dam, n_star);
  }
}
TEST(TruthDam, HiResFollowsTheExperiments) {
  dams_follow_experiments({Backend::Cpu, MethodKind::HiRes}, 512);
}
TEST(TruthDam, OursFollowsTheExperiments) { dams_follow_experiments({Backend::Cpu, MethodKind::Ours}, 512); }
TEST(TruthDamGpu, HiResFollowsTheExperiments) {
  dams_follow_experiments({Backend::Cuda, MethodKind::HiRes}, 16 * 1024);
}
TEST(TruthDamGpu, OursFollowsTheExperiments) {
  dams_follow_experiments({Backend::Cuda, MethodKind::Ours}, 16 * 1024);
}

/// Depth of the water within one spacing of x, by volume, in a slab `width` wide.
double depth_at(const State& state, double x, double d, double width) {
  double volume = 0;
  for (const auto& p : state) volume += std::abs(place(p)[0] - x) < d ? mass(p) * d * d * d : 0;
  return volume / (2 * d * width);
}

/// Ritter's shallow-water solution: depth over the bed, without the tip, where friction dominates.
void dam_spreads(Run run, const TruthFile& file, int layers) {
  const auto &times = file.column("t_s"), &places = file.column("x_m"), &depths = file.column("h_m");
  const double deep = file.number("length_m"), end = *std::max_element(times.begin(), times.end());
  const double d = 0.8 / layers, height = layers * d, width = 6 * d;
  const double scale = height / deep,
               pace = std::sqrt(scale);  // the run's metres and seconds per unit of the file
  const double c = std::sqrt(gravity * height), ahead = c * end * pace;
  const double dam = d * std::ceil(1.1 * ahead / d);
  const State start = settled(run.backend, {dam, height, width}, d, 40);
  const auto scene = fluid_test::tank({dam + 2.5 * ahead, 2 * height, width}, {});
  const auto fluid = start_from(run, scene, d, start);
  double sum = 0, time = 0, front = dam;
  int points = 0;
  while (time < end * pace - 1e-9) {
    fluid->step_frame();
    const auto state = fluid->read_state();
    const double before = time;
    time = fluid->frame() * scene.frame_dt_s;
    front = front_of(state, d);
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (times[i] * pace <= before || times[i] * pace > time || depths[i] < 0.1 * deep) continue;
      sum += std::pow(depth_at(state, dam + places[i] * scale, d, width) / height - depths[i] / deep, 2);
      ++points;
    }
  }
  const double error = std::sqrt(sum / points);
  std::printf(
      "%s, %s, %d layers: depth off by %.4f of the reservoir's (RMS of %d points), front at %.3f of 2 c t; "
      "%s\n",
      file.name().c_str(), run.name().c_str(), layers, error, points, (front - dam) / (2 * c * time),
      share(*fluid, start).c_str());
  expect_within(error, file.gate("gate", run.ours()), file.name() + ", " + run.name());
  EXPECT_LE((front - dam) / (2 * c * time), 1) << file.name() << ": no front outruns 2 c";
}
void dams_spread(Backend backend, int layers) {
  const auto files = truth_of("dam_profile");
  if (files.empty()) GTEST_SKIP() << "no file of a dam's profile";
  for (const auto& file : files)
    for (const auto method : methods) dam_spreads({backend, method}, file, layers);
}
TEST(TruthDam, SpreadsAsShallowWater) { dams_spread(Backend::Cpu, 16); }
TEST(TruthDamGpu, SpreadsAsShallowWater) { dams_spread(Backend::Cuda, 48); }

}  // namespace
