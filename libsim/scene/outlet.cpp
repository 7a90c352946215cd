#include "libsim/scene/outlet.hpp"

#include <algorithm>
#include <string>

#include "stats/base/toml.hpp"

namespace sim {

namespace {

/// In the order of Wall.
const std::vector<std::string>& wall_names() {
  static const std::vector<std::string> names{"x_low", "x_high", "z_low", "z_high", "y_low"};
  return names;
}

Outlet read_outlet(const base::TomlTable& table, const std::array<double, 3>& tank_size_m,
                   const std::array<double, 3>& origin_m) {
  Outlet out;
  const auto& names = wall_names();
  const auto name = std::find(names.begin(), names.end(), table.choice("wall", names));
  out.wall = static_cast<Wall>(name - names.begin());
  auto min = table.numbers("min_m", 2);
  auto max = table.numbers("max_m", 2);
  const auto axes = axes_of(out.wall);
  for (std::size_t a = 0; a < 2; ++a) {
    min[a] -= origin_m[axes[a]];
    max[a] -= origin_m[axes[a]];
    if (min[a] < -1e-9) table.fail("min_m", "reaches beyond the wall", "keep the outlet within the tank");
    if (!(max[a] - min[a] >= 1e-3))
      table.fail("max_m", "leaves the outlet no area", "make each entry at least 1 mm larger than in min_m");
    if (max[a] > tank_size_m[axes[a]] + 1e-9)
      table.fail("max_m", "reaches beyond the wall", "keep the outlet within the tank");
    out.min_m[a] = min[a];
    out.max_m[a] = max[a];
  }
  return out;
}

}  // namespace

std::vector<Outlet> read_outlets(const base::TomlTable& scene, const std::array<double, 3>& tank_size_m,
                                 const std::array<double, 3>& origin_m) {
  std::vector<Outlet> out;
  for (const auto& table : scene.tables("outlet")) {
    if (out.size() == most_outlets)
      table.fail("", "is one outlet too many", "use at most " + std::to_string(most_outlets));
    out.push_back(read_outlet(table, tank_size_m, origin_m));
  }
  return out;
}

}  // namespace sim
