#pragma once
/// Meshes as obstacles for particles: signed distances at the nodes of a grid (libsim/scene/mesh.hpp).

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Distance of a point from a body's surface, and the surface's normal there.
struct NearSurface {
  float distance;  ///< signed, m
  Vec3 normal;     ///< outwards
};

struct MeshGrid {
  Vec3 low;
  float step;
  int nx, ny, nz;
  const float* values;   ///< distances at the nodes, m; x varies fastest; nullptr: not a mesh
  const Vec3* contacts;  ///< surface points that are tested for contacts, in the body's axes
  int contact_count;
  /// Per axis of the body: 1 if pressure can turn the body about this axis, 0 if the body is rotationally
  /// symmetric.
  Vec3 turns;

  /// Distance and normal of the mesh at p, in the body's axes. Between nodes the distance is trilinear, and
  /// the normal is its gradient. Beyond the grid both refer to the surface point found from the nearest point
  /// of the grid. Not inlined: kernels that also serve scenes without meshes contain only the call.
  SIM_FN_APART NearSurface near(Vec3 p) const {
    const Vec3 most{static_cast<float>(nx - 1), static_cast<float>(ny - 1), static_cast<float>(nz - 1)};
    const Vec3 cells = (1 / step) * (p - low);
    const Vec3 within{at_most(at_least(cells.x, 0.0f), most.x), at_most(at_least(cells.y, 0.0f), most.y),
                      at_most(at_least(cells.z, 0.0f), most.z)};
    const int x = floor_within(within.x, 0, nx - 2);
    const int y = floor_within(within.y, 0, ny - 2);
    const int z = floor_within(within.z, 0, nz - 2);
    const float u = within.x - static_cast<float>(x);
    const float v = within.y - static_cast<float>(y);
    const float w = within.z - static_cast<float>(z);
    const float* at = values + (static_cast<long long>(z) * ny + y) * nx + x;
    const float* up = at + nx;
    const float* back = at + static_cast<long long>(nx) * ny;
    const float* both = back + nx;
    // Slopes along the cell's four edges in x, and the distances on these edges at u.
    const float s0 = at[1] - at[0], s1 = up[1] - up[0], s2 = back[1] - back[0], s3 = both[1] - both[0];
    const float d0 = at[0] + u * s0, d1 = up[0] + u * s1, d2 = back[0] + u * s2, d3 = both[0] + u * s3;
    const float front = d0 + v * (d1 - d0), behind = d2 + v * (d3 - d2);
    const Vec3 slope{(1 - w) * (s0 + v * (s1 - s0)) + w * (s2 + v * (s3 - s2)),
                     (1 - w) * (d1 - d0) + w * (d3 - d2), behind - front};
    const float steep = length(slope);
    // In the middle of a body the gradient can be zero.
    const Vec3 normal = steep > 1e-6f * step ? (1 / steep) * slope : Vec3{0, 1, 0};
    const float distance = front + w * (behind - front);
    if (within.x == cells.x && within.y == cells.y && within.z == cells.z) return {distance, normal};
    const Vec3 from = p - (low + step * within) + distance * normal;
    const float away = length(from);
    return {away, away > 0 ? (1 / away) * from : normal};
  }
};

/// The mesh of a body; nullptr for other shapes.
SIM_FN const MeshGrid* mesh_of(const MeshGrid* meshes, int body) {
  return meshes && meshes[body].values ? &meshes[body] : nullptr;
}

}  // namespace sim::SIM_BACKEND
