#include "libsim/scene/wall.hpp"

namespace sim {

std::array<double, 3> inward_normal(Wall wall) {
  switch (wall) {
    case Wall::LowX:
      return {1, 0, 0};
    case Wall::HighX:
      return {-1, 0, 0};
    case Wall::LowZ:
      return {0, 0, 1};
    case Wall::HighZ:
      return {0, 0, -1};
    case Wall::Floor:
      break;
  }
  return {0, 1, 0};
}

std::array<std::size_t, 2> axes_of(Wall wall) {
  const auto normal = inward_normal(wall);
  std::array<std::size_t, 2> out{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (normal[k] == 0) out[count++] = k;
  return out;
}

}  // namespace sim
