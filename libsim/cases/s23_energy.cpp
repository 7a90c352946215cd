/// S23: a breaking dam in a closed tank without forcing gains no energy.

#include <algorithm>
#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"
#include "stats/base/file.hpp"

namespace sim::cases {

namespace {

/// Potential plus kinetic energy divided by m_* (mass of a finest particle), m2/s2.
double energy(const State& state) {
  return gravity * centre_height(state) * mass(state) + kinetic_energy(state);
}

Outcome run_s23(const Setting& setting) {
  Scene scene = read_scene(base::resource("data/scenes/peers_dam.toml"));
  scene.water.front().max_m[1] *= setting.scale;
  SimulationOptions options = options_of(setting);
  options.n_star = setting.size == Size::Small ? 512 : setting.backend == Backend::Cpu ? 4096 : 32 * 1024;
  Watch watch(with_effects(scene, setting), options, {.density = 1.5, .outside_m = 0.1 * d});
  // The first two frames do not count: in them the lattice expands to its rest density, which raises the
  // water.
  for (int frame = 0; frame < 2; ++frame) watch.step();
  const double start = energy(watch.state());
  double most = 0, last = 0;
  const int frames = frames_of(setting, 1, scene.frame_dt_s);
  for (int frame = 0; frame < frames && watch.step(); ++frame) {
    last = energy(watch.state()) / start;
    most = std::max(most, last);
  }
  return watch.outcome({at_most("largest energy", most, 1.01), at_most("energy at last", last, 0.95),
                        watch.outside_finding(), reported("largest rho / rho_0", watch.densest())});
}

}  // namespace

HardCase energy_of_a_dam() {
  return {.id = "S23",
          .suite = "S23Energy",
          .title = "energy of a closed dam",
          .asked = "<= E0 (1 + 1 %), and the dam breaks",
          .methods = every_method(),
          .scaled = "1 m of the dam's height",
          .frame_dt_s = 1.0 / 120,
          .iterations = 4,
          .run = run_s23};
}

}  // namespace sim::cases
