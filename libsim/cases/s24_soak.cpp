/// S24: long runs with a random gaze over a tank whose nozzle pours water taken from the tank's corners.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include <unistd.h>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"
#include "stats/base/file.hpp"

namespace sim::cases {

namespace {

/// Resident memory of the process, MiB; 0 if unknown.
double resident_mib() {
  std::ifstream in("/proc/self/statm");
  double size = 0, resident = 0;
  in >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

Outcome run_s24(const Setting& setting) {
  const bool small = setting.size == Size::Small;
  Scene scene = read_scene(base::resource("data/scenes/faucet.toml"));
  scene.settle_frames = 20;
  for (Nozzle& nozzle : scene.nozzles) nozzle.speed_m_s *= setting.scale;
  SimulationOptions options = options_of(setting);
  options.n_star = small ? 64 : 2048;
  Watch watch(with_effects(scene, setting), options, {.density = 2, .outside_m = 0.1 * d});
  // 300 s run only on a GPU, because three CPU cores take seven minutes for them.
  const double seconds = small ? 20 : setting.backend == Backend::Cuda ? 300 : 120;
  const int frames = frames_of(setting, seconds, scene.frame_dt_s);
  const auto began = watch.fluid().particle_count();
  std::int64_t unbalanced = 0, mass_off = 0;
  double early = 0, late = 0, memory = 0;
  std::size_t bytes = 0;
  int fixation = 0;
  std::mt19937 random(7);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int frame = 0; frame < frames; ++frame) {
    // The gaze stays 0.1 to 0.6 s at each random point of the water.
    if (--fixation <= 0) {
      fixation = frames_of(setting, 0.1 + 0.5 * draw(), scene.frame_dt_s);
      Vec3d point{};
      for (std::size_t k = 0; k < 3; ++k)
        point[k] = draw() * (k == 1 ? scene.water.front().max_m : scene.tank_size_m)[k];
      watch.fluid().look(look_at(scene, point));
    }
    if (!watch.step()) break;
    const FrameReport& now = watch.report();
    unbalanced += now.particles != began + now.particles_in - now.particles_out +
                                       static_cast<std::int64_t>(now.levels.born) -
                                       static_cast<std::int64_t>(now.levels.merges);
    mass_off += now.mass_units + now.reservoir != 8 * options.n_star;
    const auto n = static_cast<double>(now.particles);
    if (frame >= frames / 5 && frame < 3 * frames / 5) early += n;
    if (frame >= 3 * frames / 5) late += n;
    if (frame == frames / 2) memory = resident_mib(), bytes = watch.fluid().particle_bytes();
  }
  const double grown = static_cast<double>(watch.fluid().particle_bytes()) / static_cast<double>(bytes) - 1;
  return watch.outcome({at_most("drift of n", std::abs(late / early - 1), 0.1),
                        at_most("frames whose count does not balance", static_cast<double>(unbalanced), 0),
                        at_most("frames whose mass is off", static_cast<double>(mass_off), 0),
                        at_most("growth of the particles' memory", grown, 0.01),
                        // Only reported, because it includes all other memory of the process. A test that
                        // runs this case alone has a gate for it.
                        reported("growth of the process", resident_mib() - memory, "MiB"),
                        watch.outside_finding(),
                        // Only reported: in the small case the water has the mass of 64 coarsest
                        // particles, and sometimes no water is in the corners where the nozzle takes it.
                        reported("layers left out", static_cast<double>(watch.report().guards.nozzle_waited)),
                        reported("largest rho / rho_0", watch.densest()),
                        at_least("poured", static_cast<double>(watch.report().poured), 1, "m_*")});
}

}  // namespace

HardCase soak() {
  return {.id = "S24",
          .suite = "S24Soak",
          .title = "random gaze over a nozzle and its sinks",
          .asked = "no drift in n, mass exact, memory flat",
          .methods = {MethodKind::FovFluid, MethodKind::Ours, MethodKind::OursTsp},
          .scaled = "16 m/s of the nozzle",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s24};
}

}  // namespace sim::cases
