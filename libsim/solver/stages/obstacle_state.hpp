#pragma once
/// The solver's state of the scene's obstacles.

#include <vector>

#include "libsim/particles/free_body.hpp"
#include "libsim/scene/obstacle.hpp"

namespace sim::SIM_BACKEND {

struct ObstacleState {
  std::vector<Obstacle> obstacles;
  double frame_begin_s = 0;  ///< time at the frame's beginning, since frame 0
  Array<Body> bodies;        ///< positions at the end of this substep
  /// The bodies' pushes on the water in this frame: first one sum per body of all pushes except those of
  /// effects, then one sum per body of those of effects. The array is empty if the obstacles' pushes are not
  /// recorded.
  Array<BodySum> sums;
  /// First the patches of the gauges on obstacles, then one patch for each whole body. The array is empty if
  /// no gauge is on an obstacle.
  Array<BodyPatch> patches;
  Array<PatchSum> patch_sums;  ///< sums of this frame, one per patch
  /// Volume of each body below the water level, in fixed point: a particle of level 0 has the volume
  /// CellWater::fixed_point.
  Array<std::uint64_t> wet;
  Array<FreeBody> free;  ///< one per body; empty if no obstacle is free
  Array<BodyRow> rows;   ///< one per body; empty until the effect viscosity needs them
  // These three arrays are empty if no obstacle is a mesh.
  Array<MeshGrid> meshes;     ///< one per body
  Array<float> distances;     ///< distance values of all grids
  Array<Vec3> mesh_contacts;  ///< contact points of all meshes
  // Used only if meet(): a free obstacle is present, and there is a second obstacle or one has friction.
  /// momentum that each body received from others in this frame, m_* m/s with m_* the mass of a particle of
  /// level 0
  Array<Vec3> by_others;
  Array<float> friction;              ///< friction coefficient of each body
  bool rough = false;                 ///< true if a friction coefficient is not 0
  int feelers = 0;                    ///< the largest number of contact points on one body
  Array<unsigned char> meeting_room;  ///< scratch memory of Meeting

  bool exists() const { return bodies.size() > 0; }
  bool meet() const { return by_others.size() > 0; }
  bool recorded() const { return sums.size() > 0; }
  int count() const { return static_cast<int>(bodies.size()); }
  void begin_frame() {
    if (recorded()) sums.zero();
    if (patches.size() > 0) patch_sums.zero();
  }
  BodyPatches listening_patches() {
    return {patches.data(), patch_sums.data(), static_cast<int>(patches.size()), meshes.data()};
  }
};

/// Copies the distance grids and contact points of obstacles that are meshes to the device.
void place_meshes(ObstacleState& state);

/// The scene's obstacles at time_s, with their mean velocities over the last `dt`, s; at rest for dt = 0.
std::vector<Body> bodies_at(const std::vector<Obstacle>& obstacles, double time_s, double dt);

}  // namespace sim::SIM_BACKEND
