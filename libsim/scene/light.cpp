#include "libsim/scene/light.hpp"

#include <algorithm>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

SceneLight read_light(const base::TomlTable& scene) {
  SceneLight out;
  if (!scene.has("light")) return out;
  const auto table = scene.table("light");
  if (table.choice_or("environment", "sky", {"sky", "room"}) == "room") out.environment = Environment::Room;
  out.seed = static_cast<int>(table.integer_or("seed", out.seed, {0, most_light_seed}));
  if (table.has("absorption_per_m")) {
    const auto v = table.numbers("absorption_per_m", 3, {0, most_absorption_per_m});
    std::copy(v.begin(), v.end(), out.absorption_per_m.begin());
  }
  out.shadow = table.boolean_or("shadow", out.shadow);
  return out;
}

void check_light(const SceneLight& light) {
  if (light.seed < 0 || light.seed > most_light_seed)
    throw base::Error("light", "seed = " + std::to_string(light.seed) + " is out of range",
                      "use 0 to " + std::to_string(most_light_seed));
  for (const double a : light.absorption_per_m) {
    if (!(a >= 0 && a <= most_absorption_per_m))
      throw base::Error("light", "absorption_per_m = " + base::shortest(a) + " is out of range",
                        "use 0 to " + base::shortest(most_absorption_per_m));
  }
}

}  // namespace sim
