#pragma once
/// Surface normals: a term of a loop over neighbours.

#include "libsim/solver/stages/pair_loop.hpp"

namespace sim::SIM_BACKEND {

/// n_i = h_i sum_j V_j grad W_ij of poly6, dimensionless: 0 inside and at walls, about 1 at a surface,
/// pointing inwards; 0 for particles that are not solved or too coarse for tension.
template <class Boundary>
struct SurfaceNormals {
  static constexpr int sums = 3;
  Boundary walls;
  Vec4* normal;
  float widest;  ///< largest support of particles on which the effect acts, m

  SIM_FN bool takes(float h) const { return h <= widest; }
  struct Self {};
  SIM_FN Self self(int) const { return {}; }
  SIM_FN void add(const NeighbourPair& pair, Self, float& nx, float& ny, float& nz, float&) const {
    const float along = 6 * pair.slope;
    nx -= along * pair.x;
    ny -= along * pair.y;
    nz -= along * pair.z;
  }
  SIM_FN void finish(int i, Vec4 at, Self, float nx, float ny, float nz, float) const {
    Vec3 wall;
    walls.missing(xyz(at), at.w, wall);
    normal[i] = with_w(at.w * (mass_of(at.w, 1) * Vec3{nx, ny, nz} + wall), 0);
  }
  SIM_FN void skip(int i) const { normal[i] = {0, 0, 0, 0}; }
};

using NormalView = ColumnView<columns(Column::Position, Column::Neighbours), columns(Column::Normal)>;

/// Calls then(term) with the term SurfaceNormals, whose type depends on whether the scene has obstacles.
template <class Then>
void with_surface_normals(FluidState& state, NormalView p, Then then) {
  const float widest = state.widest_support(EffectOption::CohesionCoarsest);
  if (state.obstacles.exists()) {
    then(SurfaceNormals<Solids>{.walls = state.solids(), .normal = p.normal(), .widest = widest});
  } else {
    then(SurfaceNormals<Walls>{.walls = state.walls, .normal = p.normal(), .widest = widest});
  }
}

}  // namespace sim::SIM_BACKEND
