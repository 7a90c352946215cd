#include "libsim/scene/fill.hpp"

#include <algorithm>
#include <cmath>

namespace sim {

Resolution resolution_of(const Scene& scene, MethodKind method, std::int64_t n_star) {
  double volume = 1;
  for (std::size_t k = 0; k < 3; ++k) volume *= scene.fill_max_m[k] - scene.fill_min_m[k];
  Resolution out;
  out.finest_spacing_m = std::cbrt(volume / static_cast<double>(8 * n_star));
  out.level = traits_of(method).start_level;
  out.spacing_m = out.finest_spacing_m * std::cbrt(1 << out.level);
  return out;
}

Scene acting_scene(Scene scene, int finest_level) {
  scene.effects = acting_effects(scene.effects, finest_level);
  return scene;
}

// The particles at the start are the finest of the run.
Scene acting_scene(Scene scene, MethodKind method) {
  return acting_scene(std::move(scene), traits_of(method).start_level);
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
  for (const Obstacle& obstacle : scene.obstacles)
    std::erase_if(out, [&](const Vec3d& x) { return holds(obstacle, obstacle.start, x); });
  return out;
}

int substeps_of(const Scene& scene, std::int64_t n_star) {
  const double radius = resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m / 2;
  // The rule is given in round numbers; without the margin 1/60 s would round one case up.
  const double steps = scene.v_ref_m_s * scene.frame_dt_s / (0.5 * 4 * radius);
  return std::max(scene.min_substeps, static_cast<int>(std::ceil(steps - 1e-9)));
}

double viscosity_of(const Scene& scene, std::int64_t n_star) {
  if (scene.viscosity_m2_s >= 0) return scene.viscosity_m2_s;
  const double support = 4 * resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  return 0.05 * support * std::sqrt(scene.gravity_m_s2 * support);
}

Scales scales_of(const Scene& scene, std::int64_t n_star) {
  Scales out;
  out.length_m = scene.fill_max_m[0] - scene.fill_min_m[0];
  for (std::size_t k = 1; k < 3; ++k)
    out.length_m = std::min(out.length_m, scene.fill_max_m[k] - scene.fill_min_m[k]);
  out.speed_m_s = scene.v_ref_m_s;
  const auto tension = static_cast<double>(coefficients_of(scene.effects)[EffectKind::Cohesion]);
  const auto over = [](double what, double by) { return what == 0 ? 0 : what / by; };
  const double inertia = rest_density_kg_m3 * out.speed_m_s * out.speed_m_s;
  const double weight = rest_density_kg_m3 * scene.gravity_m_s2 * out.length_m;
  out.viscosity_m2_s = viscosity_of(scene, n_star) +
                       static_cast<double>(coefficients_of(scene.effects)[EffectKind::Viscosity]);
  out.reynolds = over(out.speed_m_s * out.length_m, out.viscosity_m2_s);
  out.weber = over(inertia * out.length_m, tension);
  out.bond = over(weight * out.length_m, tension);
  return out;
}

}  // namespace sim
