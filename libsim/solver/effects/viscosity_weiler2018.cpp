/// Viscosity of fluids as thick as honey: implicit, so that it is stable for any step. It acts on the
/// velocities after the substep's forces and before the particles move. Otherwise gravity would move
/// particles by g dt^2 in each substep, however viscous the fluid is. Velocity that the projections add is
/// damped in the next substep.

#include <algorithm>
#include <cmath>

#include "libsim/solver/effects/sticking.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A pair pulls along the direction e between its particles, in proportion to their relative velocity u:
///   m_i dv_i / dt = -rho_0 sum_j V_i V_j w_ij (e u) e,
/// the form of Weiler et al. 2018, Eq. 7 and 8, symmetric in i and j and central: momentum and angular
/// momentum are conserved, and rigid rotation is not braked. In the paper w is the slope of a kernel divided
/// by the distance r. Here w = c nu / h^5 (1 - q^2)^(3/2) with q = r / h, whose sum on the cubic lattice, the
/// arrangement of fluid at rest, is 1.02 to 1.05 of its integral in every direction. nu = 1/2 int w x^2 y^2 /
/// r^2 dV gives c.
constexpr float pair_rate = 640 / (pi * pi);

/// w_ij V_j divided by c nu V_i.
SIM_FN float weight_of(const Kernel& kernel, float mass_ratio, float r2) {
  const float inverse = reciprocal(kernel.h2);
  const float t = at_least(1 - r2 * inverse, 0.0f);
  return mass_ratio * inverse * inverse * kernel.h * inverse * t * rough_root(t);
}

/// Behind a wall the fluid continues as its mirror image. If the fluid slips, the image has the mirrored
/// velocity. If it sticks, the image has the negative velocity along the wall, so that this velocity is 0 at
/// the wall. Towards the wall it has 1 - 2 upright_share of the particle's velocity: without that share no
/// wall would hold a column up against gravity in the implicit step. Pairs with images are symmetric like
/// other pairs. Images of images, behind edges, are left out.
struct Images {
  Walls walls;
  float turn;  ///< factor of the image's velocity: 1 slips, -1 sticks

  /// True if an image behind wall k may be a neighbour of a particle at `at`. The mean support of a pair is
  /// at most 1.5 times the particle's support, because the coarsest neighbours have twice that support.
  SIM_FN bool near(int k, Vec4 at) const { return walls.distance(k, xyz(at)) < 1.5f * at.w; }
  /// True if wall k acts on both particles: none is in front of an opening of the wall or has passed it.
  SIM_FN bool between(int k, Vec4 a, Vec4 b) const {
    return !walls.absent(k, xyz(a)) && !walls.absent(k, xyz(b));
  }
  SIM_FN Vec4 place(int k, Vec4 at) const {
    return with_w(xyz(at) - 2 * walls.distance(k, xyz(at)) * walls.planes[k].normal, at.w);
  }
  SIM_FN Vec4 velocity(int k, Vec4 v) const {
    const Vec3 normal = walls.planes[k].normal;
    const float upright = upright_share + (2 - upright_share) * turn;
    return with_w(turn * xyz(v) - upright * dot(normal, xyz(v)) * normal, 0);
  }
};

/// Implicit Euler, A v' = v with A = 1 - dt (pairs), by conjugate gradients in the inner product sum_i m_i
/// a_i b_i: A is symmetric in it, and every step, not only the last, conserves momentum and angular momentum.
/// First: computes residual and direction from the velocity. Otherwise: A times the direction. Particles too
/// coarse for the effect are not part of the system: a pair pulls only if both take part.
template <bool First, bool OneLevel, class Bodies>
struct Friction {
  const Vec4* position;
  const Vec4* moving;  ///< velocity or direction
  Neighbours neighbours;
  Images images;
  Bodies bodies;
  float rate;  ///< pair_rate times the viscosity nu times dt, m2
  Vec4* residual;
  Vec4* direction;
  Vec4* bent;    ///< A times direction
  float widest;  ///< largest support of particles on which the effect acts, m

  struct Self {
    Vec4 at, moving;
    PairKernel<OneLevel> pair;
  };

