/// Derives the settings of each part of the solver from the scene and the options.

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "libsim/scene/fill.hpp"
#include "libsim/scene/vector.hpp"
#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

namespace {
constexpr int most_computed = 1000;  ///< maximum number of substeps per frame
}

double frame_dt_of(const Scene& scene, const SimulationOptions& options) {
  return options.frame_dt_s > 0 ? options.frame_dt_s : scene.frame_dt_s;
}

namespace {

Vec3 vector_of(const Vec3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

CentralPull pull_of(const CentralForce& force) {
  return {static_cast<float>(force.omega_per_s * force.omega_per_s), vector_of(force.centre_m),
          vector_of(force.axis)};
}

/// Largest distance of nozzles and particles from the axis of the central force, m; 0 without one.
double reach_of(const Scene& scene, const std::vector<ParticleState>& start) {
  if (!scene.central_force) return 0;
  double out = 0;
  const auto look = [&](const std::array<double, 3>& at) {
    out = std::max(out, distance_from_axis(*scene.central_force, at));
  };
  for (const Nozzle& nozzle : scene.nozzles) look(nozzle.position_m);
  for (const ParticleState& p : start) {
    if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m) || !std::isfinite(p.z_m)) continue;
    look({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)});
  }
  return out;
}

/// Shear rate, 1/s, below which the shear stress in a pool of particles of one level exceeds the stress of
/// its viscosity nu by more than a quarter: 0.1 g z / nu at the depth z, here half of the pool's depth. The
/// excess comes from the lattice that the particles form; it increases with the pressure (docs/results.md). 0
/// without the effect viscosity or without gravity.
double least_shear(const Scene& scene) {
  const auto nu = static_cast<double>(coefficients_of(scene.effects)[EffectKind::Viscosity]);
  const Vec3d up = scene.gravity_m_s2.up();
  double height = 0;
  for (const WaterBlock& block : scene.water) {
    double own = 0;
    for (std::size_t k = 0; k < 3; ++k) own += std::abs(up[k]) * (block.max_m[k] - block.min_m[k]);
    height = std::max(height, own);
  }
  return nu > 0 ? 0.1 * scene.gravity_m_s2.size() * height / 2 / nu : 0;
}

/// What --explain says where the water's explicit viscosity is cut; empty where it acts in full. A substep
/// takes at most half of what 22 nu dt / h^2 says of a pair (xsph_monaghan1989.cpp).
std::string explicit_limit(const Scene& scene, const SimulationOptions& options) {
  const double h = 2 * resolution_of(scene, options.method, options.n_star).spacing_m;
  const int substeps = substeps_needed(scene, options);
  const double most = 0.5 * h * h * substeps / (22 * frame_dt_of(scene, options));
  const double asked =
      options.viscosity_m2_s >= 0 ? options.viscosity_m2_s : viscosity_of(scene, options.n_star);
  if (asked <= most) return "";
  std::ostringstream out;
  out << "  viscosity: of the water's " << asked << " m2/s at most " << most << " act at this size and "
      << substeps << " substeps a frame; the effect viscosity has no such limit\n";
  return out.str();
}

}  // namespace

std::string effects_in_words(const std::vector<Effect>& listed, const Scene& scene,
                             const SimulationOptions& options) {
  if (listed.empty() && scene.obstacles.empty()) return explicit_limit(scene, options);
  const double d = resolution_of(scene, MethodKind::HiRes, options.n_star).finest_spacing_m;
  std::ostringstream out;
  out << explicit_limit(scene, options);
  if (!listed.empty()) out << "  effects: ";
  for (const Effect& effect : listed) {
    const auto& traits = traits_of(effect.kind);
    out << traits.word << " " << traits.key << " = " << base::shortest(effect.coefficient)
        << options_in_words(effect) << ", ";
  }
  const EffectStep longest = longest_step(scene.effects, d);
  if (longest.of != no_effect) {
    out << "substeps of at most " << longest.seconds << " s (" << traits_of(longest.of).word << ")\n";
  } else if (!listed.empty()) {
    out << "which ask for no shorter substeps\n";
  }
  const Scales scales = scales_of(scene, options.n_star);
  out << "  scales: " << scales.length_m << " m, " << scales.speed_m_s << " m/s, " << scales.viscosity_m2_s
      << " m2/s; Reynolds " << scales.reynolds << ", Weber " << scales.weber << ", Bond " << scales.bond
      << "\n";
  if (const double shear = least_shear(scene); shear > 0) {
    out << "  viscosity: particles of one size resist shear slower than " << shear
        << " /s by more than a quarter beyond it\n";
  }
  return out.str();
}

