#pragma once
/// The scene's obstacles as the solver has them.

#include <vector>

#include "libsim/particles/free_body.hpp"
#include "libsim/scene/obstacle.hpp"

namespace sim::SIM_BACKEND {

struct ObstacleState {
  std::vector<Obstacle> obstacles;
  double frame_begin_s = 0;  ///< since frame 0
  Array<Body> bodies;        ///< where they are at the end of this substep
  /// Of this frame: what the constraint's pushes gave, as `bodies`, then what effects did. None while nobody
  /// asks what obstacles give.
  Array<BodySum> sums;
  /// Volume of each below the water's level, over that of m_*, as CellWater counts.
  Array<std::uint64_t> wet;
  Array<FreeBody> free;  ///< as `bodies`; none while no obstacle is free
  Array<BodyRow> rows;   ///< as `bodies`; none before an effect solves for them
  // None while no obstacle is a mesh:
  Array<MeshGrid> meshes;     ///< as `bodies`
  Array<float> distances;     ///< of all their grids
  Array<Vec3> mesh_contacts;  ///< of all of them
  // None while no free obstacle meets another or has friction:
  Array<Vec3> by_others;              ///< what others gave each in this frame, m_* m/s
  Array<float> friction;              ///< coefficient of each
  bool rough = false;                 ///< one is not 0
  int feelers = 0;                    ///< the most that one has
  Array<unsigned char> meeting_room;  ///< scratch memory

  bool there() const { return bodies.size() > 0; }
  bool meet() const { return by_others.size() > 0; }
  bool told() const { return sums.size() > 0; }
  int count() const { return static_cast<int>(bodies.size()); }
  void begin_frame() {
    if (told()) sums.zero();
  }
};

/// Brings the grids of obstacles that are meshes to the device.
void place_meshes(ObstacleState& state);

/// The obstacles where a scene has them at this time, as they came there in `dt`; at rest for dt = 0.
std::vector<Body> bodies_at(const std::vector<Obstacle>& obstacles, double time_s, double dt);

}  // namespace sim::SIM_BACKEND
