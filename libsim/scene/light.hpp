#pragma once
/// What lights a scene in pictures: the surroundings of the tank, the colour of deep water, the shadow on the
/// floor. The solver does not read it.

#include <array>

namespace base {
class TomlTable;
}

namespace sim {

/// What surrounds the tank.
enum class Environment {
  Sky,  ///< sun, clouds, and paved ground up to the horizon
  Room  ///< a hall with windows in two walls and lamps in the ceiling
};

struct SceneLight {
  Environment environment = Environment::Sky;
  /// Places clouds, windows and lamps: the same seed gives the same surroundings. 0 to most_light_seed.
  int seed = 0;
  /// Beer-Lambert absorption by water of red, green and blue, 1/m; 0 to most_absorption_per_m.
  std::array<double, 3> absorption_per_m{0.45, 0.14, 0.10};
  /// True: flying water, obstacles and pipes cast a shadow on the floor, also without the effect shadows.
  bool shadow = true;
};

inline constexpr int most_light_seed = 1'000'000;
inline constexpr double most_absorption_per_m = 100;

/// The table [light] of a scene file; the defaults if absent. base::Error at file:line:column, for example
/// for a value out of range.
SceneLight read_light(const base::TomlTable& scene);
/// The checks of read_light() for a scene that was not read from a file.
void check_light(const SceneLight& light);

}  // namespace sim