int substeps_needed(const Scene& scene, const SimulationOptions& options) {
  const int usual = options.substeps > 0 ? options.substeps : substeps_of(scene, options.n_star);
  const EffectStep longest =
      longest_step(scene.effects, resolution_of(scene, MethodKind::HiRes, options.n_star).finest_spacing_m);
  if (longest.of == no_effect) return usual;
  const double steps = std::ceil(frame_dt_of(scene, options) / longest.seconds - 1e-9);
  if (steps <= usual) return usual;
  if (options.substeps == 0 && steps <= most_computed) return static_cast<int>(steps);
  std::ostringstream problem, mend;
  problem << "needs substeps of at most " << longest.seconds << " s, that is " << steps << " a frame; ";
  if (steps > most_computed) {
    problem << "the solver computes at most " << most_computed;
    mend << "lower " << traits_of(longest.of).key
         << ", raise frames_per_s, or use a smaller n_* (--n-star, or n_star in a protocol)";
  } else {
    problem << options.substeps << " were asked for";
    mend << "set substeps to ";
    if (steps <= SolverNumbers::most_fixed_substeps) mend << steps << " or more, or to ";
    mend << "0 (the run then chooses)";
  }
  throw base::Error(std::string("effect ") + traits_of(longest.of).word, problem.str(), mend.str());
}

int least_substeps(const Scene& scene, const SimulationOptions& options) {
  return substeps_needed(acting_scene(scene, levels_at_start(scene, options).first), options);
}

SolverParameters solver_parameters(const Scene& scene, const SimulationOptions& options) {
  SolverParameters out;
  const double frame_dt = frame_dt_of(scene, options);
  out.substeps = substeps_needed(scene, options);
  out.effects = coefficients_of(scene.effects);
  out.iterations = options.iterations > 0 ? options.iterations : scene.solver_iterations;
  out.dt = static_cast<float>(frame_dt / out.substeps);
  out.gravity = {static_cast<float>(scene.gravity_m_s2.size()), vector_of(scene.gravity_m_s2.up())};
  if (scene.central_force) out.pull = pull_of(*scene.central_force);
  out.viscosity = static_cast<float>(viscosity_of(scene, options.n_star));
  if (options.viscosity_m2_s >= 0) out.viscosity = static_cast<float>(options.viscosity_m2_s);
#define SIM_CHOOSE(Type, member, ...) \
  if (options.member >= 0) out.member = static_cast<Type>(options.member);
  SIM_SOLVER_NUMBERS(SIM_CHOOSE)
#undef SIM_CHOOSE
  return out;
}

double start_speed(const Scene& scene, const std::vector<ParticleState>& start) {
  double out = 0;
  for (const Nozzle& nozzle : scene.nozzles) out = std::max(out, nozzle.speed_m_s);
  for (const Obstacle& obstacle : scene.obstacles) out = std::max(out, top_speed(obstacle));
  for (const ParticleState& p : start) {
    const double speed = std::hypot(static_cast<double>(p.vx_m_s), static_cast<double>(p.vy_m_s),
                                    static_cast<double>(p.vz_m_s));
    if (std::isfinite(speed)) out = std::max(out, speed);
  }
  return out;
}

