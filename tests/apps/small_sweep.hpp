#pragma once
/// A made-up sweep of a few cells, for tests of its evaluation.

#include <string>
#include <vector>

#include "libsim/setting/named_scenes.hpp"
#include "libstudy/sweep/price_list.hpp"

namespace apps::test {

/// A run of two samples with these values, and of eight frames that take `ms` to `ms` + 7 ms.
inline study::CellRun run_with(double front, double kinetic, double ms, double density = 0.001) {
  study::CellRun out;
  for (const double time : {0.1, 0.2}) {
    study::WaterSample sample{.time_s = time, .front_m = front, .kinetic_j_kg = kinetic};
    sample.centre_m[1] = front / 2;
    sample.density_error = density;
    sample.density_max = 1;
    out.samples.push_back(sample);
  }
  for (int frame = 0; frame < 8; ++frame) out.frames.push_back({ms + frame, {}});
  return out;
}

/// A cell stored as if "a machine" had run it with SingleDam's scene file.
inline study::StoredCell stored(const sim::SolverSetting& setting, int seed, const study::CellRun& run) {
  static const std::string sha256 = sim::scenes_of("SingleDam").front().scene.sha256;
  return {{setting, seed}, {"a machine", "0.1.0 abc", sha256}, run};
}

inline sim::SolverSetting hires_at(std::int64_t n_star) {
  return sim::usual_setting("SingleDam", sim::MethodKind::HiRes, n_star);
}

/// Two runs each of the reference, of HiRes with usual settings, and of HiRes with eight projections.
inline std::vector<study::StoredCell> small_sweep(std::int64_t n_star = 512) {
  const auto reference = study::reference_setting("SingleDam", n_star);
  auto eight = hires_at(n_star);
  eight[sim::SolverKnob::Iterations] = 8;
  return {stored(reference, 1, run_with(1, 10, 100)),
          stored(reference, 2, run_with(1.01, 10, 100)),
          stored(hires_at(n_star), 1, run_with(1.2, 10, 10)),
          stored(hires_at(n_star), 2, run_with(1.3, 10, 10)),
          stored(eight, 1, run_with(1.1, 10, 14)),
          stored(eight, 2, run_with(1.12, 10, 14, 0.002))};
}

}  // namespace apps::test
