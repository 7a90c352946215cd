/// S7: water under tension without gravity: a rotating square (negative pressure everywhere) and a sphere in
/// a straining flow.

#include <algorithm>
#include <cmath>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

/// Sets each particle's velocity to flow(offset of the particle from the centre).
template <class Flow>
void stir(State& state, const Vec3d& centre, Flow flow) {
  for (auto& p : state) {
    const Vec3d v = flow(Vec3d{static_cast<double>(p.x_m) - centre[0], static_cast<double>(p.y_m) - centre[1],
                               static_cast<double>(p.z_m) - centre[2]});
    p.vx_m_s = static_cast<float>(v[0]);
    p.vy_m_s = static_cast<float>(v[1]);
    p.vz_m_s = static_cast<float>(v[2]);
  }
}

/// Runs the square or the sphere (`what`) and appends its findings to `out`. Limits apply to clumps, energy
/// gain and particles outside. The density constraint cannot sustain negative pressure, so that voids open;
/// the final number of neighbours, which falls with voids, is only reported. least: limit for the distance of
/// close pairs, in spacings.
void follow(Outcome& out, const std::string& what, const Setting& setting, Scene& scene, const State& start,
            double seconds, double least) {
  scene.gravity_m_s2 = 0;
  Watch watch(with_effects(scene, setting), options_of(setting, scene, start),
              {.density = 1.5, .outside_m = 0.1 * d});
  // `close`: distance to the nearest neighbour that 99 % of the particles reach, the smallest over the
  // frames. The closest pair has no limit: a single close pair occurs by chance, whereas clumps bring at
  // least one particle in a hundred close to another.
  double close = 2, closest = 2, energy = 1;
  const double began = kinetic_energy(start);
  for (int frame = 0; frame < frames_of(setting, seconds) && watch.step(); ++frame) {
    const auto nearest = nearest_distances(watch.state());
    close = std::min(close, nearest[nearest.size() / 100]);
    closest = std::min(closest, nearest.front());
    energy = std::max(energy, kinetic_energy(watch.state()) / began);
  }
  Finding apart = at_least(what + ": nearest of 99 %", close, least, "spacings");
  apart.asked = 0.5;
  const auto found = watch.outcome({apart, at_most(what + ": energy", energy, 1.01),
                                    at_most(what + ": particles outside", watch.out(), 0),
                                    reported(what + ": closest pair", closest, "spacings"),
                                    reported(what + ": largest rho / rho_0", watch.densest()),
                                    reported(what + ": neighbours at last", watch.report().neighbours_mean)});
  out.findings.insert(out.findings.end(), found.findings.begin(), found.findings.end());
  if (found.stopped && !out.stopped) out.stopped = found.stopped;
}

Outcome run_s07(const Setting& setting) {
  const double size = (setting.size == Size::Small ? 1 : 2) * d;
  const double spin = 2 * setting.scale;  // rad/s
  const bool levels = traits_of(setting.method).adaptive();
  Outcome out;
  {
    // The square is a slab between two walls. Without tension all its particles fly outwards on straight
    // lines; at spin x t = 1 they cover twice the initial area.
    const double side = 12 * size, room = 48 * size, thick = 6 * size;
    Scene scene = tank({room, room, thick}, {1, 1, 1});
    const double low = (room - side) / 2, middle = room / 2;
    State start = block(setting.method, {low, low, 0}, {low + side, low + side, thick});
    stir(start, {middle, middle, 0}, [&](const Vec3d& x) { return Vec3d{spin * x[1], -spin * x[0], 0}; });
    follow(out, "square", setting, scene, start, 1 / spin, levels || setting.size == Size::Full ? 0.07 : 0.5);
  }
  {
    // A flow of constant strain would reduce the sphere's thickness to exp(-0.4) = 0.67 of the initial value.
    const double radius = 5 * size, room = 48 * size, middle = room / 2;
    Scene scene = tank({room, room, room}, {1, 1, 1});
    State cube = block(setting.method, {middle - radius, middle - radius, middle - radius},
                       {middle + radius, middle + radius, middle + radius});
    const double strain = spin / 2;
    State start;
    for (auto& p : cube) {
      const double from = std::hypot(static_cast<double>(p.x_m) - middle, static_cast<double>(p.y_m) - middle,
                                     static_cast<double>(p.z_m) - middle);
      if (from > radius) continue;
      p.id = static_cast<int>(start.size());
      start.push_back(p);
    }
    stir(start, {middle, middle, middle}, [&](const Vec3d& x) {
      return Vec3d{strain * x[0], strain * x[1], -2 * strain * x[2]};
    });
    // The limit is lower with levels, because children of a split may overlap other particles, and thin water
    // does not separate them.
    const double least = levels ? 0.05 : setting.size == Size::Full ? 0.12 : 0.3;
    follow(out, "sphere", setting, scene, start, 0.2 / strain, least);
  }
  return out;
}

}  // namespace

HardCase tension() {
  return {.id = "S7",
          .suite = "S07Tension",
          .title = "rotating square and strained sphere without gravity",
          .asked = "no pair closer than 0.5 d, energy <= E0 (1 + 1 %)",
          .methods = every_method(),
          .scaled = "2 rad/s of the square",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s07};
}

}  // namespace sim::cases
