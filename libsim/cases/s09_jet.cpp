/// S9: a jet of 30 m/s at a wall.

#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

/// Mean velocity along x, m/s.
double drift(const State& state) {
  double sum = 0;
  for (const auto& p : state) sum += mass(p) * static_cast<double>(p.vx_m_s);
  return sum / mass(state);
}

Outcome run_s09(const Setting& setting) {
  // The jet is a bar of water, 6 m x 1.2 m x 1.2 m, 1 m before a wall, without gravity.
  constexpr double length = 40 * d, gap = 1, width = 8 * d;
  const double speed = 30 * setting.scale;
  Scene scene = tank({12, 8, 8}, {1, 1, 1});
  scene.gravity_m_s2 = 0;
  const Vec3d low{12 - gap - length, 3.4, 3.4};
  const State start =
      block(setting.method, low, {low[0] + length, low[1] + width, low[2] + width}, {speed, 0, 0});
  Watch watch(with_effects(scene, setting), options_of(setting, scene, start),
              {.density = 1.5, .outside_m = 1e-6});
  // While the middle of the bar arrives, the wall receives the force rho A v^2, with the bar's cross-section
  // A and its speed v. The bar's mass is rho A length, so that its mean velocity changes by v^2 / length per
  // second.
  const double dt = frame_dt_of(setting);
  const int first = static_cast<int>(std::ceil(2 * gap / speed / dt - 1e-9));
  const int last = static_cast<int>(std::floor((gap + 0.75 * length) / speed / dt + 1e-9));
  double at_first = 0, at_last = 0;
  const int frames = frames_of(setting, 0.5 * 30 / speed);
  for (int frame = 1; frame <= std::max(frames, last) && watch.step(); ++frame) {
    if (frame == first) at_first = drift(watch.state());
    if (frame == last) at_last = drift(watch.state());
  }
  const double flux = (at_first - at_last) / ((last - first) * dt) / (speed * speed / length);
  return watch.outcome(
      {watch.outside_finding(), watch.density_finding(),
       at_most("momentum flux on the wall off rho A v^2 by", std::abs(flux - 1), 0.15),
       at_most("frames short of substeps", setting.substeps > 0 ? 0 : watch.short_frames(), 0),
       at_most("braked", static_cast<double>(watch.report().guards.speed_limited), 0),
       reported("fastest", watch.fastest_m_s(), "m/s")});
}

}  // namespace

HardCase jet() {
  return {.id = "S9",
          .suite = "S09Jet",
          .title = "jet of 30 m/s at a wall",
          .asked = "no particle passes a wall, momentum flux within 15 %",
          .methods = every_method(),
          .scaled = "30 m/s of the jet",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s09};
}

}  // namespace sim::cases
