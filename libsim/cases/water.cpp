#include "libsim/cases/water.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <unordered_map>

namespace sim::cases {

Scene tank(const Vec3d& size, const Vec3d& water, int settle_frames) {
  Scene scene;
  scene.name = "tank";
  scene.tank_size_m = size;
  scene.water.front().max_m = water;
  scene.settle_frames = settle_frames;
  const double distance = 2 + std::max(size[0], size[1]) / 2;
  scene.view.eye_m = {size[0] / 2, water[1] / 2 + 0.5, size[2] + distance};
  scene.view.target_m = {size[0] / 2, water[1] / 2, size[2] / 2};
  return scene;
}

double even_layers(double layers) { return 2 * d * std::max(1.0, std::round(layers / 2)); }

int start_level(MethodKind method) { return traits_of(method).start_level; }
double start_spacing(MethodKind method) { return d * std::cbrt(1 << start_level(method)); }

State block(MethodKind method, const Vec3d& low, const Vec3d& high, const Vec3d& velocity, int first_id) {
  const double spacing = start_spacing(method);
  const auto count = [&](std::size_t axis) {
    return static_cast<int>(std::lround((high[axis] - low[axis]) / spacing));
  };
  const int nx = count(0), ny = count(1), nz = count(2);
  const auto f = [](double value) { return static_cast<float>(value); };
  const auto at = [&](std::size_t axis, int k) { return f(low[axis] + spacing * (k + 0.5)); };
  State out;
  for (int i = 0; i < nx * ny * nz; ++i) {
    out.push_back({first_id + i, start_level(method), at(0, i % nx), at(1, i / nx / nz), at(2, i / nx % nz),
                   f(velocity[0]), f(velocity[1]), f(velocity[2])});
  }
  return out;
}

double mass(const ParticleState& p) { return 1 << p.level; }

double mass(const State& state) {
  double sum = 0;
  for (const auto& p : state) sum += mass(p);
  return sum;
}

double speed(const ParticleState& p) {
  return std::hypot(static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                    static_cast<double>(p.vz_m_s));
}

double centre_height(const State& state) {
  double sum = 0;
  for (const auto& p : state) sum += mass(p) * static_cast<double>(p.y_m);
  return sum / mass(state);
}

double kinetic_energy(const State& state) {
  double sum = 0;
  for (const auto& p : state) sum += mass(p) * 0.5 * speed(p) * speed(p);
  return sum;
}

double rms_speed(const State& state) { return std::sqrt(2 * kinetic_energy(state) / mass(state)); }

double height_of_share(const State& state, double share) {
  std::vector<std::pair<float, double>> heights;
  for (const auto& p : state) heights.emplace_back(p.y_m, mass(p));
  std::sort(heights.begin(), heights.end());
  double below = 0;
  const double wanted = share * mass(state);
  for (const auto& [height, m] : heights) {
    below += m;
    if (below >= wanted) return static_cast<double>(height);
  }
  return 0;
}

int outside(const State& state, const Vec3d& size, double tolerance_m) {
  int count = 0;
  for (const auto& p : state) {
    const auto x = static_cast<double>(p.x_m), y = static_cast<double>(p.y_m), z = static_cast<double>(p.z_m);
    const bool inside = x >= -tolerance_m && x <= size[0] + tolerance_m && z >= -tolerance_m &&
                        z <= size[2] + tolerance_m && y >= -tolerance_m && std::isfinite(y);
    count += !inside;
  }
  return count;
}

std::vector<double> nearest_distances(const State& state) {
  constexpr double most = 2;
  double widest = 0;
  for (const auto& p : state) widest = std::max(widest, d * std::cbrt(mass(p)));
  // Cells as wide as the search radius; at most 2^20 of them per side.
  const double edge = most * widest;
  const auto cell = [&](float x) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(x) / edge));
  };
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) { return (x << 42) + (y << 21) + z; };
  std::unordered_map<std::int64_t, std::vector<std::size_t>> cells;
  std::vector<double> nearest(state.size(), most);
  for (std::size_t i = 0; i < state.size(); ++i) {
    const auto& a = state[i];
    for (int n = 0; n < 27; ++n) {
      const auto found =
          cells.find(key(cell(a.x_m) + n % 3 - 1, cell(a.y_m) + n / 3 % 3 - 1, cell(a.z_m) + n / 9 - 1));
      if (found == cells.end()) continue;
      for (const std::size_t j : found->second) {
        const auto& b = state[j];
        const double apart =
            std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m),
                       static_cast<double>(a.z_m - b.z_m));
        const double ratio = apart / (d * 0.5 * (std::cbrt(mass(a)) + std::cbrt(mass(b))));
        nearest[i] = std::min(nearest[i], ratio);
        nearest[j] = std::min(nearest[j], ratio);
      }
    }
    cells[key(cell(a.x_m), cell(a.y_m), cell(a.z_m))].push_back(i);
  }
  std::sort(nearest.begin(), nearest.end());
  return nearest;
}

const Pool& settled_pool(Backend backend) {
  static std::map<Backend, Pool> pools;
  static std::mutex one;
  const std::lock_guard lock(one);
  const auto found = pools.find(backend);
  if (found != pools.end()) return found->second;
  Pool out;
  out.scene = tank({4.8, 4, 2.4}, {4.8, 1.2, 2.4}, 60);
  out.scene.view.eye_m = {2.4, 1.6, 5.2};
  out.scene.view.target_m = {2.4, 0.6, 1.2};
  SimulationOptions options;
  options.n_star = Pool::n_star;
  options.backend = backend;
  out.state = make_simulation(out.scene, options)->read_state();
  return pools.emplace(backend, std::move(out)).first->second;
}

Looks look_at(const Scene& scene, const Vec3d& point, bool valid) {
  const Vec3d& eye = scene.view.eye_m;
  const Vec3d way{point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]};
  return {{{{eye, way, valid}, make_view(scene.view, 320, 240), nullptr}}};
}

}  // namespace sim::cases