  SIM_FN void add(Vec4 other, Vec4 v, const Self& me, float& x, float& y, float& z) const {
    const Kernel kernel = me.pair.with(other.w);
    const float dx = me.at.x - other.x;
    const float dy = me.at.y - other.y;
    const float dz = me.at.z - other.z;
    const float r2 = dx * dx + dy * dy + dz * dz;
    float ratio = me.pair.mass_ratio(other.w);
    if constexpr (!OneLevel) ratio = other.w <= widest ? ratio : 0.0f;
    const float parting = dx * (me.moving.x - v.x) + dy * (me.moving.y - v.y) + dz * (me.moving.z - v.z);
    const float along =
        quotient(weight_of(kernel, ratio, r2) * parting, at_least(r2, coincident * coincident * kernel.h2));
    x -= along * dx;
    y -= along * dy;
    z -= along * dz;
  }
  /// Adds the pull of particle j; a separate function, so that the loop vectorises (SIM_LANES).
  SIM_FN void add_one(int j, const Self& me, float& x, float& y, float& z) const {
    add(position[j], moving[j], me, x, y, z);
  }
  /// Adds the image of particle j behind wall k.
  SIM_FN void add_image(int k, int j, const Self& me, float& x, float& y, float& z) const {
    const Vec4 other = position[j];
    if (images.between(k, me.at, other))
      add(images.place(k, other), images.velocity(k, moving[j]), me, x, y, z);
  }

  template <class Team>
  SIM_FN void operator()(int i, Team team) const {
    const Vec4 at = position[i];
    if (at.w > widest) {
      if constexpr (First) residual[i] = direction[i] = {0, 0, 0, 0};
      return;
    }
    const Self me{at, moving[i], PairKernel<OneLevel>(at.w)};
    float x = 0;
    float y = 0;
    float z = 0;
    const int count = neighbours.size(i);
    const NeighbourRun run = neighbours.run(i);
    SIM_LANES(x, y, z)
    for (int n = team.rank(); n < count; n += Team::size) add_one(run[n], me, x, y, z);
    for (int k = 0; k < images.walls.count; ++k) {
      if (!images.near(k, at)) continue;
      if (team.rank() == 0) add_image(k, i, me, x, y, z);
      for (int n = team.rank(); n < count; n += Team::size) add_image(k, run[n], me, x, y, z);
    }
    x = team.sum(x);
    y = team.sum(y);
    z = team.sum(z);
    if (team.rank() > 0) return;
    const float scale = rate * mass_of(at.w, 1);
    Vec3 change{scale * x, scale * y, scale * z};
    if constexpr (Bodies::there) change = change - bodies.template taken<First>(at, xyz(me.moving));
    if constexpr (First) {
      residual[i] = direction[i] = with_w(change, 0);
    } else {
      bent[i] = with_w(xyz(me.moving) - change, 0);
    }
  }
};

/// A particle's part of the inner product: m_i a_i b_i, with m_i in m_*, the mass of a particle of level 0.
struct Product {
  const Vec4* position;
  const Vec4* a;
  const Vec4* b;
  float finest_support, widest;
  SIM_FN float operator()(int i) const {
    if (position[i].w > widest) return 0;
    return mass_units_of(position[i].w, finest_support) * dot(xyz(a[i]), xyz(b[i]));
  }
};

/// Step of the conjugate gradients: x += alpha p, r -= alpha A p. Returns m_i r_i r_i.
struct Advance {
  const Vec4* position;
  const Vec4* direction;
  const Vec4* bent;
  Vec4* velocity;
  Vec4* residual;
  const ConjugateStep* step;
  float finest_support, widest;
  SIM_FN float operator()(int i) const {
    if (position[i].w > widest) return 0;
    velocity[i] = with_w(xyz(velocity[i]) + step->along * xyz(direction[i]), 0);
    const Vec3 r = xyz(residual[i]) - step->along * xyz(bent[i]);
    residual[i] = with_w(r, 0);
    return mass_units_of(position[i].w, finest_support) * dot(r, r);
  }
};

/// Computes the next direction of the conjugate gradients: p = r + beta p.
struct Turn {
  const Vec4* residual;
  Vec4* direction;
  const ConjugateStep* step;
  SIM_FN void operator()(int i) const {
    direction[i] = with_w(xyz(residual[i]) + step->turn * xyz(direction[i]), 0);
  }
};

using ViscosityColumns =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours),
               columns(Column::PredictedNext, Column::VelocityNext, Column::Normal, Column::Velocity)>;

template <bool First, bool OneLevel, class Bodies>
Friction<First, OneLevel, Bodies> friction_of(FluidState& state, ViscosityColumns p, Bodies bodies) {
  const auto& k = state.parameters;
  return {.position = p.position(),
          .moving = First ? p.velocity() : p.velocity_next(),
          .neighbours = state.neighbours.view(),
          .images = {state.walls, 1 - 2 * k.effects[EffectOption::ViscosityStick]},
          .bodies = bodies,
          .rate = pair_rate * k.dt * k.effects[EffectKind::Viscosity],
          .residual = p.predicted_next(),
          .direction = p.velocity_next(),
          .bent = p.normal(),
          .widest = state.widest_support(EffectOption::ViscosityCoarsest)};
}

