/// Adhesion: walls and obstacles attract nearby water.

#include "libsim/solver/effects/body_layer.hpp"
#include "libsim/solver/effects/surface_energy.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// Factor on the strength of the sampled attraction (see Adhesion), calibrated with the contact angles of
/// drops of level 0 (docs/decisions.md).
constexpr float pull_share = 0.75f;
/// Constant c = 315 / 256 of the function f (see Adhesion).
constexpr float poly6_behind = 1.23046875f;

/// Corrects f' and f'', the derivatives of a plane's f (see Adhesion), for a round surface of radius R. k = h
/// / R, q: distance divided by h. f' becomes f' (1 + k q)^(-1/2) at a cylinder and f' / (1 + k q) at a
/// sphere. f'' gets an additional part f' k / (1 + k q) perpendicular to the normal; a plane's f'' acts only
/// along the normal.
struct Rounding {
  float share = 1, share_slope = 0, turn = 0;
  Vec3 straight{0, 0, 0};  ///< direction in which the surface is not curved

  SIM_FN Rounding(const Body& body, Vec3 x, float q, float h) {
    if (body.radius == 0) return;
    const float k = h / body.radius;
    const float whole = 1 / (1 + k * q);
    turn = k * whole;
    const bool on_side = fabsf(body.to_body(x).y) < body.half.y;
    share = on_side ? sqrtf(whole) : whole;
    share_slope = (on_side ? -0.5f : -1.0f) * turn * share;
    if (on_side) straight = turned(body.turn, {0, 1, 0});
  }
  SIM_FN Vec3 across(Vec3 n) const { return n - dot(n, straight) * straight; }
};

/// Change of a particle's velocity by a body, m/s: normal part (along) and tangential part (across).
struct Pulled {
  Vec3 along, across;
};

/// A wall acts like fixed water that has no surface itself: the pair forces of surface tension act between
/// the wall and the water in front of it. For a plane wall their sum over the half-space behind the wall is
///   m_i dv_i / dt = sigma V_i / h^2 [pull s_i f'(q) - smoothing f''(q) n_i] along the wall's normal,
/// with f the share of poly6 behind the wall (Walls::behind) and q the distance from the wall divided by h.
/// This force acts where the water's surface meets the wall. Its work of adhesion is sigma, which gives a
/// contact angle of 90 degrees. For a smaller work the force is multiplied by (work / sigma)^2.
///
/// Work above sigma comes from the published attraction by wall samples, A(q) = (-4 q^2 + 6 q - 2)^(1/4) for
/// 1/2 < q < 1, summed over a plane at the distance s: g(q) = q int_q^1 A, along the normal. dv = -dt w /
/// (rho_0 h^2) g(s / h) / G with G = int_0^1 q g(q) dq, so that removing a unit area of water from the wall
/// costs the additional work w, for any particle size. An obstacle attracts along its surface normal, in
/// proportion to its own surface area. Particles that are too coarse for the effect cohesion are not
/// attracted.
template <class Bodies>
struct Adhesion {
  const Vec4* position;
  const float* density;
  const Vec4* normal;
  Walls walls;
  Bodies bodies;
  Vec4* velocity;
  float held;      ///< dt sigma / rho_0 times the square of min(work / sigma, 1), m3/s
  float strength;  ///< dt w / rho_0 times pull_share, w = max(work - sigma, 0), m3/s
  float whole;     ///< integral of the published attraction A(q) over q from 1/2 to 1
  float per_g;     ///< 1 / G, G = int_0^1 q g(q) dq: scales the attraction to the additional work w
  float widest;    ///< largest support of particles on which the effect acts, m

  SIM_FN void operator()(int i) const {
    const Vec4 at = position[i];
    if (at.w > widest) return;
    const Vec3 n = xyz(normal[i]);
    const float s = skin(density[i]);
    Vec3 v = xyz(velocity[i]);
    for (int k = 0; k < walls.count; ++k) {
      const float q = walls.distance_in_h(k, xyz(at), at.w);
      if (q >= 1) continue;
      v += -pull(at.w, q, s, n, walls.planes[k].normal) * walls.planes[k].normal;
    }
    if constexpr (Bodies::there) {
      for_bodies_within(bodies.solids, xyz(at), at.w, [&](int b, const Body& body, const Body::Near& near) {
        v += bodies.visit(b, at, pulled_by(body, at, near, s, n));
      });
    }
    velocity[i] = with_w(v, 0);
  }
  /// Change of a particle's speed towards a wall, m/s.
  SIM_FN float pull(float h, float q, float skin, Vec3 n, Vec3 away) const {
    return (strength * per_g * sampled(q) + held * tied(q, skin, dot(n, away))) / (h * h);
  }
  SIM_FN Pulled pulled_by(const Body& body, Vec4 at, const Body::Near& near, float skin, Vec3 n) const {
    const float q = at_least(near.distance / at.w, 0.0f);
    const Rounding round(body, xyz(at), q, at.w);
    const float share = face_share(body, xyz(at), near.distance / 2);  // halfway to the particle
    const float t = 1 - q * q;
    const float slope = -poly6_behind * t * t * t * t;
    const float bend = 8 * poly6_behind * q * t * t * t;
    const float f1 = slope * round.share;
    const float f2 = bend * round.share + slope * round.share_slope;
    const float out = dot(n, near.normal);
    const float along = -share * strength * per_g * sampled(q) +
                        held * (pull_strength * skin * f1 - smoothing_strength * f2 * out);
    const float scale = 1 / (at.w * at.w);
    return {scale * along * near.normal,
            -scale * held * smoothing_strength * f1 * round.turn * round.across(n - out * near.normal)};
  }

