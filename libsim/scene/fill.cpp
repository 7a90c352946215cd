#include "libsim/scene/fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sim {

double volume_m3(const WaterBlock& block) {
  double out = 1;
  for (std::size_t k = 0; k < 3; ++k) out *= block.max_m[k] - block.min_m[k];
  return out;
}

double water_volume_m3(const Scene& scene) {
  double out = 0;
  for (const WaterBlock& block : scene.water) out += volume_m3(block);
  return out;
}

Resolution resolution_of(const Scene& scene, MethodKind method, std::int64_t n_star) {
  Resolution out;
  out.finest_spacing_m = std::cbrt(water_volume_m3(scene) / static_cast<double>(8 * n_star));
  out.level = traits_of(method).start_level;
  out.spacing_m = out.finest_spacing_m * std::cbrt(1 << out.level);
  return out;
}

Scene acting_scene(Scene scene, int finest_level) {
  scene.effects = acting_effects(scene.effects, finest_level);
  return scene;
}

// The start level is the finest level of a run: no particle becomes finer than those at the start.
Scene acting_scene(Scene scene, MethodKind method) {
  return acting_scene(std::move(scene), traits_of(method).start_level);
}

namespace {

/// Number of particles of each block: its share of `all` by volume, rounded by largest remainders.
std::vector<std::int64_t> counts_of(const std::vector<WaterBlock>& water, std::int64_t all) {
  double volume = 0;
  for (const WaterBlock& block : water) volume += volume_m3(block);
  std::vector<std::int64_t> out;
  std::vector<std::pair<double, std::size_t>> lacks;
  std::int64_t left = all;
  for (const WaterBlock& block : water) {
    const double wish = static_cast<double>(all) * (volume_m3(block) / volume);
    out.push_back(static_cast<std::int64_t>(wish));
    lacks.emplace_back(static_cast<double>(out.back()) - wish, lacks.size());
    left -= out.back();
  }
  std::sort(lacks.begin(), lacks.end());
  for (std::size_t k = 0; left > 0; ++k, --left) ++out[lacks[k].second];
  return out;
}

void fill_block(const WaterBlock& block, double d, std::int64_t count, std::vector<Vec3d>& out) {
  const double lx = block.max_m[0] - block.min_m[0];
  const double lz = block.max_m[2] - block.min_m[2];
  const auto nx = std::max<std::int64_t>(1, std::llround(lx / d));
  const auto nz = std::max<std::int64_t>(1, std::llround(lz / d));
  const double dx = lx / static_cast<double>(nx);
  const double dz = lz / static_cast<double>(nz);
  const double dy = d * d * d / (dx * dz);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto ix = static_cast<double>(i % nx);
    const auto iz = static_cast<double>(i / nx % nz);
    const auto iy = static_cast<double>(i / (nx * nz));
    out.push_back({block.min_m[0] + (ix + 0.5) * dx, block.min_m[1] + (iy + 0.5) * dy,
                   block.min_m[2] + (iz + 0.5) * dz});
  }
}

}  // namespace

std::vector<Vec3d> fill_positions(const Scene& scene, MethodKind method, std::int64_t n_star) {
  const double d = resolution_of(scene, method, n_star).spacing_m;
  const auto counts = counts_of(scene.water, particle_count(method, n_star));
  std::vector<Vec3d> out;
  out.reserve(static_cast<std::size_t>(particle_count(method, n_star)));
  for (std::size_t b = 0; b < counts.size(); ++b) fill_block(scene.water[b], d, counts[b], out);
  for (const Obstacle& obstacle : scene.obstacles)
    std::erase_if(out, [&](const Vec3d& x) { return holds(obstacle, obstacle.start, x); });
  return out;
}

int substeps_of(const Scene& scene, std::int64_t n_star) {
  const double radius = resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m / 2;
  // The tolerance keeps the rounding of 1/60 s from adding a substep to a quotient that is a whole number.
  const double steps = scene.v_ref_m_s * scene.frame_dt_s / (0.5 * 4 * radius);
  return std::max(scene.min_substeps, static_cast<int>(std::ceil(steps - 1e-9)));
}

double viscosity_of(const Scene& scene, std::int64_t n_star) {
  if (scene.viscosity_m2_s >= 0) return scene.viscosity_m2_s;
  const double support = 4 * resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  return 0.05 * support * std::sqrt(scene.gravity_m_s2.size() * support);
}

Scales scales_of(const Scene& scene, std::int64_t n_star) {
  Scales out;
  out.length_m = std::numeric_limits<double>::infinity();
  for (const WaterBlock& block : scene.water)
    for (std::size_t k = 0; k < 3; ++k)
      out.length_m = std::min(out.length_m, block.max_m[k] - block.min_m[k]);
  out.speed_m_s = scene.v_ref_m_s;
  const auto tension = static_cast<double>(coefficients_of(scene.effects)[EffectKind::Cohesion]);
  const auto over = [](double what, double by) { return what == 0 ? 0 : what / by; };
  const double inertia = rest_density_kg_m3 * out.speed_m_s * out.speed_m_s;
  const double weight = rest_density_kg_m3 * scene.gravity_m_s2.size() * out.length_m;
  out.viscosity_m2_s = viscosity_of(scene, n_star) +
                       static_cast<double>(coefficients_of(scene.effects)[EffectKind::Viscosity]);
  out.reynolds = over(out.speed_m_s * out.length_m, out.viscosity_m2_s);
  out.weber = over(inertia * out.length_m, tension);
  out.bond = over(weight * out.length_m, tension);
  return out;
}

}  // namespace sim