/// Number of steps of the conjugate gradients: the scene's, or 16 to 200 as convergence requires. Convergence
/// requires steps in proportion to the root of the condition number, which is the stiffest pair's rate
/// divided by the rate of the slowest shear between opposite walls (docs/decisions.md).
int steps_of(const FluidState& state) {
  const auto& k = state.parameters;
  const float asked = k.effects[EffectOption::ViscositySteps];
  if (asked > 0) return static_cast<int>(asked);
  const Vec3 size = state.domain.high - state.domain.low;
  const float width = at_most(size.x, size.z);
  const float d = state.lightest_support / 2;
  const float diffusion = k.dt * k.effects[EffectKind::Viscosity];
  const float needed = 5 / (d * std::sqrt(1 / diffusion + 1 / (width * width)));
  return static_cast<int>(std::ceil(std::min(std::max(16.0f, needed), 200.0f)));
}

template <bool OneLevel, class Bodies>
void solve(FluidState& state, ViscosityColumns p, Bodies bodies) {
  const int n = p.size();
  const float finest = state.finest_support;
  const float widest = state.widest_support(EffectOption::ViscosityCoarsest);
  auto& solver = state.conjugate_gradient;
  if (solver.step.size() == 0) {
    solver.step.resize(1);
    solver.step.zero();
  }
  ConjugateStep* const step = solver.step.data();
  Vec4* const residual = p.predicted_next();
  Vec4* const direction = p.velocity_next();
  Vec4* const bent = p.normal();
  for_each_team("viscous residual", n, friction_of<true, OneLevel>(state, p, bodies));
  solver.sum("viscous rest", n, p.capacity(), Product{p.position(), residual, residual, finest, widest},
             TakeRest<Bodies>{{step}, bodies});
  const int steps = steps_of(state);
  for (int s = 0; s < steps; ++s) {
    if (s > 0) for_each("viscous turn", n, Turn{residual, direction, step});
    for_each_team("viscous pairs", n, friction_of<false, OneLevel>(state, p, bodies));
    solver.sum("viscous step", n, p.capacity(), Product{p.position(), direction, bent, finest, widest},
               TakeStep<Bodies>{{step}, bodies});
    solver.sum("viscous advance", n, p.capacity(),
               Advance{.position = p.position(),
                       .direction = direction,
                       .bent = bent,
                       .velocity = p.velocity(),
                       .residual = residual,
                       .step = step,
                       .finest_support = finest,
                       .widest = widest},
               TakeNext<Bodies>{{step}, bodies});
  }
}

template <class Bodies>
void solve_for(FluidState& state, ViscosityColumns p, Bodies bodies) {
  state.one_level ? solve<true>(state, p, bodies) : solve<false>(state, p, bodies);
}

void run_viscosity(FluidState& state, ViscosityColumns p) {
  const auto& k = state.parameters;
  const float stick = k.effects[EffectOption::ViscosityStick];
  if (!state.obstacles.exists()) return solve_for(state, p, NoBodies{});
  auto& o = state.obstacles;
  const BodyListener to = state.effects_listener();
  const bool solved = to.sums || o.free.size() > 0;
  if (solved && o.rows.size() < o.bodies.size()) {
    o.rows.resize(o.bodies.size());
    o.rows.zero();
  }
  const float rate = k.dt * k.effects[EffectKind::Viscosity];
  const float d = 0.5f * state.finest_support;
  const BodyRows rows{.rows = solved ? o.rows.data() : nullptr,
                      .bodies = o.bodies.data(),
                      .free = o.free.size() > 0 ? o.free.data() : nullptr,
                      .count = solved ? o.count() : 0,
                      .unit = 1 + rate / (StickingBodies::nearest * d * d),
                      .dt = k.dt};
  const StickingBodies bodies{.solids = state.solids(),
                              .rows = rows,
                              .rate = rate,
                              .stick = stick,
                              .finest_support = state.finest_support};
  solve_for(state, p, bodies);
  if (to.sums) for_each("record bodies", rows.count, RecordGained{rows, to, k.dt});
}

}  // namespace

std::vector<Stage> viscosity_stages() {
  return {stage_of<run_viscosity>({.name = "viscosity", .phase = Phase::Substep}), loosening_stage()};
}

}  // namespace sim::SIM_BACKEND
