/// Obstacles that the water and gravity move.

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Takes each body to the substep's end, where the water meets it.
struct Move {
  Body* bodies;
  FreeBody* free;
  Walls walls;
  Guards* guards;
  float gravity, dt, most_speed;
  bool first;  ///< of the frame
  bool held;   ///< the water has only just been let go: what it gives is not known yet

  SIM_FN void operator()(int b) const {
    FreeBody& it = free[b];
    if (it.mass == 0) return;
    if (first) it.by_walls = {0, 0, 0};
    if (first) it.counted = {};
    if (held) return;
    Body& body = bodies[b];
    it.momentum += dt * it.force;
    it.momentum.y -= it.mass * gravity * dt;
    it.spin += dt * it.torque;
    limit(it);
    WallContact{walls, body, it, dt}.stop();
    const Vec3 from = body.centre;
    body.centre = fused(from, dt / it.mass, it.momentum);
    // The spin of the middle of the way.
    const Vec4 halfway = turned_by(body.turn, (0.5f * dt) * spin_of(it, body.turn, it.spin));
    body.spin = spin_of(it, halfway, it.spin);
    body.turn = turned_by(body.turn, dt * body.spin);
    body.centre += WallContact{walls, body, it, dt}.way_back();
    body.velocity = (1 / dt) * (body.centre - from);
  }
  SIM_FN void limit(FreeBody& it) const {
    const float speed = length(it.momentum) / it.mass;
    if (speed <= most_speed) return;
    atomic_add(&guards->speed_limited, std::uint64_t{1});
    it.momentum = (most_speed / speed) * it.momentum;
  }
};

/// What the water gave in the substep. A body that is lighter than the water that goes along with it would
/// swing: the water answers its last acceleration, with the force of its added mass. Counted as inertia of
/// the body on both sides of Newton's law, m a' + m_a a' = F + m_a a, that force no longer matters. This is F
/// followed by a share of m / (m + m_a); what is left is followed later.
struct Push {
  FreeBody* free;
  const Body* bodies;
  const BodySum* sums;
  float per_dt2;   ///< of the sums' ways
  int held_steps;  ///< while a body is held, steps over which its force is the mean; 0: it is not

  SIM_FN void operator()(int b) const {
    FreeBody& it = free[b];
    if (it.mass == 0) return;
    const Vec3 push = -per_dt2 * (sums[b].push - it.counted.push).value();
    const Vec3 moment = turning(bodies[b], -per_dt2 * (sums[b].moment - it.counted.moment).value());
    it.counted = sums[b];
    const float share = held_steps > 0 ? 1.0f / static_cast<float>(held_steps) : it.follows;
    it.force += share * (push - it.force);
    it.torque += share * (moment - it.torque);
  }
  /// Pressure turns no body about an axis round which it is round; cells alone would.
  SIM_FN static Vec3 turning(const Body& body, Vec3 moment) {
    if (body.radius == 0) return moment;
    if (body.half.y == 0) return {0, 0, 0};
    const Vec3 axis = turned(body.turn, {0, 1, 0});
    return moment - dot(moment, axis) * axis;
  }
};

bool held(const FluidState& state) { return state.obstacles.frame_begin_s <= 0; }

void move(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const auto& k = state.parameters;
  for_each("move bodies", o.count(),
           Move{.bodies = o.bodies.data(),
                .free = o.free.data(),
                .walls = state.walls,
                .guards = state.guard(),
                .gravity = k.gravity,
                .dt = k.dt,
                .most_speed = k.most_speed,
                .first = state.substep == 0,
                .held = held(state)});
}

void push(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const float dt = state.parameters.dt;
  for_each("push bodies", o.count(),
           Push{.free = o.free.data(),
                .bodies = o.bodies.data(),
                .sums = o.sums.data(),
                .per_dt2 = 1 / (dt * dt),
                .held_steps = held(state) ? state.substep + 1 : 0});
}

std::string if_free(const Demand& demand) { return demand.free_obstacles ? "an obstacle is free" : ""; }

}  // namespace

Stage bodies_move_stage() {
  return stage_of<move>({.name = "bodies move",
                         .source = "Newton's and Euler's laws, inelastic contact with walls",
                         .phase = Phase::Substep,
                         .called_for = if_free});
}

Stage bodies_pushed_stage() {
  return stage_of<push>({.name = "bodies are pushed",
                         .source = "what the water gives them, less the added mass",
                         .phase = Phase::SubstepEnd,
                         .called_for = if_free});
}

}  // namespace sim::SIM_BACKEND
