#include "libsim/scene/fill.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "stats/base/error.hpp"

namespace sim {

namespace {

constexpr double fewest_cells = 1 << 20;

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string metres(double length) { return rounded(length) + " m"; }

constexpr double most_substeps = 1000;

double substeps_wished(const Scene& scene, std::int64_t n_star) {
  const double radius = resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m / 2;
  // The rule is stated in round numbers; without the margin 1/60 s would round one case up.
  return std::ceil(scene.v_ref_m_s * scene.frame_dt_s / (0.5 * 4 * radius) - 1e-9);
}

}  // namespace

Resolution resolution_of(const Scene& scene, MethodKind method, std::int64_t n_star) {
  double volume = 1;
  for (std::size_t k = 0; k < 3; ++k) volume *= scene.fill_max_m[k] - scene.fill_min_m[k];
  Resolution out;
  out.finest_spacing_m = std::cbrt(volume / static_cast<double>(8 * n_star));
  out.level = traits_of(method).start_level;
  out.spacing_m = out.finest_spacing_m * std::cbrt(1 << out.level);
  return out;
}

void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m) {
  const std::string place = "scene " + scene.name + ", n_* " + std::to_string(n_star) + ", ";
  const double finest = resolution_of(scene, method, n_star).finest_spacing_m;
  double cells = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    cells *= scene.tank_size_m[k] / cell_edge_m;
    const double side = scene.fill_max_m[k] - scene.fill_min_m[k];
    if (side < finest) {
      throw base::Error(
          place + "water.max_m",
          "makes the water " + metres(side) + " thin, where particles are " + metres(finest) + " apart",
          "make the water thicker, or use a larger --n-star");
    }
  }
  const double substeps = substeps_wished(scene, n_star);
  if (substeps > most_substeps) {
    throw base::Error(place + "time.v_ref_m_s",
                      "makes " + rounded(substeps) + " substeps a frame, at most " + rounded(most_substeps) +
                          " are computed",
                      "lower it, raise frames_per_s, or use a smaller --n-star");
  }
  const auto particles = static_cast<double>(particle_count(method, n_star));
  const double most = std::max(fewest_cells, 16 * particles);
  if (cells <= most) return;
  throw base::Error(place + "tank.size_m",
                    "makes " + rounded(cells) + " cells of pressure for " + rounded(particles) +
                        " particles, at most " + rounded(most) + " are computed",
                    "make the tank smaller or the water larger");
}

std::vector<Vec3d> fill_positions(const Scene& scene, MethodKind method, std::int64_t n_star) {
  const double d = resolution_of(scene, method, n_star).spacing_m;
  const double lx = scene.fill_max_m[0] - scene.fill_min_m[0];
  const double lz = scene.fill_max_m[2] - scene.fill_min_m[2];
  const auto nx = std::max<std::int64_t>(1, std::llround(lx / d));
  const auto nz = std::max<std::int64_t>(1, std::llround(lz / d));
  const double dx = lx / static_cast<double>(nx);
  const double dz = lz / static_cast<double>(nz);
  const double dy = d * d * d / (dx * dz);
  std::vector<Vec3d> out(static_cast<std::size_t>(particle_count(method, n_star)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    const auto ix = static_cast<double>(index % nx);
    const auto iz = static_cast<double>(index / nx % nz);
    const auto iy = static_cast<double>(index / (nx * nz));
    out[i] = {scene.fill_min_m[0] + (ix + 0.5) * dx, scene.fill_min_m[1] + (iy + 0.5) * dy,
              scene.fill_min_m[2] + (iz + 0.5) * dz};
  }
  return out;
}

int substeps_of(const Scene& scene, std::int64_t n_star) {
  const double steps = std::min(substeps_wished(scene, n_star), most_substeps);
  return std::max(scene.min_substeps, static_cast<int>(steps));
}

}  // namespace sim
