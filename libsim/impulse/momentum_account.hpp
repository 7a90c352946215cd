#pragma once
/// Account of the water's momentum in a frame by cause, and gauges on walls and obstacles.

#include <array>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"

namespace sim {

/// A rectangle on a wall that measures the push of this part of the wall on the water. Of the box min_m ..
/// max_m, the part beyond the wall's edges and the extent across the wall are ignored. The rectangle should
/// be several particle spacings d wide: a particle counts with the share of its square d x d that lies in the
/// gauge.
struct Gauge {
  std::string name;
  Wall wall = Wall::Floor;
  Vec3d min_m{}, max_m{};
};
/// Area of the gauge within its wall, m2; room_m: inner size of the tank (Scene::room_m).
double area_m2(const Gauge& gauge, const Vec3d& room_m);

/// Measures the push of a part of an obstacle's surface on the water: the part inside a box in the obstacle's
/// own axes, by default the whole surface. On a side on which the box reaches the obstacle's end, the
/// gauge has no bound.
struct ObstacleGauge {
  std::string name;
  std::size_t obstacle = 0;  ///< index of the obstacle in the scene's order
  Vec3d min_m{-1e30, -1e30, -1e30}, max_m{1e30, 1e30, 1e30};
};

/// Momentum that a wall, or a part of it, gave the water in a frame, N s along the inward normal. Walls are
/// frictionless. Mean pressure in Pa = sum() / (frame's time x area); the solver pushes in discrete steps, so
/// average over 5 ms or more.
struct WallPush {
  double missing_density = 0;  ///< by the density projections, in which walls replace missing water
  double coarse_pressure = 0;  ///< by the coarse pressure q: rho_0 q A per cell face of area A at the wall
  double clamp = 0;            ///< by holding particles back in front of the wall, and moving them back to it
  double sum() const { return missing_density + coarse_pressure + clamp; }
};

/// Momentum that an obstacle, or a part of its surface, gave the water in a frame: its push, N s, and the
/// moment about the obstacle's centre, N m s. The water gave the obstacle the opposite.
struct ObstaclePush {
  Vec3d push{}, moment{};
};

/// The momentum of the water over one frame, kg m/s: `after` is `before` plus all changes listed here.
struct MomentumAccount {
  std::array<WallPush, wall_count> walls;  ///< in the order of Wall
  std::vector<WallPush> gauges;            ///< in the order of SimulationOptions::gauges
  std::vector<ObstaclePush> obstacles;     ///< in the scene's order
  /// In the order of SimulationOptions::obstacle_gauges. If gauges cover an obstacle without overlap, their
  /// sum is the obstacle's push: forces without a position, such as the drag of the effect viscosity, are
  /// divided among gauges by wetted area.
  std::vector<ObstaclePush> obstacle_gauges;
  Vec3d before{}, after{};
  Vec3d forces{};     ///< gravity and the central force
  Vec3d flow{};       ///< added minus taken by nozzles, minus the part that left through outlets
  Vec3d levels{};     ///< splits and merges
  Vec3d braked{};     ///< by the speed limit, and by stopping particles that are not finite or far outside
  Vec3d viscosity{};  ///< by the solver's own viscosity (XSPH): 0 except for rounding and for neighbours of
                      ///< unsolved particles
  /// By the scene's effects, without the pushes of obstacles: walls, air drag, buoyancy, vorticity
  /// confinement, and the residual of the viscosity solver. All other effects give 0 except for rounding.
  Vec3d effects{};
  Vec3d inherited{};  ///< velocity changes that unsolved particles inherited (temporal acceleration)
  /// Change by the projections minus the pushes of walls and obstacles. Not 0, because the coarse pressure on
  /// cells is not a pair force, unsolved particles do not react, and positions are rounded.
  Vec3d unattributed{};

  /// Sum of the walls' pushes as a vector, N s.
  Vec3d walls_sum() const;
};

}  // namespace sim
