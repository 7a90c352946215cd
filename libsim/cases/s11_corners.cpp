/// S11: water that sloshes from corner to corner of a tank, driven by sudden velocity changes; S11b: the same
/// with a slab that forms a wedge with the floor.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "libsim/cases/cases.hpp"
#include "libsim/cases/watch.hpp"

namespace sim::cases {

namespace {

double distance_to(const Obstacle& slab, double x, double y, double z) {
  return signed_distance(slab, slab.start, {x, y, z});
}

/// A slab that rises from the floor at 30 degrees and extends beyond both side walls; the water under it is
/// in the wedge.
Obstacle slab_over(double side) {
  constexpr double rise = std::numbers::pi / 6, length = 8 * d, thick = 4 * d;
  Obstacle out;
  out.shape = ObstacleShape::Box;
  out.size_m = {length, thick, 2 * side};
  // One edge of the slab's lower face lies on the floor.
  const double along = length / 2, up = thick / 2;
  out.start.centre_m = {side / 4 + along * std::cos(rise) - up * std::sin(rise),
                        along * std::sin(rise) + up * std::cos(rise), side / 2};
  out.start.turn = {0, 0, std::sin(rise / 2), std::cos(rise / 2)};
  return out;
}

/// Number of particles that are deeper in an obstacle than the tolerance.
int inside(const State& state, const std::vector<Obstacle>& obstacles, double tolerance_m) {
  int out = 0;
  for (const auto& p : state) {
    for (const Obstacle& slab : obstacles) {
      out += distance_to(slab, static_cast<double>(p.x_m), static_cast<double>(p.y_m),
                         static_cast<double>(p.z_m)) < -tolerance_m;
    }
  }
  return out;
}

/// Largest rho / rho_0, in the last projection, of particles closer than their support to at least two walls.
/// The floor and obstacles count as walls, a lid does not.
double densest_in_corners(const Simulation& fluid, const Scene& scene) {
  std::vector<RenderParticle> places;
  std::vector<float> error;
  fluid.read_particles(places);
  fluid.read_field(ParticleField::DensityError, error);
  double out = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto x = static_cast<double>(places[i].x_m), y = static_cast<double>(places[i].y_m),
               z = static_cast<double>(places[i].z_m);
    const double support = 4 * static_cast<double>(places[i].radius_m);
    int walls = 0;
    for (const double away : {x, scene.tank_size_m[0] - x, z, scene.tank_size_m[2] - z, y}) {
      walls += away < support;
    }
    for (const Obstacle& slab : scene.obstacles) walls += distance_to(slab, x, y, z) < support;
    if (walls >= 2) out = std::max(out, 1 + static_cast<double>(error[i]));
  }
  return out;
}

/// Counts particles that hang in the air: above 2 d, without neighbours, and without motion for two frames.
/// Without motion means less than g dt^2 / 3 per frame, with the frame's duration dt. A flying particle moves
/// less in at most one frame, because its motion per frame changes by g dt^2 each frame.
class Hanging {
 public:
  explicit Hanging(double frame_dt_s) : still_m_(gravity * frame_dt_s * frame_dt_s / 3) {}

  int count(const State& state) {
    int out = 0;
    std::map<int, Seen> now;
    for (const auto& p : state) {
      Seen seen{p, 0};
      const auto before = seen_.find(p.id);
      if (before != seen_.end() && distance(before->second.at, p) < still_m_) {
        seen.still = before->second.still + 1;
      }
      if (seen.still >= 2 && static_cast<double>(p.y_m) > 2 * d && alone(p, state)) ++out;
      now.emplace(p.id, seen);
    }
    seen_ = std::move(now);
    return out;
  }

 private:
  struct Seen {
    ParticleState at;
    int still;
  };
  static double distance(const ParticleState& a, const ParticleState& b) {
    return std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m),
                      static_cast<double>(a.z_m - b.z_m));
  }
  static bool alone(const ParticleState& p, const State& state) {
    const double support = 2 * d * std::cbrt(mass(p));
    return std::none_of(state.begin(), state.end(), [&](const ParticleState& other) {
      return other.id != p.id && distance(p, other) < support;
    });
  }

  double still_m_;
  std::map<int, Seen> seen_;
};

Outcome slosh(const Setting& setting, bool with_wedge) {
  const bool small = setting.size == Size::Small;
  const double side = small ? 12 * d : 24 * d, depth = small ? 6 * d : 10 * d;
  Scene scene = tank({side, 3 * depth, side}, {side, depth, side});
  if (with_wedge) scene.obstacles.push_back(slab_over(side));
  SimulationOptions options = options_of(setting);
  options.n_star = std::lround(side * side * depth / (d * d * d) / 8);
  Watch watch(with_effects(scene, setting), options, {.density = 1.5, .outside_m = 0.1 * d});
  const double kick = 2 * setting.scale;  // m/s
  const int frames = frames_of(setting, small ? 5 : 60), period = frames_of(setting, 1.5);
  double densest = 0;
  int hanging = 0, deepest = 0;
  Hanging air(frame_dt_of(setting));
  for (int frame = 0; frame < frames; ++frame) {
    if (frame % period == 0) {
      // All particles get a sudden change of velocity, towards each corner in turn.
      const int turn = frame / period;
      State state = watch.state();
      for (auto& p : state) {
        p.vx_m_s += static_cast<float>(turn & 1 ? kick : -kick);
        p.vz_m_s += static_cast<float>(turn & 2 ? kick : -kick);
      }
      watch.fluid().put(state);
    }
    if (!watch.step()) break;
    densest = std::max(densest, densest_in_corners(watch.fluid(), scene));
    hanging = std::max(hanging, air.count(watch.state()));
    deepest = std::max(deepest, inside(watch.state(), scene.obstacles, 0.1 * d));
  }
  std::vector<Finding> findings{watch.outside_finding(),
                                at_most("largest rho / rho_0 in corners", densest, 1.3),
                                at_most("hanging in the air", hanging, 0)};
  if (with_wedge) findings.push_back(at_most("particles inside the slab", deepest, 0));
  findings.push_back(reported("largest rho / rho_0", watch.densest()));
  findings.push_back(reported("fastest", watch.fastest_m_s(), "m/s"));
  return watch.outcome(findings);
}

Outcome run_s11(const Setting& setting) { return slosh(setting, false); }
Outcome run_with_wedge(const Setting& setting) { return slosh(setting, true); }

}  // namespace

HardCase corners() {
  return {.id = "S11",
          .suite = "S11Corners",
          .title = "water that sloshes into corners for 60 s",
          .asked = "no particle outside by > 0.1 d, rho < 1.3 in corners, none stuck in the air",
          .methods = every_method(),
          .scaled = "2 m/s of the kicks",
          .frame_dt_s = 1.0 / 60,
          .iterations = 4,
          .run = run_s11};
}

HardCase wedge() {
  HardCase out = corners();
  out.id = "S11b";
  out.suite = "S11Wedge";
  out.title = "water that sloshes into a wedge of 30 degrees for 60 s";
  out.asked = "no particle outside or in the slab by > 0.1 d, rho < 1.3 in corners, none stuck in the air";
  out.run = run_with_wedge;
  return out;
}

}  // namespace sim::cases
