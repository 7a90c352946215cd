#include <algorithm>

#include "libsim/particles/contact.hpp"
#include "libsim/scene/mesh.hpp"
#include "libsim/solver/fluid_simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace sim::SIM_BACKEND {

namespace {

Vec3d vector(Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// m_*, the mass of a particle of level 0, kg.
double mass_unit(const FluidState& state) {
  const auto edge = static_cast<double>(state.finest_support) / 2;
  return static_cast<double>(state.parameters.rest_density) * edge * edge * edge;
}

void begin_meeting(ObstacleState& o) {
  std::vector<float> friction;
  o.feelers = Feelers::most_of_shapes;
  for (const Obstacle& obstacle : o.obstacles) {
    friction.push_back(static_cast<float>(obstacle.friction));
    o.rough = o.rough || obstacle.friction > 0;
    if (obstacle.mesh) o.feelers = std::max(o.feelers, static_cast<int>(obstacle.mesh->contacts_m().size()));
  }
  o.friction.from_host(friction);
  o.by_others.resize(o.obstacles.size());
  o.by_others.zero();
}

FreeBody free_of(const Obstacle& o, const FluidState& state) {
  FreeBody out{};
  if (o.motion != ObstacleMotion::Free) return out;
  const double mass = o.density_kg_m3 * volume_m3(o) / mass_unit(state);
  const Vec3d moments = inertia_m2(o);
  out.mass = static_cast<float>(mass);
  out.volume = static_cast<float>(volume_m3(o) * static_cast<double>(state.parameters.rest_density) /
                                  mass_unit(state));
  const auto moment = [&](std::size_t k) { return static_cast<float>(mass * moments[k]); };
  out.inertia = {moment(0), moment(1), moment(2)};
  // The body starts at rest, with a force that supports its weight.
  out.force = out.mass * state.parameters.gravity.lift();
  out.force_left = -1.0f * out.force;
  return out;
}

}  // namespace

void begin_obstacles(FluidState& state, const Scene& scene, int coarsest_level, double time_s,
                     bool recorded) {
  auto& o = state.obstacles;
  // Substeps are short enough that no particle passes through an obstacle of this thickness (substep_rule).
  // The factor allows for supports that are rounded to floats.
  const double least = (1 - 1e-6) * static_cast<double>(state.supports.h[coarsest_level]) / 2;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (thickness_m(obstacle) >= least) continue;
    throw base::Error(
        std::string("obstacle: ") + shape_name(obstacle.shape),
        "is " + base::shortest(thickness_m(obstacle)) +
            " m thick: the largest particles of the run pass through obstacles thinner than " +
            base::shortest(least) + " m",
        std::string("make it thicker, or use a larger n_* (--n-star, or n_star in a protocol)") +
            (coarsest_level > 0 ? ", or the method HiRes, which has only the finest particles" : ""));
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.motion != ObstacleMotion::Free) continue;
    if (!(obstacle.density_kg_m3 >= lightest_free_kg_m3))
      throw base::Error(std::string("obstacle: ") + shape_name(obstacle.shape),
                        "is free and too light: " + base::shortest(obstacle.density_kg_m3) + " kg/m3",
                        "give it " + base::shortest(lightest_free_kg_m3) + " kg/m3 or more");
    if (scene.central_force)
      throw base::Error(std::string("obstacle: ") + shape_name(obstacle.shape),
                        "is free in a scene with a central force, which moves water only",
                        "remove the force, or keep the obstacle fixed");
  }
  o.obstacles = scene.obstacles;
  if (o.obstacles.empty()) return;
  o.bodies.from_host(bodies_at(o.obstacles, time_s, 0));
  place_meshes(o);
  o.wet.resize(o.bodies.size());
  o.wet.zero();
  if (any_free(o.obstacles)) {
    if (time_s > 0)
      throw base::Error("start",
                        "is in the middle of a run, where the positions of its free obstacles are not known",
                        "start at frame 0, or resume from a saved state");
    std::vector<FreeBody> free;
    for (const Obstacle& obstacle : o.obstacles) free.push_back(free_of(obstacle, state));
    o.free.from_host(free);
    if (any_meet(o.obstacles)) begin_meeting(o);
    recorded = true;
  }
  if (!recorded) return;
  o.sums.resize(2 * o.bodies.size());
  o.sums.zero();
}

