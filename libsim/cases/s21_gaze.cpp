/// S21: levels follow a gaze that jumps, is lost and comes back, over water at rest.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

/// Mass of the water in the fovea around a point, in units of m_* (mass of a finest particle), and the share
/// of this mass whose level is at least as fine as its target level.
struct Fovea {
  double mass = 0, share = 0;
};

Fovea fovea_at(const Simulation& fluid, const Scene& scene, const Vec3d& point) {
  const double cosine = std::cos(Readings{}.fovea_half_angle_deg * std::numbers::pi / 180);
  std::vector<ParticleSaliency> saliency;
  std::vector<RenderParticle> places;
  fluid.read_saliency(saliency);
  fluid.read_particles(places);
  const Vec3d& eye = scene.view.eye_m;
  const Vec3d g{point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]};
  Fovea out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3d u{static_cast<double>(places[i].x_m) - eye[0], static_cast<double>(places[i].y_m) - eye[1],
                  static_cast<double>(places[i].z_m) - eye[2]};
    const double along = (u[0] * g[0] + u[1] * g[1] + u[2] * g[2]) / std::hypot(u[0], u[1], u[2]) /
                         std::hypot(g[0], g[1], g[2]);
    if (along < cosine) continue;
    const auto level = std::lround(3 * std::log2(2 * static_cast<double>(places[i].radius_m) / d));
    out.mass += 1 << level;
    if (level <= saliency[i].target) out.share += 1 << level;
  }
  out.share /= std::max(out.mass, 1.0);
  return out;
}

Outcome run_s21(const Setting& setting) {
  const Pool& pool = settled_pool(setting.backend);
  const Vec3d left{1.2, 0.6, 1.2}, right{3.6, 0.6, 1.2};
  SimulationOptions options = options_of(setting);
  options.n_star = Pool::n_star;
  options.start = pool.state;
  Watch watch(with_effects(pool.scene, setting), options, {.density = 1.3, .outside_m = 0.1 * d});
  int beyond = 0;  // number of frames in which more than 5 % of the particles split
  const auto frames_at = [&](const Vec3d& point, int frames, bool valid) {
    for (int frame = 0; frame < frames; ++frame) {
      const auto splits = watch.report().levels.splits;
      const auto particles = static_cast<double>(watch.state().size());
      watch.fluid().look(look_at(pool.scene, point, valid));
      if (!watch.step()) return;
      beyond += static_cast<double>(watch.report().levels.splits - splits) > 0.05 * particles;
    }
  };
  double least_mass = mass(pool.state);
  // Number of frames with the gaze at `point` until 90 % of the mass in the fovea is at least as fine as its
  // target; most + 1 if this takes longer than `most` frames.
  const auto frames_to_follow = [&](const Vec3d& point, int most) {
    for (int frame = 1; frame <= most; ++frame) {
      frames_at(point, 1, true);
      const Fovea seen = fovea_at(watch.fluid(), pool.scene, point);
      least_mass = std::min(least_mass, seen.mass);
      if (seen.share >= 0.9) return frame;
    }
    return most + 1;
  };
  frames_at(left, 60, true);
  const double coarse = static_cast<double>(watch.state().size()) / mass(pool.state);
  const int followed = frames_to_follow(right, 20);
  frames_at(left, 60, true);
  // While the gaze is lost, the method uses the last gaze for half a second, then the view's axis.
  frames_at(left, 60, false);
  const int back = frames_to_follow(left, 10);
  return watch.outcome(
      {at_most("frames after a jump", followed, 20), at_most("frames after a loss", back, 10),
       at_most("frames in which more than 5 % split", beyond, 0),
       // A larger share would mean that water far from the gaze did not become coarse.
       at_most("particles before the jump over all", coarse, 0.75),
       at_least("mass in the fovea", least_mass, 100, "m_*"),
       at_least("frames without gaze", static_cast<double>(watch.report().guards.gaze_lost), 60),
       watch.outside_finding(), reported("largest rho / rho_0", watch.densest())});
}

}  // namespace

HardCase gaze() {
  return {
      .id = "S21",
      .suite = "S21Gaze",
      .title = "gaze that jumps, is lost and comes back",
      .asked = "90 % of the fovea on target within 20 frames, after a loss within 10; splits <= 5 % a frame",
      .methods = {MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp},
      .scaled = "",
      .frame_dt_s = 1.0 / 60,
      .iterations = 4,
      .run = run_s21};
}

}  // namespace sim::cases