double fall_speed(const Scene& scene, const std::vector<ParticleState>& start) {
  const Vec3d up = scene.gravity_m_s2.up();
  // Height of the tank's lowest corner along gravity, m.
  double lowest = 0;
  for (std::size_t k = 0; k < 3; ++k) lowest += std::min(up[k] * scene.tank_size_m[k], 0.0);
  double height = 0;
  const auto look = [&](const Vec3d& at) {
    const double own = sim::dot(up, at) - lowest;
    if (std::isfinite(own)) height = std::max(height, own);
  };
  for (const WaterBlock& block : scene.water) {
    Vec3d top = block.min_m;
    for (std::size_t k = 0; k < 3; ++k)
      if (up[k] > 0) top[k] = block.max_m[k];
    look(top);
  }
  for (const Obstacle& o : scene.obstacles)
    if (o.motion == ObstacleMotion::Free) look(o.start.centre_m);
  for (const Nozzle& nozzle : scene.nozzles) look(nozzle.position_m);
  for (const ParticleState& p : start)
    look({static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)});
  const double speed = start_speed(scene, start);
  const double swing = scene.central_force ? scene.central_force->omega_per_s * reach_of(scene, start) : 0;
  return std::sqrt(speed * speed + 2 * scene.gravity_m_s2.size() * height + swing * swing);
}

namespace {

/// Largest u a / d of all obstacles, m/s: the speed of water that a plate of half width a, moving at the
/// speed u, presses out of a gap of width d. By continuity the flow u a leaves through the gap. d is the
/// finest spacing; a narrower gap contains no particle.
double squeeze_speed(const Scene& scene, double finest_spacing_m) {
  double out = 0;
  for (const Obstacle& o : scene.obstacles) {
    const auto half = half_sides_m(o);
    const double half_width = *std::max_element(half.begin(), half.end()) + o.radius_m;
    out = std::max(out, top_speed(o) * half_width / finest_spacing_m);
  }
  return out;
}

}  // namespace

float most_speed(double fall_speed, const Scene& scene, const Resolution& resolution,
                 const SolverParameters& parameters) {
  const double d = resolution.finest_spacing_m;
  // Settled water without gravity counts as at rest if it moves by less than a tenth of a spacing in a frame.
  // Errors of projections, splits and merges move particles by up to that distance.
  const bool still = scene.gravity_m_s2.size() <= 0 && fall_speed * parameters.frame_s() < 0.1 * d;
  if (still) return static_cast<float>(4 * d / static_cast<double>(parameters.dt));
  return static_cast<float>(3 * fall_speed + 3 * capillary_speed(scene.effects, d) + squeeze_speed(scene, d));
}

namespace {

/// Factor by which thin obstacles shorten a particle's longest step, (0, 1]. The usual step, the finest
/// spacing d, does not reach the middle of an obstacle that is 2 d thick. Thinner obstacles need shorter
/// steps in proportion.
double share_for_thin_obstacles(const Scene& scene, double finest_spacing_m) {
  double out = 1;
  for (const Obstacle& o : scene.obstacles) out = std::min(out, thickness_m(o) / (2 * finest_spacing_m));
  return out;
}

}  // namespace

double start_acceleration(const Scene& scene, const std::vector<ParticleState>& start) {
  const double omega = scene.central_force ? scene.central_force->omega_per_s : 0;
  return scene.gravity_m_s2.size() + omega * omega * reach_of(scene, start);
}