void begin_patches(FluidState& state, const std::vector<ObstacleGauge>& gauges) {
  if (gauges.empty()) return;
  constexpr float endless = 1e30f;
  auto& o = state.obstacles;
  std::vector<BodyPatch> patches;
  for (const ObstacleGauge& gauge : gauges) {
    const std::string who = "gauge " + gauge.name;
    if (gauge.obstacle >= o.obstacles.size())
      throw base::Error(
          who,
          "is on obstacle " + std::to_string(gauge.obstacle) + " of a scene with " +
              std::to_string(o.obstacles.size()),
          "name an obstacle by its number in the scene, from 0 to one less than the number of obstacles");
    const Obstacle& obstacle = o.obstacles[gauge.obstacle];
    const auto half = half_sides_m(obstacle);
    float low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const double end = half[k] + obstacle.radius_m, edge = 1e-6 * end;
      if (!(gauge.min_m[k] < gauge.max_m[k]) || gauge.min_m[k] > end || gauge.max_m[k] < -end)
        throw base::Error(who,
                          "covers no part of obstacle " + std::to_string(gauge.obstacle) +
                              ": along the obstacle's " + std::string(1, "xyz"[k]) + " axis it goes from " +
                              base::shortest(gauge.min_m[k]) + " to " + base::shortest(gauge.max_m[k]) +
                              " m, and the obstacle from " + base::shortest(-end) + " to " +
                              base::shortest(end) + " m",
                          "give min_m < max_m that enclose a part of its surface, in the obstacle's axes");
      low[k] = gauge.min_m[k] <= edge - end ? -endless : static_cast<float>(gauge.min_m[k]);
      high[k] = gauge.max_m[k] >= end - edge ? endless : static_cast<float>(gauge.max_m[k]);
    }
    patches.push_back(
        {static_cast<int>(gauge.obstacle), {low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  }
  for (int b = 0; b < o.count(); ++b)
    patches.push_back({b, {-endless, -endless, -endless}, {endless, endless, endless}});
  o.patches.from_host(patches);
  o.patch_sums.resize(patches.size());
  o.patch_sums.zero();
}

void count_obstacles(const FluidState& state, MomentumAccount& account) {
  if (!state.impulse.on() || !state.obstacles.recorded()) return;
  const double unit =
      mass_unit(state) * static_cast<double>(MassWay::unit) / static_cast<double>(state.parameters.dt);
  const auto vector = [&](const MassWay& sum) {
    const auto part = [&](std::uint64_t fixed) {
      return unit * static_cast<double>(static_cast<std::int64_t>(fixed));
    };
    return Vec3d{part(sum.x), part(sum.y), part(sum.z)};
  };
  const std::vector<BodySum> sums = state.obstacles.sums.to_host();
  const std::size_t count = sums.size() / 2;
  for (std::size_t b = 0; b < count; ++b) {
    const BodySum& by_effects = sums[count + b];
    account.obstacles.push_back(
        {vector(sums[b].push + by_effects.push), vector(sums[b].moment + by_effects.moment)});
    for (std::size_t k = 0; k < 3; ++k) {
      account.unattributed[k] -= vector(sums[b].push)[k];
      account.effects[k] -= vector(by_effects.push)[k];
    }
  }
  if (state.obstacles.patches.size() == 0) return;
  const std::vector<BodyPatch> patches = state.obstacles.patches.to_host();
  const std::vector<PatchSum> given = state.obstacles.patch_sums.to_host();
  for (std::size_t g = 0; g + count < patches.size(); ++g) {
    const auto body = static_cast<std::size_t>(patches[g].body);
    const PatchSum& whole = given[given.size() - count + body];
    const double share =
        whole.wet > 0 ? static_cast<double>(given[g].wet) / static_cast<double>(whole.wet) : 0;
    const auto with_rest = [&](Vec3d part, const Vec3d& all, const Vec3d& placed) {
      for (std::size_t k = 0; k < 3; ++k) part[k] += share * (all[k] - placed[k]);
      return part;
    };
    const ObstaclePush& all = account.obstacles[body];
    account.obstacle_gauges.push_back(
        {with_rest(vector(given[g].given.push), all.push, vector(whole.given.push)),
         with_rest(vector(given[g].given.moment), all.moment, vector(whole.given.moment))});
  }
}

std::vector<BodyMotion> motions_of(const FluidState& state, double time_s) {
  const ObstacleState& o = state.obstacles;
  std::vector<BodyMotion> out = motions_at(o.obstacles, time_s);
  if (o.free.size() == 0) return out;
  const std::vector<Body> bodies = o.bodies.to_host();
  const std::vector<FreeBody> free = o.free.to_host();
  const std::vector<Vec3> by_others = o.by_others.to_host();
  const double unit = mass_unit(state);
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (std::size_t a = 0; a < 3 && o.meet(); ++a) out[k].others_n_s[a] = unit * vector(by_others[k])[a];
    if (free[k].mass == 0) continue;
    const Body& body = bodies[k];
    out[k].spin_rad_s = vector(body.spin);
    out[k].pose = {vector(body.centre),
                   {static_cast<double>(body.turn.x), static_cast<double>(body.turn.y),
                    static_cast<double>(body.turn.z), static_cast<double>(body.turn.w)}};
    const double mass = unit * static_cast<double>(free[k].mass);
    const double owed = unit * static_cast<double>(state.parameters.dt);
    for (std::size_t a = 0; a < 3; ++a) {
      out[k].velocity_m_s[a] = unit * vector(free[k].momentum)[a] / mass;
      out[k].owed_n_s[a] = owed * vector(free[k].force + free[k].force_left)[a];
      out[k].walls_n_s[a] = unit * vector(free[k].by_walls)[a];
    }
  }
  return out;
}

}  // namespace sim::SIM_BACKEND
