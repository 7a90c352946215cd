#pragma once
/// Origin of the water's momentum in a frame: walls, forces, nozzles, levels, guards; gauges on the walls.

#include <array>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"

namespace sim {

/// A rectangle on a wall that measures what this part of the wall gives. It ends at the wall's edges; the
/// box's extent across the wall is ignored. It should be several spacings wide: a particle counts with the
/// share of its square d x d that lies inside.
struct Gauge {
  std::string name;
  Wall wall = Wall::Floor;
  Vec3d min_m{}, max_m{};
};
/// Area of the part within the walls of a tank of this inner size (Scene::room_m).
double area_m2(const Gauge& gauge, const Vec3d& room_m);

/// A part of an obstacle's surface that measures what it gives: what lies in a box in the obstacle's own
/// axes, by default all. A box that ends at the obstacle's end or beyond it has no end there.
struct ObstacleGauge {
  std::string name;
  std::size_t obstacle = 0;  ///< in the scene's order
  Vec3d min_m{-1e30, -1e30, -1e30}, max_m{1e30, 1e30, 1e30};
};

/// Momentum that a wall, or a part of it, gave the water in a frame, N s along the inward normal. Walls are
/// frictionless. Mean pressure in Pa = sum() / (frame's time x area); the solver pushes in discrete steps, so
/// average over 5 ms or more.
struct WallPush {
  double missing_density = 0;  ///< the walls' share in the density projections
  double coarse_pressure = 0;  ///< rho_0 q A of the pressure cells at the wall
  double clamp = 0;            ///< held back before the wall, and moved back to it
  double sum() const { return missing_density + coarse_pressure + clamp; }
};

/// Momentum that an obstacle, or a part of its surface, gave the water in a frame: its push, N s, and its
/// moment about the obstacle's centre, N m s. The water gave it the opposite.
struct ObstaclePush {
  Vec3d push{}, moment{};
};

/// The momentum of the water over one frame, kg m/s. after = before + all others.
struct MomentumAccount {
  std::array<WallPush, wall_count> walls;  ///< in the order of Wall
  std::vector<WallPush> gauges;            ///< in the order of SimulationOptions::gauges
  std::vector<ObstaclePush> obstacles;     ///< in the scene's order
  /// In the order of SimulationOptions::obstacle_gauges. Gauges that cover an obstacle without overlap add up
  /// to it: what belongs to no place, such as the drag of the effect viscosity, is spread by wetted area.
  std::vector<ObstaclePush> obstacle_gauges;
  Vec3d before{}, after{};
  Vec3d forces{};     ///< gravity and the central force
  Vec3d flow{};       ///< poured minus taken by nozzles, minus what left through outlets
  Vec3d levels{};     ///< splits and merges
  Vec3d braked{};     ///< by the speed limit and the quarantine
  Vec3d viscosity{};  ///< 0 except rounding, and neighbours of particles that are not solved
  /// By the scene's effects, without the obstacles' part: walls, air, buoyancy, swirl, the residual of the
  /// viscosity solver; other effects 0 except rounding.
  Vec3d effects{};
  Vec3d inherited{};  ///< by particles not solved in the frame (temporal acceleration)
  /// The part of the constraint's push that comes from no wall: the coarse pressure on cells is not a pair
  /// force, unsolved particles do not yield, and positions are rounded.
  Vec3d unattributed{};

  /// Sum over the walls, as a vector.
  Vec3d walls_sum() const;
};

}  // namespace sim
