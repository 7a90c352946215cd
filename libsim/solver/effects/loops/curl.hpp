#pragma once
/// Curl of the velocity: a term of a loop over neighbours.

#include "libsim/solver/stages/pair_loop.hpp"

namespace sim::SIM_BACKEND {

/// omega_i = sum_j V_j grad W_ij x (v_j - v_i) / s_i with poly6, and |omega_i| in w. s_i = 1/3 sum_j V_j (x_j
/// - x_i) grad W_ij is 1 inside and about one half at a plane surface or wall. For rigid rotation omega is
/// exact inside and within a seventh at a surface or wall, at every level and mix of levels. Particles
/// coarser than the effect's coarsest level get no curl, but count as neighbours.
struct Curl {
  static constexpr int sums = 4;
  /// Minimum s_i used as divisor, so that spray gets almost no curl.
  static constexpr float least_whole = 0.3f;
  /// Value of w for particles without a curl.
  static constexpr float unknown = -1;
  const Vec4* velocity;
  Vec4* curl;
  float widest;  ///< largest support of particles on which the effect acts, m

  SIM_FN bool takes(float h) const { return h <= widest; }
  using Self = Vec4;  ///< the particle's velocity
  SIM_FN Self self(int i) const { return velocity[i]; }
  SIM_FN void add(const NeighbourPair& pair, Self own, float& x, float& y, float& z, float& whole) const {
    const Vec4 v = velocity[pair.j];
    const float ux = own.x - v.x;
    const float uy = own.y - v.y;
    const float uz = own.z - v.z;
    x += pair.slope * (pair.y * uz - pair.z * uy);
    y += pair.slope * (pair.z * ux - pair.x * uz);
    z += pair.slope * (pair.x * uy - pair.y * ux);
    whole += pair.slope * (pair.x * pair.x + pair.y * pair.y + pair.z * pair.z);
  }
  SIM_FN void finish(int i, Vec4 at, Self, float x, float y, float z, float whole) const {
    const float scale = 6 * mass_of(at.w, 1);
    const Vec3 out = (scale / at_least(scale / 3 * whole, least_whole)) * Vec3{x, y, z};
    curl[i] = with_w(out, length(out));
  }
  SIM_FN void skip(int i) const { curl[i] = {0, 0, 0, unknown}; }
};

using CurlView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Neighbours), columns(Column::Normal)>;

inline Curl curl_of(const FluidState& state, CurlView p) {
  return {.velocity = p.velocity(),
          .curl = p.normal(),
          .widest = state.widest_support(EffectOption::VorticityCoarsest)};
}

}  // namespace sim::SIM_BACKEND
