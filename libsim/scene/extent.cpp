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

const std::vector<std::string>& wall_names() {
  static const std::vector<std::string> names{"x_low", "x_high", "z_low", "z_high", "y_low", "y_high"};
  return names;
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

/// The face of an obstacle that closes the tank, seen from a wall: its distances from n x n points of that
/// wall. The outermost points lie one spacing inside the other walls.
class Face {
 public:
  Face(const Scene& scene, Wall wall, double spacing, int n)
      : across_(axes_of(wall)), axis_(3 - across_[0] - across_[1]), n_(n), rim_(0.999 * spacing) {
    const auto& size = scene.tank_size_m;
    sides_ = {size[across_[0]], size[across_[1]]};
    inwards_ = inward_normal(wall)[axis_];
    wall_ = inwards_ < 0 ? size[axis_] : 0;
  }

  /// Measures the distances; false if the line from one of the points into the tank misses the obstacle.
  bool measure(const Obstacle& o, const Pose& pose) {
    distances_.clear();
    for (int k = 0; k < n_ * n_; ++k) {
      const auto distance = distance_at(o, pose, k);
      if (!distance) return false;
      distances_.push_back(*distance);
    }
    return true;
  }
  /// True if the obstacle is solid at all points, in the plane `behind_m` behind the farthest point of the
  /// face.
  bool solid(const Obstacle& o, const Pose& pose, double behind_m) const {
    for (int k = 0; k < n_ * n_; ++k)
      if (!holds(o, pose, point(k, farthest_m() + behind_m))) return false;
    return true;
  }
  /// True if `at` lies between the wall and the face.
  bool is_before(const Vec3d& at) const {
    return from_wall(at[axis_]) <
           distances_[static_cast<std::size_t>(index(at[across_[0]], 0) + n_ * index(at[across_[1]], 1))];
  }
  double farthest_m() const { return *std::max_element(distances_.begin(), distances_.end()); }
  double mean_m() const {
    double all = 0;
    for (const double distance : distances_) all += distance;
    return all / static_cast<double>(distances_.size());
  }
  double area_m2() const { return sides_[0] * sides_[1]; }
  std::size_t axis() const { return axis_; }
  /// Sign of the obstacle's way, along the axis, that leads to the wall.
  bool leads_to_wall(double way_m) const { return way_m * inwards_ < 0; }
  double from_wall(double at) const { return (at - wall_) * inwards_; }
  /// Smallest gap between the obstacle and the walls beside the face, at most `most_m`.
  double gap_m(const Obstacle& o, double most_m) const {
    const Vector far = reach_m(o, o.start);
    for (std::size_t a = 0; a < 2; ++a) {
      const double at = o.start.centre_m[across_[a]], reach = far[across_[a]];
      most_m = std::min({most_m, at - reach, sides_[a] - at - reach});
    }
    return most_m;
  }

 private:
  Vec3d point(int k, double distance_m) const {
    Vec3d out{};
    out[across_[0]] = rim_ + k % n_ * step(0);
    out[across_[1]] = rim_ + k / n_ * step(1);
    out[axis_] = wall_ + inwards_ * distance_m;
    return out;
  }
  std::optional<double> distance_at(const Obstacle& o, const Pose& pose, int k) const {
    double distance = 0;
    for (int step = 0; step < 256 && distance < 2 * sim::farthest_m; ++step) {
      const double free = signed_distance(o, pose, point(k, distance));
      if (free < 1e-4 * rim_) return distance;
      distance += free;
    }
    return {};
  }
  double step(std::size_t side) const { return (sides_[side] - 2 * rim_) / (n_ - 1); }
  int index(double at, std::size_t side) const {
    return std::clamp(static_cast<int>(std::lround((at - rim_) / step(side))), 0, n_ - 1);
  }

  std::array<std::size_t, 2> across_;
  std::size_t axis_;
  int n_;
  double rim_, wall_ = 0, inwards_ = 1;
  std::array<double, 2> sides_{};
  std::vector<double> distances_;
};

/// The face of an obstacle at its start, seen from a wall; none if water can pass the obstacle, or the tank
/// is too narrow or too long for the check. An obstacle closes the tank if the lines from all points of Face
/// meet it. The points for a mesh are at most one spacing apart, and the mesh must be solid a quarter of its
/// thickness behind its face.
std::optional<Face> closing(const Obstacle& o, const Scene& scene, Wall wall, double spacing) {
  const auto across = axes_of(wall);
  const auto [shortest, longest] = std::minmax(scene.tank_size_m[across[0]], scene.tank_size_m[across[1]]);
  if (shortest < 3 * spacing || longest > most_looks * spacing) return {};
  if (!Face(scene, wall, spacing, 2).measure(o, o.start)) return {};
  Face out(scene, wall, spacing, o.mesh ? std::max(16, static_cast<int>(longest / spacing) + 2) : 16);
  if (!out.measure(o, o.start)) return {};
  if (o.mesh && !out.solid(o, o.start, thickness_m(o) / 4)) return {};
  return out;
}

/// Smallest distance of the outlet from the wall that `face` is seen from, m.
double distance_m(const Outlet& outlet, const Scene& scene, const Face& face) {
  const auto axes = axes_of(outlet.wall);
  for (std::size_t a = 0; a < 2; ++a)
    if (axes[a] == face.axis())
      return std::min(face.from_wall(outlet.min_m[a]), face.from_wall(outlet.max_m[a]));
  return face.from_wall(inward_normal(outlet.wall)[face.axis()] < 0 ? scene.tank_size_m[face.axis()] : 0);
}

/// base::Error if the obstacle swings towards the wall and leaves the water between them too little space.
void check_way(const Scene& scene, std::size_t number, Wall wall, std::int64_t n_star) {
  const Obstacle& o = scene.obstacles[number];
  const double spacing = resolution_of(scene, MethodKind::HiRes, n_star).finest_spacing_m;
  auto face = closing(o, scene, wall, spacing);
  if (!face) return;
  for (const Outlet& outlet : scene.outlets)
    if (distance_m(outlet, scene, *face) < face->farthest_m()) return;
  double water = 0;
  for (const Vec3d& at : fill_positions(scene, MethodKind::HiRes, n_star))
    if (face->is_before(at)) water += spacing * spacing * spacing;
  const double way_m = o.way_m[face->axis()];
  Pose nearest = o.start;
  nearest.centre_m = sum(o.start.centre_m, face->leads_to_wall(way_m) ? 1 : -1, o.way_m);
  if (!face->measure(o, nearest)) return;
  const double room = face->area_m2() * face->mean_m(), lack = (water - room) / face->area_m2();
  if (lack <= spacing) return;

  const double shorter = 1 - lack / std::abs(way_m);
  const double way = std::floor(1e4 * shorter * std::hypot(o.way_m[0], o.way_m[1], o.way_m[2])) / 1e4;
  const std::string& name = wall_names()[static_cast<std::size_t>(wall)];
  const bool down = wall == Wall::Floor;
  throw base::Error(
      fmt::format("scene {}, n_* {}, obstacle {} ({})", scene.name, n_star, number + 1, shape_name(o.shape)),
      fmt::format("closes the tank like a piston and swings {} to where {:.3g} m3 have room {}, but "
                  "{:.3g} m3 of water are there: its gaps to the walls are narrower than the particles' "
                  "spacing of {:.3g} m",
                  down ? "down" : "towards the wall " + name, room, down ? "below it" : "between them", water,
                  spacing),
      fmt::format("make it narrower by {:.4g} m, {}, or put an [[outlet]] {}",
                  std::ceil(1e4 * 2 * (spacing - face->gap_m(o, spacing))) / 1e4,
                  way > 0 ? fmt::format("shorten way_m to a length of {:.4g} m", way)
                  : down  ? "let it start above the water and stay there"
                          : "let it start farther from that wall",
                  down ? "below it" : "between them"));
}

}  // namespace

