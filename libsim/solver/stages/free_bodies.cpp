/// Moves the obstacles that water and gravity move, including their contacts with other obstacles.

#include "libsim/particles/free_body.hpp"
#include "libsim/particles/meeting.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Moves each free body to its position at the substep's end. Contacts with water are computed at this
/// position.
struct Move {
  Body* bodies;
  FreeBody* free;
  const MeshGrid* meshes;  ///< of all bodies; nullptr: no body is a mesh
  Walls walls;
  BodyDrive drive;

  SIM_FN void operator()(int b) const {
    FreeBody& it = free[b];
    if (it.mass == 0) return;
    Body& body = bodies[b];
    const float dt = drive.dt;
    drive(it);
    const WallContact contact{walls, body, it, dt, mesh_of(meshes, b)};
    contact.stop();
    const Vec3 from = body.centre;
    body.centre = fused(from, dt / it.mass, it.momentum);
    turn_on(body, it, dt);
    body.centre += contact.way_back();
    body.velocity = (1 / dt) * (body.centre - from);
  }
};

/// Updates the force on each free body from F, the water's push in the substep. A body lighter than the water
/// it accelerates would oscillate: the water responds to its last acceleration a, with the force -m_a a of
/// its added mass. Adding m_a as inertia of the body on both sides of Newton's law for the next acceleration
/// a', m a' + m_a a' = F + m g + m_a a, removes the oscillation. With f = m (a - g), the force applied to the
/// body, the law becomes f' = s F + (1 - s) f, s = m / (m + m_a).
struct Push {
  FreeBody* free;
  const Body* bodies;
  const MeshGrid* meshes;  ///< of all bodies; nullptr: no body is a mesh
  const BodySum* sums;
  const BodySum* by_effects;
  /// volume of each body below the water level (ObstacleState::wet); nullptr: bodies count as wholly under
  /// water
  const std::uint64_t* wet;
  float per_dt;  ///< 1 / dt: converts sums of mass times displacement to momentum
  float per_dt2;

  /// Added mass divided by the mass of the displaced water: 0.5 for a sphere far from walls, 0.64 for a cube;
  /// walls increase it. With half of the true value a light body would oscillate; a value that is too large
  /// only makes bodies respond slowly.
  static constexpr float added_mass = 0.7f;

  SIM_FN void operator()(int b) const {
    FreeBody& it = free[b];
    if (it.mass == 0) return;
    const Vec3 push = -per_dt2 * (sums[b].push - it.counted.push).value();
    const Vec3 moment =
        turning(bodies[b], mesh_of(meshes, b), -per_dt2 * (sums[b].moment - it.counted.moment).value());
    it.counted = sums[b];
    // The pushes of effects act at once: the effects themselves prevent oscillation of a light body.
    it.momentum += -per_dt * (by_effects[b].push - it.counted_of_effects.push).value();
    it.spin += -per_dt * (by_effects[b].moment - it.counted_of_effects.moment).value();
    it.counted_of_effects = by_effects[b];
    const float water = wet ? static_cast<float>(wet[b]) / CellWater::fixed_point : it.volume;
    const float share = it.mass / (it.mass + added_mass * at_most(water, it.volume));
    follow(it.force, it.force_left, push, share);
    follow(it.torque, it.torque_left, moment, share);
  }
  SIM_FN static void follow(Vec3& force, Vec3& left, Vec3 given, float share) {
    force += share * (given - force);
    left += given - force;
  }
  /// The moment without its part along axes about which the body is round. Pressure cannot turn the body
  /// about such an axis, but a moment that is summed over cells could.
  SIM_FN static Vec3 turning(const Body& body, const MeshGrid* mesh, Vec3 moment) {
    if (mesh) {
      const Vec3 own = turned(turned_back(body.turn), moment);
      return turned(body.turn, {mesh->turns.x * own.x, mesh->turns.y * own.y, mesh->turns.z * own.z});
    }
    if (body.radius == 0) return moment;
    if (body.half.y == 0) return {0, 0, 0};
    const Vec3 axis = turned(body.turn, {0, 1, 0});
    return moment - dot(moment, axis) * axis;
  }
};

void move(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  for_each("move bodies", o.count(),
           Move{.bodies = o.bodies.data(),
                .free = o.free.data(),
                .meshes = o.meshes.data(),
                .walls = state.walls,
                .drive = body_drive(state)});
}

void push(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const float dt = state.parameters.dt;
  for_each("push bodies", o.count(),
           Push{.free = o.free.data(),
                .bodies = o.bodies.data(),
                .meshes = o.meshes.data(),
                .sums = o.sums.data(),
                .by_effects = o.sums.data() + o.count(),
                .wet = state.parameters.coarse_cycles > 0 ? o.wet.data() : nullptr,
                .per_dt = 1 / dt,
                .per_dt2 = 1 / (dt * dt)});
}

std::string if_free(const Demand& demand) { return demand.free_obstacles ? "an obstacle is free" : ""; }
std::string if_alone(const Demand& demand) { return demand.obstacles_meet ? "" : if_free(demand); }

}  // namespace

BodyDrive body_drive(FluidState& state) {
  const auto& k = state.parameters;
  return {.guards = state.guard(),
          .lift = k.gravity.lift(),
          .dt = k.dt,
          .most_speed = k.most_speed,
          .first = state.substep == 0};
}

Stage bodies_move_stage() {
  return stage_of<move>({.name = "bodies move",
                         .source = "Newton's and Euler's laws, inelastic contact with walls",
                         .phase = Phase::Substep,
                         .called_for = if_alone});
}

Stage bodies_pushed_stage() {
  return stage_of<push>({.name = "bodies are pushed",
                         .source = "what the water gives them, less the added mass",
                         .phase = Phase::SubstepEnd,
                         .called_for = if_free});
}

namespace {

void meet(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const Meeting meeting{.bodies = o.bodies.data(),
                        .free = o.free.data(),
                        .meshes = o.meshes.data(),
                        .friction = o.friction.data(),
                        .by_others = o.by_others.data(),
                        .walls = state.walls,
                        .drive = body_drive(state),
                        .spacing = state.finest_support / 2,
                        .count = o.count(),
                        .feelers = o.feelers,
                        .rough = o.rough};
  constexpr int threads = 256;
  in_one_block("meet bodies", threads, meeting.bytes(), o.meeting_room, meeting);
}

}  // namespace

Stage bodies_meet_stage() {
  return stage_of<meet>({.name = "bodies meet",
                         .source = "Newton's and Euler's laws, inelastic contact, Coulomb's friction",
                         .phase = Phase::Substep,
                         .called_for = [](const Demand& demand) -> std::string {
                           return demand.obstacles_meet ? "a free obstacle may meet another, or has friction"
                                                        : "";
                         }});
}

}  // namespace sim::SIM_BACKEND
