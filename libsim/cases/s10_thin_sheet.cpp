/// S10: sheets of one and of two layers that fall towards a pool, away from the gaze. Their area is compared
/// with that under the method HiRes, whose particles all stay finest.

#include <algorithm>
#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

/// Area, m2, that the particles above this height cover as seen from above; each is drawn as a disc of 1.5
/// radii.
double covered_m2(const State& state, double above_m) {
  constexpr double cell = d / 4;
  constexpr int side = 128;
  std::vector<char> covered(side * side, 0);
  for (const auto& p : state) {
    if (static_cast<double>(p.y_m) < above_m) continue;
    const double r = 1.5 * 0.5 * d * std::cbrt(mass(p));
    for (int k = 0; k < side * side; ++k) {
      const double x = (k % side + 0.5) * cell - static_cast<double>(p.x_m);
      const double z = (k / side + 0.5) * cell - static_cast<double>(p.z_m);
      if (x * x + z * z < r * r) covered[static_cast<std::size_t>(k)] = 1;
    }
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) * cell * cell;
}

Outcome run_s10(const Setting& setting) {
  const Pool& pool = settled_pool(setting.backend);
  const Vec3d gaze{1.2, 0.6, 1.2};
  Outcome out;
  for (const int layers : {1, 2}) {
    State start = pool.state;
    const State sheet =
        block(MethodKind::HiRes, {2.8, 2.6, 0.4}, {2.8 + 12 * d, 2.6 + layers * d, 0.4 + 12 * d}, {},
              static_cast<int>(start.size()));
    start.insert(start.end(), sheet.begin(), sheet.end());
    Setting fine = setting;
    fine.method = MethodKind::HiRes;
    const auto options_for = [&](const Setting& one) {
      SimulationOptions options = options_of(one);
      options.n_star = Pool::n_star;
      options.start = start;
      options.particle_capacity = static_cast<std::int64_t>(start.size());
      return options;
    };
    Watch reference(with_effects(pool.scene, setting), options_for(fine), {});
    Watch watch(with_effects(pool.scene, setting), options_for(setting),
                {.density = 1.5, .outside_m = 0.1 * d});
    double least = 1;
    const int frames = frames_of(setting, 0.3);
    for (int frame = 1; frame <= frames; ++frame) {
      watch.fluid().look(look_at(pool.scene, gaze));
      if (!reference.step() || !watch.step()) break;
      if (3 * frame / frames != 3 * (frame - 1) / frames)
        least = std::min(least, covered_m2(watch.state(), 1.7) / covered_m2(reference.state(), 1.7));
    }
    const std::string what = layers == 1 ? "one layer" : "two layers";
    const auto found =
        watch.outcome({at_least(what + ": share of HiRes' area", least, 0.9),
                       at_least(what + ": HiRes' area", covered_m2(reference.state(), 1.7), 2, "m2"),
                       at_most(what + ": particles outside", watch.out(), 0)});
    out.findings.insert(out.findings.end(), found.findings.begin(), found.findings.end());
    if (found.stopped && !out.stopped) out.stopped = found.stopped;
  }
  return out;
}

}  // namespace

HardCase thin_sheet() {
  return {.id = "S10",
          .suite = "S10ThinSheet",
          .title = "sheets of one and two layers over a pool",
          .asked = "area lost < 10 % in 0.3 s against HiRes",
          .methods = {MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp},
          .scaled = "",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s10};
}

}  // namespace sim::cases
