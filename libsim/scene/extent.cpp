#include "libsim/scene/extent.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <fstream>
#include <string>

#include "libsim/scene/fill.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

constexpr double always_allowed_cells = 1 << 20;
constexpr double cells_per_particle = 16;
constexpr int most_substeps = 1000;

void check_water(const Scene& scene, const std::string& place, double spacing) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = scene.fill_max_m[k] - scene.fill_min_m[k];
    if (side >= spacing) continue;
    throw base::Error(
        place + "water.max_m",
        fmt::format("makes the water {:.3g} m thin, where particles are {:.3g} m apart", side, spacing),
        "make the water thicker, or use a larger n_* (--n-star, or n_star in a protocol)");
  }
}

void check_substeps(const Scene& scene, const std::string& place, std::int64_t n_star) {
  const int substeps = substeps_of(scene, n_star);
  if (substeps <= most_substeps) return;
  throw base::Error(
      place + "time.v_ref_m_s",
      fmt::format("makes {} substeps a frame, at most {} are computed", substeps, most_substeps),
      "lower it, raise frames_per_s, or use a smaller n_* (--n-star, or n_star in a protocol)");
}

}  // namespace

void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m) {
  const std::string place = "scene " + scene.name + ", n_* " + std::to_string(n_star) + ", ";
  check_water(scene, place, resolution_of(scene, method, n_star).finest_spacing_m);
  check_substeps(scene, place, n_star);
  double cells = 1;
  for (const double side : scene.tank_size_m) cells *= side / cell_edge_m;
  const auto particles = static_cast<double>(particle_count(method, n_star));
  const double most = std::max(always_allowed_cells, cells_per_particle * particles);
  if (cells <= most) return;
  throw base::Error(
      place + "tank.size_m",
      fmt::format("makes {:.3g} cells of pressure for {:.3g} particles, at most {:.3g} are computed", cells,
                  particles, most),
      "make the tank smaller or the water larger");
}

std::optional<double> available_memory_bytes() {
  std::ifstream facts("/proc/meminfo");
  for (std::string name, unit; facts >> name;) {
    double kilobytes = 0;
    if (name == "MemAvailable:" && facts >> kilobytes) return 1024 * kilobytes;
    std::getline(facts, unit);
  }
  return {};
}

void check_memory(MethodKind method, std::int64_t n_star, std::optional<double> available_bytes) {
  const bool adaptive = traits_of(method).adaptive();
  const double wished = (adaptive ? 2.3e3 : 1.1e3) * static_cast<double>(particle_count(method, n_star));
  if (!available_bytes || wished <= *available_bytes) return;
  throw base::Error("n_* " + std::to_string(n_star),
                    fmt::format("takes about {:.3g} GB of memory, {:.3g} GB are free", 1e-9 * wished,
                                1e-9 * *available_bytes),
                    "use a smaller n_* (--n-star, or n_star in a protocol), or free memory");
}

}  // namespace sim
