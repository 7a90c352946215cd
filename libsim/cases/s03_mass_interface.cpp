/// S3: water of level 3 (particles of eight times the mass) below water of level 0, at rest, without splits
/// and merges.

#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

double height_of_coarse(const State& state) {
  double sum = 0;
  int count = 0;
  for (const auto& p : state) {
    if (p.level == 3) sum += static_cast<double>(p.y_m), ++count;
  }
  return sum / count;
}

Outcome run_s03(const Setting& setting) {
  const double height = even_layers(8 * setting.scale);
  Scene scene = tank({12 * d, 4 * height, 12 * d}, {12 * d, 2 * height, 12 * d});
  State start = block(MethodKind::LoRes, {0, 0, 0}, {12 * d, height, 12 * d});
  const State fine = block(MethodKind::HiRes, {0, height, 0}, {12 * d, 2 * height, 12 * d}, {},
                           static_cast<int>(start.size()));
  start.insert(start.end(), fine.begin(), fine.end());
  Watch watch(with_effects(scene, setting), options_of(setting, scene, start),
              {.density = 1.08, .outside_m = 0.1 * d});
  // The height of the coarse water is measured from the end of the first second on, because the lattices
  // settle in that second.
  for (int frame = 0; frame < frames_of(setting, 1) && watch.step(); ++frame) {
  }
  const double early = height_of_coarse(watch.state());
  for (int frame = 0; frame < frames_of(setting, 4) && watch.step(); ++frame) {
  }
  return watch.outcome(
      {at_most("coarse water moves", std::abs(height_of_coarse(watch.state()) - early) / d, 1, "d"),
       watch.density_finding(), watch.outside_finding(), reported("v_rms", rms_speed(watch.state()), "m/s")});
}

}  // namespace

HardCase mass_interface() {
  return {.id = "S3",
          .suite = "S03MassInterface",
          .title = "level 0 on level 3 at rest, 5 s",
          .asked = "moves by < 1 d, rho < 1.08",
          .methods = {MethodKind::HiRes},
          .scaled = "8 layers of each",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s03};
}

}  // namespace sim::cases
