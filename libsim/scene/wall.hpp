#pragma once
/// The walls of a tank, which is open above.

#include <array>
#include <cstddef>

namespace sim {

/// Each with its inward normal: +x, -x, +z, -z, +y.
enum class Wall { LowX, HighX, LowZ, HighZ, Floor };
inline constexpr std::size_t wall_count = 5;

std::array<double, 3> inward_normal(Wall wall);
/// The two axes that a wall lies along, ascending: 0 = x, 1 = y, 2 = z.
std::array<std::size_t, 2> axes_of(Wall wall);

}  // namespace sim
