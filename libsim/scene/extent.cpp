#include "libsim/scene/extent.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libsim/scene/fill.hpp"
#include "libsim/scene/vector.hpp"
#include "stats/base/error.hpp"

namespace sim {

Vec3d Scene::room_m() const {
  return {tank_size_m[0], lid ? tank_size_m[1] : std::numeric_limits<double>::infinity(), tank_size_m[2]};
}

double beyond_lid_m(const Scene& scene, const Nozzle& nozzle, double frame_dt_s) {
  const double rise = std::max(scene.gravity_m_s2.along[1], 0.0) * frame_dt_s / 2;
  return nozzle.position_m[1] + (nozzle.speed_m_s + rise) * frame_dt_s - scene.room_m()[1];
}

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
    case Wall::Lid:
      return {0, -1, 0};
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

namespace {

constexpr double always_allowed_cells = 1 << 20;
constexpr double cells_per_particle = 16;
constexpr int most_substeps = 1000;
/// Largest ratio of a tank's longer side to the spacing for which check_ways() checks the tank.
constexpr int most_looks = 1024;

void check_water(const Scene& scene, const std::string& place, const Resolution& resolution) {
  const bool several = scene.water.size() > 1;
  if (several && scene.gate) throw base::Error(place + "water.gate", gate_of_several, no_gate);
  constexpr const char* mend =
      "make the water thicker, or use a larger n_* (--n-star, or n_star in a protocol)";
  for (std::size_t b = 0; b < scene.water.size(); ++b) {
    const WaterBlock& block = scene.water[b];
    const std::string key = several ? fmt::format("water.block[{}].max_m", b) : "water.max_m";
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = block.max_m[k] - block.min_m[k];
      if (side >= resolution.finest_spacing_m) continue;
      throw base::Error(place + key,
                        fmt::format("makes the water {:.3g} m thin, where particles are {:.3g} m apart", side,
                                    resolution.finest_spacing_m),
                        mend);
    }
    const double particle = std::pow(resolution.spacing_m, 3);
    if (!several || volume_m3(block) >= 0.999 * particle) continue;
    throw base::Error(place + key,
                      fmt::format("makes {:.3g} m3 of water, less than a particle of {:.3g} m3",
                                  volume_m3(block), particle),
                      mend);
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

/// Height at which the vertical line through (x, z) meets the obstacle from below; none if the line misses
/// the obstacle.
std::optional<double> height_below(const Obstacle& o, const Pose& pose, double x, double z, double exact_m) {
  double y = 0;
  for (int step = 0; step < 256 && y < 2 * farthest_m; ++step) {
    const double free = signed_distance(o, pose, {x, y, z});
    if (free < exact_m) return y;
    y += free;
  }
  return {};
}

/// The underside of an obstacle that closes the tank: its heights above n x n points of the floor. The
/// outermost points lie one spacing inside the walls.
class Underside {
 public:
  Underside(const Scene& scene, double spacing, int n)
      : n_(n), rim_(0.999 * spacing), sides_{scene.tank_size_m[0], scene.tank_size_m[2]} {}

  /// Measures the heights; false if the vertical line through one of the points misses the obstacle.
  bool measure(const Obstacle& o, const Pose& pose) {
    heights_.clear();
    for (int k = 0; k < n_ * n_; ++k) {
      const auto [x, z] = place(k);
      const auto height = height_below(o, pose, x, z, 1e-4 * rim_);
      if (!height) return false;
      heights_.push_back(*height);
    }
    return true;
  }
  /// True if the obstacle is solid at all points, in the plane `above_m` over the highest point of the
  /// underside.
  bool solid(const Obstacle& o, const Pose& pose, double above_m) const {
    const double y = highest_m() + above_m;
    for (int k = 0; k < n_ * n_; ++k) {
      const auto [x, z] = place(k);
      if (!holds(o, pose, {x, y, z})) return false;
    }
    return true;
  }
  bool is_above(const Vec3d& at) const {
    return at[1] < heights_[static_cast<std::size_t>(index(at[0], 0) + n_ * index(at[2], 1))];
  }
  double highest_m() const { return *std::max_element(heights_.begin(), heights_.end()); }
  double mean_m() const {
    double all = 0;
    for (const double y : heights_) all += y;
    return all / static_cast<double>(heights_.size());
  }

 private:
  double step(std::size_t axis) const { return (sides_[axis] - 2 * rim_) / (n_ - 1); }
  std::pair<double, double> place(int k) const { return {rim_ + k % n_ * step(0), rim_ + k / n_ * step(1)}; }
  int index(double at, std::size_t axis) const {
    return std::clamp(static_cast<int>(std::lround((at - rim_) / step(axis))), 0, n_ - 1);
  }

  int n_;
  double rim_;
  std::array<double, 2> sides_;
  std::vector<double> heights_;
};

/// The underside of an obstacle at its start; none if water can pass the obstacle, or the tank is too narrow
/// or too long for the check. An obstacle closes the tank if the vertical lines through all points of
/// Underside meet it. The points for a mesh are at most one spacing apart, and the mesh must be solid a
/// quarter of its thickness above its underside.
std::optional<Underside> closing(const Obstacle& o, const Scene& scene, double spacing) {
  const auto [shortest, longest] = std::minmax(scene.tank_size_m[0], scene.tank_size_m[2]);
  if (shortest < 3 * spacing || longest > most_looks * spacing) return {};
  if (!Underside(scene, spacing, 2).measure(o, o.start)) return {};
  Underside out(scene, spacing, o.mesh ? std::max(16, static_cast<int>(longest / spacing) + 2) : 16);
  if (!out.measure(o, o.start)) return {};
  if (o.mesh && !out.solid(o, o.start, thickness_m(o) / 4)) return {};
  return out;
}

double lowest_m(const Outlet& outlet, const Scene& scene) {
  if (outlet.wall == Wall::Lid) return scene.tank_size_m[1];
  const auto axes = axes_of(outlet.wall);
  return axes[0] == 1 ? outlet.min_m[0] : axes[1] == 1 ? outlet.min_m[1] : 0;
}

void check_way(const Scene& scene, std::size_t number, std::int64_t n_star) {
  const Obstacle& o = scene.obstacles[number];
  if (o.motion != ObstacleMotion::Swings || o.way_m[1] == 0) return;
  const double spacing = resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  auto underside = closing(o, scene, spacing);
  if (!underside) return;
  for (const Outlet& outlet : scene.outlets)
    if (lowest_m(outlet, scene) < underside->highest_m()) return;
  const double area = scene.tank_size_m[0] * scene.tank_size_m[2];
  double water = 0;
  for (const Vec3d& at : fill_positions(scene, MethodKind::HiRes, n_star))
    if (underside->is_above(at)) water += spacing * spacing * spacing;
  Pose lowest = o.start;
  lowest.centre_m = sum(o.start.centre_m, o.way_m[1] < 0 ? 1 : -1, o.way_m);
  if (!underside->measure(o, lowest)) return;
  const double room = area * underside->mean_m(), lack = (water - room) / area;
  if (lack <= spacing) return;

  const Vector far = reach_m(o, o.start);
  double gap = spacing;
  for (const std::size_t k : {0u, 2u})
    gap = std::min({gap, o.start.centre_m[k] - far[k], scene.tank_size_m[k] - o.start.centre_m[k] - far[k]});
  const double shorter = 1 - lack / std::abs(o.way_m[1]);
  const double way = std::floor(1e4 * shorter * std::hypot(o.way_m[0], o.way_m[1], o.way_m[2])) / 1e4;
  throw base::Error(
      fmt::format("scene {}, n_* {}, obstacle {} ({})", scene.name, n_star, number + 1, shape_name(o.shape)),
      fmt::format("closes the tank like a piston and swings down to where {:.3g} m3 have room below it, but "
                  "{:.3g} m3 of water are there: its gaps to the walls are narrower than the particles' "
                  "spacing of {:.3g} m",
                  room, water, spacing),
      fmt::format("make it narrower by {:.4g} m, {}, or put an [[outlet]] below it",
                  std::ceil(1e4 * 2 * (spacing - gap)) / 1e4,
                  way > 0 ? fmt::format("shorten way_m to a length of {:.4g} m", way)
                          : "let it start above the water and stay there"));
}

}  // namespace

void check_ways(const Scene& scene, std::int64_t n_star) {
  if (!scene.nozzles.empty()) return;
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) check_way(scene, k, n_star);
}

void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m) {
  const std::string place = "scene " + scene.name + ", n_* " + std::to_string(n_star) + ", ";
  check_water(scene, place, resolution_of(scene, method, n_star));
  check_substeps(scene, place, n_star);
  double cells = 1;
  for (const double side : scene.tank_size_m) cells *= side / cell_edge_m;
  const auto particles = static_cast<double>(particle_count(method, n_star));
  const double most = std::max(always_allowed_cells, cells_per_particle * particles);
  if (cells <= most) return check_ways(scene, n_star);
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