  /// Attraction by the fixed water behind a wall. f' = -c (1 - q^2)^4 and f'' = 8 c q (1 - q^2)^3, c = 315 /
  /// 256.
  SIM_FN static float tied(float q, float skin, float normal) {
    const float t = 1 - q * q;
    return poly6_behind * t * t * t * (pull_strength * skin * t + 8 * smoothing_strength * q * normal);
  }

  /// The function g(q) = q int_q^1 A, the attraction A of wall samples summed over a plane. With 4 q - 3 =
  /// sin t, A dq = cos^(3/2) t dt / (4 sqrt 2), which is integrated over t by Simpson's rule.
  SIM_FN float sampled(float q) const {
    if (q <= 0.5f) return q * whole;
    return q * beyond(q);
  }
  SIM_FN static float beyond(float q) {
    constexpr int steps = 8;
    const float from = asinf(at_most(4 * q - 3, 1.0f));
    const float step = (pi / 2 - from) / steps;
    float sum = 0;
    for (int k = 0; k < steps; ++k) {  // the last term is 0
      const float c = at_least(cosf(from + step * static_cast<float>(k)), 0.0f);
      sum += (k == 0 ? 1.0f : k % 2 ? 4.0f : 2.0f) * c * sqrtf(c);
    }
    return sum * step / 3 * 0.17677670f;
  }
};

using AdhesionColumns =
    ColumnView<columns(Column::Position, Column::Density, Column::Normal, Column::Velocity),
               columns(Column::Velocity)>;

struct PullingBodies {
  static constexpr bool there = true;
  Solids solids;
  BodyListener to;
  /// Records the reaction on the body. The tangential part acts at the body's centre, without a moment,
  /// because tension cannot turn a body about an axis about which it is round.
  SIM_FN Vec3 visit(int body, Vec4 at, Pulled change) const {
    if (to.sums) {
      const float way = solids.dt * mass_units_of(at.w, to.finest_support);
      to.add(body, at, xyz(at), way * change.along);
      to.add(body, at, solids.bodies[body].centre, way * change.across);
    }
    return change.along + change.across;
  }
};

template <class Bodies>
void launch(FluidState& state, AdhesionColumns p, Bodies bodies) {
  // int_1/2^1 A and G in closed form: with B(x, y) Euler's beta function, A's zeroth and second moments about
  // 3/4 are B(1/2, 5/4) / (4 sqrt 2) and B(3/2, 5/4) / (64 sqrt 2); G = int A q^3 / 3.
  const double whole = std::beta(0.5, 1.25) / (4 * std::sqrt(2.0));
  const double second = std::beta(1.5, 1.25) / (64 * std::sqrt(2.0));
  const double g = (0.421875 * whole + 3 * 0.75 * second) / 3;
  const auto& k = state.parameters;
  const float tension = k.effects[EffectKind::Cohesion], work = k.effects[EffectKind::Adhesion];
  const float share = at_most(work / tension, 1.0f);
  const float rate = k.dt / k.rest_density;
  for_each("adhesion", p.size(),
           Adhesion<Bodies>{.position = p.position(),
                            .density = p.density(),
                            .normal = p.normal(),
                            .walls = state.walls,
                            .bodies = bodies,
                            .velocity = p.velocity(),
                            .held = share * share * tension * rate,
                            .strength = pull_share * at_least(work - tension, 0.0f) * rate,
                            .whole = static_cast<float>(whole),
                            .per_g = static_cast<float>(1 / g),
                            .widest = state.widest_support(EffectOption::CohesionCoarsest)});
}

void run_adhesion(FluidState& state, AdhesionColumns p) {
  if (!state.obstacles.exists()) return launch(state, p, NoBodies{});
  launch(state, p, PullingBodies{state.solids(), state.effects_listener()});
}

}  // namespace

std::vector<Stage> adhesion_stages() {
  return {stage_of<run_adhesion>({.name = "adhesion", .phase = Phase::SubstepEnd})};
}

}  // namespace sim::SIM_BACKEND
