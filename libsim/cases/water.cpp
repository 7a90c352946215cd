#include "libsim/cases/water.hpp"

#include <algorithm>
#include <cmath>

namespace sim::cases {

Scene tank(const Vec3d& size, const Vec3d& water, int settle_frames) {
  Scene scene;
  scene.name = "tank";
  scene.tank_size_m = size;
  scene.fill_max_m = water;
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

}  // namespace sim::cases
