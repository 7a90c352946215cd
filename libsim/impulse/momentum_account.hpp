#pragma once
/// Where the water's momentum came from in a frame: walls, forces, nozzles, levels, guards; gauges on the
/// walls.

#include <array>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"

namespace sim {

/// A rectangle on a wall that feels what this part of the wall gives. It ends at the wall's edges; what a box
/// names across the wall is ignored. It should be several spacings wide: a particle counts with the share of
/// its square d x d that lies inside.
struct Gauge {
  std::string name;
  Wall wall = Wall::Floor;
  Vec3d min_m{}, max_m{};
};
/// Of the part between the walls of a tank of this size; the tank is open above.
double area_m2(const Gauge& gauge, const Vec3d& tank_size_m);

/// What a wall, or a part of it, gave the water in a frame, N s along the inward normal. Walls are free of
/// friction. Mean pressure in Pa = sum() / (frame's time x area); the solver pushes in strokes, so average
/// over 5 ms or more.
struct WallPush {
  double missing_density = 0;  ///< the walls' share in the density projections
  double coarse_pressure = 0;  ///< rho_0 q A of the pressure cells at the wall
  double clamp = 0;            ///< held back before the wall, and moved back to it
  double sum() const { return missing_density + coarse_pressure + clamp; }
};

/// What an obstacle gave the water in a frame: its push, N s, and its moment about the obstacle's centre, N m
/// s. The water gave it the opposite.
struct ObstaclePush {
  Vec3d push{}, moment{};
};

/// The momentum of the water over one frame, kg m/s. after = before + all others.
struct MomentumAccount {
  std::array<WallPush, wall_count> walls;  ///< in the order of Wall
  std::vector<WallPush> gauges;            ///< in the order of SimulationOptions::gauges
  std::vector<ObstaclePush> obstacles;     ///< in the scene's order
  Vec3d before{}, after{};
  Vec3d forces{};     ///< gravity and the central force
  Vec3d flow{};       ///< poured less taken by nozzles, less what left through outlets
  Vec3d levels{};     ///< splits and merges
  Vec3d braked{};     ///< by the limit of speed and the quarantine
  Vec3d viscosity{};  ///< 0 but for rounding, and for neighbours of particles that are not solved
  /// That the scene lists, but for what obstacles gave: walls, air, buoyancy, swirl, what the steps of
  /// viscosity have left; others 0 but for rounding.
  Vec3d effects{};
  Vec3d inherited{};  ///< by particles that were not solved in the frame (temporal acceleration)
  /// Of the constraint's push what no wall gave: the coarse pressure on cells is no pair force, particles
  /// that are not solved do not yield, and places are rounded.
  Vec3d unattributed{};

  /// Sum over the walls, as a vector.
  Vec3d walls_sum() const;
};

}  // namespace sim