namespace {

/// The error for forces that would compress even water at rest, within the substeps of a frame.
base::Error too_strong(const Scene& scene, const SimulationOptions& options, double acceleration,
                       const SubstepRule& rule) {
  const double rate = rule.at_rest() / (rule.most() * frame_dt_of(scene, options));
  std::ostringstream problem, mend;
  problem << "pulls water at up to " << acceleration << " m/s2, for which a frame needs " << rule.at_rest()
          << " substeps; at most " << rule.most() << " are computed, and the water would be compressed";
  mend << "raise frames_per_s to " << std::ceil(rate) << ", ";
  if (rule.at_rest() <= 64) mend << "set min_substeps to " << rule.at_rest() << ", ";
  mend << "lower " << (scene.central_force ? "omega_per_s" : "gravity_m_s2")
       << ", or use a smaller n_* (--n-star, or n_star in a protocol)";
  return {"scene " + scene.name + ", n_* " + std::to_string(options.n_star) + ", " +
              (scene.central_force ? "central_force" : "gravity_m_s2"),
          problem.str(), mend.str()};
}

}  // namespace

SubstepRule substep_rule(const Scene& scene, const SimulationOptions& options, const Resolution& resolution,
                         double fastest, double acceleration) {
  constexpr int usual_most = 32;
  SubstepLimits out;
  out.frame_dt_s = frame_dt_of(scene, options);
  out.courant = options.courant > 0 ? options.courant : scene.courant;
  out.courant *= share_for_thin_obstacles(scene, resolution.finest_spacing_m);
  out.acceleration_m_s2 = acceleration;
  const MethodTraits& method = traits_of(options.method);
  out.support_m = 2 * (method.adaptive() ? resolution.finest_spacing_m : resolution.spacing_m);
  out.least = substeps_needed(scene, options);
  out.most = std::max(out.least, options.most_substeps > 0 ? options.most_substeps : usual_most);
  if (options.substeps > 0) out.most = out.least;
  const SubstepRule rule(out, fastest);
  const bool of_scene = options.substeps == 0 && options.most_substeps == 0 && options.frame_dt_s == 0;
  if (of_scene && rule.at_rest() > rule.most()) throw too_strong(scene, options, acceleration, rule);
  return rule;
}

Demand demand_of(const Scene& scene, const SimulationOptions& options, const SolverParameters& parameters,
                 std::pair<int, int> levels) {
  const MethodTraits& method = traits_of(options.method);
  Demand out;
  out.parameters = parameters;
  out.effects = scene.effects;
  out.finest_level = levels.first;
  out.nozzles = !scene.nozzles.empty();
  out.outlets = !scene.outlets.empty();
  const double coarsest_spacing_m =
      std::cbrt(1 << levels.second) * resolution_of(scene, options.method, options.n_star).finest_spacing_m;
  out.narrow_outlets = std::any_of(scene.outlets.begin(), scene.outlets.end(), [&](const Outlet& outlet) {
    return std::min(outlet.max_m[0] - outlet.min_m[0], outlet.max_m[1] - outlet.min_m[1]) <
           2 * 0.998 * coarsest_spacing_m;
  });
  out.moving_obstacles = std::any_of(scene.obstacles.begin(), scene.obstacles.end(), [](const Obstacle& o) {
    return o.motion == ObstacleMotion::Turns || o.motion == ObstacleMotion::Swings;
  });
  out.free_obstacles = any_free(scene.obstacles);
  out.obstacles_meet = any_meet(scene.obstacles);
  out.activation = (method.temporal || options.temporal.always) && !stays_off(options.temporal);
  const auto keeps = std::find_if(out.effects.begin(), out.effects.end(), [&](const Effect& effect) {
    return effect.kind != EffectKind::Foam && acts(out, effect.kind);
  });
  if (out.activation && keeps != out.effects.end()) {
    out.activation = false;
    out.keeps_all_solved = keeps->kind;
  }
  out.levels = method.adaptive() && levels.first < levels.second;
  const double finest = resolution_of(scene, options.method, options.n_star).finest_spacing_m;
  out.rests_by_drift = parameters.rests_by_drift(static_cast<float>(2 * finest));
  out.forced_targets = out.levels && options.forced_targets;
  out.saliency_parts = options.saliency_parts;
  // Activation needs saliency too: it weights the particles' importance by saliency.
  const bool looks = !options.forced_targets && (out.levels || out.saliency_parts || out.activation);
  out.gaze_targets = looks && method.target == TargetSource::Gaze;
  out.saliency = looks && method.target == TargetSource::Saliency;
  out.wall_impulse = options.keeps_momentum();
  return out;
}

