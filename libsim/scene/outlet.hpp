#pragma once
/// Holes in the tank's walls.

#include <array>
#include <cstddef>
#include <vector>

#include "libsim/scene/wall.hpp"

namespace base {
class TomlTable;
}

namespace sim {

/// A rectangle in which a wall is open. Water that passes the wall's plane in it leaves the simulation at the
/// end of that frame. Outlets are closed while the water settles.
struct Outlet {
  Wall wall = Wall::Floor;
  std::array<double, 2> min_m{}, max_m{};  ///< corners along axes_of(wall); each side at least 1 mm
};

inline constexpr std::size_t most_outlets = 4;

/// The tables [[outlet]] of a scene file: wall = "x_low", "x_high", "z_low", "z_high" or "y_low", and min_m
/// and max_m, two numbers each, such as y and z of x_low. Errors are base::Error: unknown key, another wall,
/// no area, a rectangle that exceeds the wall, more than most_outlets. origin_m: Scene::origin_m, subtracted
/// from the rectangles.
std::vector<Outlet> read_outlets(const base::TomlTable& scene, const std::array<double, 3>& tank_size_m,
                                 const std::array<double, 3>& origin_m);

}  // namespace sim
