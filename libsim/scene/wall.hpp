#pragma once
/// The walls of a tank, which is open at the top.

#include <array>
#include <cstddef>

namespace sim {

/// In order of inward normals: +x, -x, +z, -z, +y.
enum class Wall { LowX, HighX, LowZ, HighZ, Floor };
inline constexpr std::size_t wall_count = 5;

std::array<double, 3> inward_normal(Wall wall);
/// The two axes along which a wall extends, ascending: 0 = x, 1 = y, 2 = z.
std::array<std::size_t, 2> axes_of(Wall wall);

}  // namespace sim