void check_levels(int levels) {
  if (levels >= 1 && levels <= most_levels) return;
  throw base::Error(
      "N = " + std::to_string(levels),
      "is not a number of levels: a particle splits into at most 2^3 in one step, the corners of "
      "a cube",
      "use 1 to 4 levels");
}

int capacity_for(std::size_t start, const SimulationOptions& options, bool splits) {
  // Particles and their cells are indexed with int.
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<int>::max()) / Grid::most_per_particle;
  if (start > most) {
    throw base::Error(std::to_string(start) + " particles",
                      "are more than the " + std::to_string(most) + " that the solver can number",
                      "use a smaller n_* (--n-star, or n_star in a protocol)");
  }
  const std::int64_t room = options.particle_capacity > 0 ? options.particle_capacity : 8 * options.n_star;
  return static_cast<int>(std::max(static_cast<std::int64_t>(start), splits ? room : 0));
}

TargetSphere sphere_of(const TargetRegion& region) {
  if (std::min(region.inside, region.outside) < 0 || std::max(region.inside, region.outside) >= most_levels) {
    throw base::Error(
        "forced targets, levels " + std::to_string(region.inside) + " and " + std::to_string(region.outside),
        "contain a level that does not exist", "use levels 0 to 3");
  }
  const auto f = [](double value) { return static_cast<float>(value); };
  return {{f(region.centre_m[0]), f(region.centre_m[1]), f(region.centre_m[2])},
          f(region.radius_m),
          region.inside,
          region.outside};
}

namespace {
Opening opening_of(const Outlet& outlet) {
  constexpr float endless = std::numeric_limits<float>::max();
  std::array<float, 3> low{-endless, -endless, -endless};
  std::array<float, 3> high{endless, endless, endless};
  const auto axes = axes_of(outlet.wall);
  for (std::size_t a = 0; a < 2; ++a) {
    low[axes[a]] = static_cast<float>(outlet.min_m[a]);
    high[axes[a]] = static_cast<float>(outlet.max_m[a]);
  }
  return {static_cast<int>(outlet.wall), {low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}
}  // namespace

Walls walls_of(const Scene& scene, bool settling) {
  Vec3d low{0, 0, 0};
  Vec3d high = scene.tank_size_m;
  if (settling && scene.gate) {  // there is one block: check_extent refuses a gate with several
    const Fall fall(0, vector_of(scene.gravity_m_s2.up()));
    const std::array<float, 3> axis{fall.axis().x, fall.axis().y, fall.axis().z};
    for (std::size_t k = 0; k < 3; ++k) {
      // The side against gravity stays open.
      if (!(axis[k] < 0)) low[k] = scene.water.front().min_m[k];
      if (!(axis[k] > 0)) high[k] = scene.water.front().max_m[k];
    }
  }
  const auto f = [](double value) { return static_cast<float>(value); };
  // The planes are in the order of the enumeration Wall.
  Walls out{};
  out.planes[out.count++] = {{1, 0, 0}, f(low[0])};
  out.planes[out.count++] = {{-1, 0, 0}, f(-high[0])};
  out.planes[out.count++] = {{0, 0, 1}, f(low[2])};
  out.planes[out.count++] = {{0, 0, -1}, f(-high[2])};
  out.planes[out.count++] = {{0, 1, 0}, f(low[1])};
  if (scene.lid) out.planes[out.count++] = {{0, -1, 0}, f(-high[1])};
  if (settling) return out;
  for (const Outlet& outlet : scene.outlets) out.openings[out.opening_count++] = opening_of(outlet);
  return out;
}

}  // namespace sim::SIM_BACKEND
