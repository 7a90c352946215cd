/// S1: a tank at rest with 20 layers of particles, at the spacing with which the method starts.

#include <algorithm>
#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

Outcome run_s01(const Setting& setting) {
  const bool small = setting.size == Size::Small;
  const double spacing = start_spacing(setting.method);
  const double height = spacing * std::max(1.0, std::round(20 * setting.scale));
  const double x = (small ? 8 : 16) * spacing, z = (small ? 8 : 10) * spacing;
  const Scene scene = tank({x, 2 * height, z}, {x, height, z});
  SimulationOptions options = options_of(setting);
  options.n_star = std::lround(x * height * z / (d * d * d) / 8);
  const bool calm = !traits_of(setting.method).adaptive();
  Watch watch(with_effects(scene, setting), options, {.density = calm ? 1.08 : 1.3, .outside_m = 0.1 * d});
  // The mean density error, the speed and the drift are measured in the second half only, because the lattice
  // settles in the first half.
  const int frames = frames_of(setting, small ? 6 : 10);
  double half = 0, error = 0, rms = 0;
  for (int frame = 1; frame <= frames && watch.step(); ++frame) {
    if (frame == frames / 2) half = centre_height(watch.state());
    if (frame <= frames / 2) continue;
    error = std::max(error, watch.report().density_error_mean);
    rms = std::max(rms, rms_speed(watch.state()));
  }
  Finding densest = watch.density_finding();
  densest.asked = 1.08;
  const double fall = std::sqrt(gravity * height);
  Finding stirred = at_most("v_rms over sqrt(g H)", rms / fall, calm ? 0.02 : 0.15);
  stirred.asked = 0.02;
  Finding drift = at_most("drift of the centre in the second half",
                          std::abs(centre_height(watch.state()) / half - 1), calm ? 0.005 : 0.02);
  drift.asked = 0.005;
  return watch.outcome(
      {at_most("mean density error", error, 0.01), densest, drift, stirred, watch.outside_finding()});
}

}  // namespace

HardCase rest_tank() {
  return {.id = "S1",
          .suite = "S01RestTank",
          .title = "tank at rest, 20 layers, 10 s",
          .asked = "mean error < 1 %, rho < 1.08, drift < 0.5 %, v_rms < 0.02 sqrt(g H)",
          .methods = every_method(),
          .scaled = "20 layers",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s01};
}

}  // namespace sim::cases