void check_ways(const Scene& scene, std::int64_t n_star) {
  if (!scene.nozzles.empty()) return;
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
    if (scene.obstacles[k].motion != ObstacleMotion::Swings) continue;
    for (const Wall wall : {Wall::Floor, Wall::Lid, Wall::LowX, Wall::HighX, Wall::LowZ, Wall::HighZ}) {
      // In a tank without a lid, water rises between an obstacle and a side wall.
      if (wall != Wall::Floor && !scene.lid) continue;
      const auto across = axes_of(wall);
      if (scene.obstacles[k].way_m[3 - across[0] - across[1]] != 0) check_way(scene, k, wall, n_star);
    }
  }
}

void check_extent(const Scene& scene, MethodKind method, std::int64_t n_star, double cell_edge_m) {
  const std::string place = "scene " + scene.name + ", n_* " + std::to_string(n_star) + ", ";
  check_water(scene, place, resolution_of(scene, method, n_star));
  // A coarse lattice, which is soon filled, nearly always finds water.
  const std::int64_t coarse = std::min<std::int64_t>(n_star, 512);
  if (!scene.obstacles.empty() && fill_positions(scene, method, coarse).empty() &&
      fill_positions(scene, method, n_star).empty())
    throw base::Error(place + "obstacle", "leaves no water: all of it would begin inside obstacles",
                      "make the obstacles smaller, or put the water beside them");
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
