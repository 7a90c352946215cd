#include "libsim/scene/obstacle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/scene/mesh_reader.hpp"
#include "libsim/scene/overlap.hpp"
#include "libsim/scene/vector.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

using Quaternion = std::array<double, 4>;
constexpr double thinnest_m = 1e-3;
constexpr double most_friction = 10;

double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

Quaternion rotation(const Vector& axis, double angle) {
  const double s = std::sin(angle / 2);
  return {s * axis[0], s * axis[1], s * axis[2], std::cos(angle / 2)};
}
Quaternion product(const Quaternion& a, const Quaternion& b) {
  const Vector u{a[0], a[1], a[2]}, v{b[0], b[1], b[2]};
  const Vector w = sum(sum(cross(u, v), a[3], v), b[3], u);
  return {w[0], w[1], w[2], a[3] * b[3] - dot(u, v)};
}
Vector turned(const Quaternion& q, const Vector& v) {
  const Vector u{q[0], q[1], q[2]};
  const Vector t = cross(u, v);
  return sum(sum(v, 2 * q[3], t), 2, cross(u, t));
}
Quaternion back(const Quaternion& q) { return {-q[0], -q[1], -q[2], q[3]}; }

bool in_room(const Mesh& mesh, const Pose& pose, const Vector& room_m) {
  return std::all_of(mesh.places_m().begin(), mesh.places_m().end(), [&](const Vector& own) {
    const Vector at = in_world(pose, own);
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] < -1e-9 || at[a] > room_m[a] + 1e-9) return false;
    return true;
  });
}
bool in_room(const Obstacle& o, const Pose& pose, const Vector& room_m) {
  if (o.mesh) return in_room(*o.mesh, pose, room_m);
  const Vector far = reach_m(o, pose);
  for (std::size_t a = 0; a < 3; ++a) {
    if (pose.centre_m[a] - far[a] < -1e-9) return false;
    if (pose.centre_m[a] + far[a] > room_m[a] + 1e-9) return false;
  }
  return true;
}

Vector direction(const base::TomlTable& table, const char* key) {
  const auto v = table.numbers(key, 3, {-1e3, 1e3});
  const double size = std::hypot(v[0], v[1], v[2]);
  if (!(size >= 1e-3)) {
    table.fail(key, "has no direction: its length is " + base::shortest(size) + ", less than 0.001",
               "use a longer vector, such as [0.0, 1.0, 0.0]");
  }
  return {v[0] / size, v[1] / size, v[2] / size};
}

Vector place_in_tank(const base::TomlTable& table, const char* key, const Vector& origin_m) {
  const auto [least, most] = std::minmax_element(origin_m.begin(), origin_m.end());
  const auto v = table.numbers(key, 3, {*least - farthest_m, *most + farthest_m});
  return {v[0] - origin_m[0], v[1] - origin_m[1], v[2] - origin_m[2]};
}

void read_motion(const base::TomlTable& table, const Vector& origin_m, Obstacle& out) {
  const std::string word = table.choice_or("motion", "fixed", {"fixed", "turns", "swings", "free"});
  if (word == "turns") {
    out.motion = ObstacleMotion::Turns;
    out.about_m = place_in_tank(table, "about_m", origin_m);
    out.axis = direction(table, "axis");
    out.rate_rad_s = table.number("rate_rad_s", {-1e3, 1e3});
  } else if (word == "swings") {
    out.motion = ObstacleMotion::Swings;
    const auto way = table.numbers("way_m", 3, {-farthest_m, farthest_m});
    out.way_m = {way[0], way[1], way[2]};
    out.period_s = table.number("period_s", {1e-3, 1e6});
  } else if (word == "free") {
    out.motion = ObstacleMotion::Free;
    out.density_kg_m3 = table.number("density_kg_m3", {lightest_free_kg_m3, 1e5});
  }
}

Obstacle read_obstacle(const base::TomlTable& table, const Vector& room_m, const Vector& origin_m,
                       const std::optional<std::filesystem::path>& beside) {
  Obstacle out;
  const base::Range size{thinnest_m, farthest_m};
  const std::string shape = table.choice("shape", {"sphere", "box", "capsule", "mesh"});
  if (shape == "mesh") {
    out.shape = ObstacleShape::Mesh;
    out.mesh = read_mesh(table, size, beside);
    out.start.turn = out.mesh->turn();
  } else if (shape == "box") {
    out.shape = ObstacleShape::Box;
    const auto sides = table.numbers("size_m", 3, size);
    out.size_m = {sides[0], sides[1], sides[2]};
  } else {
    out.radius_m = table.number("radius_m", size);
  }
  if (shape == "capsule") {
    out.shape = ObstacleShape::Capsule;
    out.length_m = table.number("length_m", size);
  }
  out.start.centre_m = place_in_tank(table, "centre_m", origin_m);
  if (table.has("rotation_deg")) {
    const double angle = table.number("rotation_deg", {-360, 360}) * std::numbers::pi / 180;
    out.start.turn = product(rotation(direction(table, "rotation_axis"), angle), out.start.turn);
  }
  read_motion(table, origin_m, out);
  out.friction = table.number_or("friction", 0, {0, most_friction});
  if (!in_room(out, out.start, room_m))
    table.fail("centre_m", "puts a part of the obstacle outside the tank",
               "keep all of it within tank.size_m from tank.origin_m; it may extend beyond the top of a tank "
               "without a lid");
  constexpr int looks = 256;
  const double whole = out.motion == ObstacleMotion::Swings
                           ? out.period_s
                           : 2 * std::numbers::pi / std::max(std::abs(out.rate_rad_s), 1e-9);
  const bool goes_a_way = out.motion == ObstacleMotion::Turns || out.motion == ObstacleMotion::Swings;
  for (int k = 0; k < looks && goes_a_way; ++k) {
    if (!in_room(out, pose_at(out, whole * k / looks), room_m))
      table.fail("motion", "moves a part of the obstacle out of the tank",
                 "move it less far, or put it farther from the walls");
  }
  return out;
}

/// base::Error if the last obstacle overlaps an earlier one at the start and one of the two is free.
void check_apart(const base::TomlTable& table, const std::vector<Obstacle>& obstacles) {
  const Obstacle& last = obstacles.back();
  for (std::size_t k = 0; k + 1 < obstacles.size(); ++k) {
    const Obstacle& other = obstacles[k];
    if (last.motion != ObstacleMotion::Free && other.motion != ObstacleMotion::Free) continue;
    const double deep = overlap_m(last, other);
    if (deep <= least_overlap_m) continue;
    table.fail("centre_m",
               "puts the obstacle " + base::shortest(std::round(deep * 1e5) / 1e5) +
                   " m deep into obstacle " + std::to_string(k + 1) + " of the file, and one of them is free",
               "move them apart: a free obstacle must start outside the others");
  }
}

}  // namespace

const char* shape_name(ObstacleShape shape) {
  return shape == ObstacleShape::Sphere    ? "sphere"
         : shape == ObstacleShape::Box     ? "box"
         : shape == ObstacleShape::Capsule ? "capsule"
                                           : "mesh";
}

Pose pose_at(const Obstacle& o, double time_s) {
  Pose out = o.start;
  if (o.motion == ObstacleMotion::Turns) {
    const Quaternion by = rotation(o.axis, std::fmod(o.rate_rad_s * time_s, 2 * std::numbers::pi));
    out.centre_m = sum(o.about_m, 1, turned(by, sum(o.start.centre_m, -1, o.about_m)));
    out.turn = product(by, o.start.turn);
  } else if (o.motion == ObstacleMotion::Swings) {
    const double phase = 2 * std::numbers::pi * std::fmod(time_s / o.period_s, 1.0);
    out.centre_m = sum(o.start.centre_m, std::sin(phase), o.way_m);
  }
  return out;
}

std::vector<BodyMotion> motions_at(const std::vector<Obstacle>& obstacles, double time_s) {
  std::vector<BodyMotion> out;
  for (const Obstacle& o : obstacles) out.push_back({.pose = pose_at(o, time_s)});
  return out;
}

Vector half_sides_m(const Obstacle& o) {
  if (o.mesh) {
    Vector out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = std::max(-o.mesh->low_m()[k], o.mesh->high_m()[k]);
    return out;
  }
  if (o.shape == ObstacleShape::Box) return {o.size_m[0] / 2, o.size_m[1] / 2, o.size_m[2] / 2};
  return {0, o.shape == ObstacleShape::Capsule ? o.length_m / 2 : 0, 0};
}

Vector reach_m(const Obstacle& o, const Pose& pose) {
  const Vector half = half_sides_m(o);
  Vector out{o.radius_m, o.radius_m, o.radius_m};
  for (std::size_t k = 0; k < 3; ++k) {
    Vector side{};
    side[k] = half[k];
    const Vector way = turned(pose.turn, side);
    for (std::size_t a = 0; a < 3; ++a) out[a] += std::abs(way[a]);
  }
  return out;
}

Vector in_world(const Pose& pose, const Vector& own_m) {
  return sum(turned(pose.turn, own_m), 1, pose.centre_m);
}

double signed_distance(const Obstacle& o, const Pose& pose, const Vector& point_m) {
  const Vector local = turned(back(pose.turn), sum(point_m, -1, pose.centre_m));
  if (o.mesh) return o.mesh->distance_m(local);
  const Vector half = half_sides_m(o);
  Vector outside{};
  double inside = -1e30;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beyond = std::abs(local[k]) - half[k];
    outside[k] = std::max(beyond, 0.0);
    inside = std::max(inside, beyond);
  }
  return (inside > 0 ? length(outside) : inside) - o.radius_m;
}

bool holds(const Obstacle& o, const Pose& pose, const Vector& point_m) {
  if (o.mesh && length(sum(point_m, -1, pose.centre_m)) > o.mesh->farthest_m()) return false;
  return signed_distance(o, pose, point_m) < 0;
}

double volume_m3(const Obstacle& o) {
  if (o.mesh) return o.mesh->volume_m3();
  if (o.shape == ObstacleShape::Box) return o.size_m[0] * o.size_m[1] * o.size_m[2];
  const double disc = std::numbers::pi * o.radius_m * o.radius_m;
  return disc * (4 * o.radius_m / 3 + (o.shape == ObstacleShape::Capsule ? o.length_m : 0));
}

Vector inertia_m2(const Obstacle& o) {
  if (o.mesh) return o.mesh->inertia_m2();
  const double r2 = o.radius_m * o.radius_m;
  if (o.shape == ObstacleShape::Sphere) return {0.4 * r2, 0.4 * r2, 0.4 * r2};
  if (o.shape == ObstacleShape::Box) {
    const auto [x, y, z] = o.size_m;
    return {(y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12};
  }
  // A cylinder and two hemispheres, whose centroids are 3/8 r beyond its ends.
  const double l = o.length_m;
  const double ball = 4 * o.radius_m / (4 * o.radius_m + 3 * l);
  const double across =
      (1 - ball) * (l * l / 12 + r2 / 4) + ball * (0.4 * r2 + l * l / 4 + 0.375 * l * o.radius_m);
  return {across, (1 - ball) * r2 / 2 + ball * 0.4 * r2, across};
}

bool any_free(const std::vector<Obstacle>& obstacles) {
  return std::any_of(obstacles.begin(), obstacles.end(),
                     [](const Obstacle& o) { return o.motion == ObstacleMotion::Free; });
}

bool any_meet(const std::vector<Obstacle>& obstacles) {
  return any_free(obstacles) &&
         (obstacles.size() > 1 ||
          std::any_of(obstacles.begin(), obstacles.end(), [](const Obstacle& o) { return o.friction > 0; }));
}

bool any_mesh(const std::vector<Obstacle>& obstacles) {
  return std::any_of(obstacles.begin(), obstacles.end(),
                     [](const Obstacle& o) { return o.shape == ObstacleShape::Mesh; });
}

double thickness_m(const Obstacle& o) {
  if (o.mesh) return o.mesh->thickness_m();
  if (o.shape == ObstacleShape::Box) return *std::min_element(o.size_m.begin(), o.size_m.end());
  return 2 * o.radius_m;
}

double top_speed(const Obstacle& o) {
  if (o.motion == ObstacleMotion::Swings) return 2 * std::numbers::pi * length(o.way_m) / o.period_s;
  if (o.motion != ObstacleMotion::Turns) return 0;
  const Vector arm = sum(o.start.centre_m, -1, o.about_m);
  const double from_axis = length(sum(arm, -dot(arm, o.axis), o.axis));
  const double beyond = o.mesh ? o.mesh->farthest_m() : length(half_sides_m(o)) + o.radius_m;
  return std::abs(o.rate_rad_s) * (from_axis + beyond);
}

std::vector<Obstacle> read_obstacles(const base::TomlTable& scene, const Vector& room_m,
                                     const Vector& origin_m, double most_speed_m_s,
                                     const std::optional<std::filesystem::path>& beside) {
  std::vector<Obstacle> out;
  for (const auto& table : scene.tables("obstacle")) {
    if (out.size() == most_obstacles)
      table.fail("", "is one obstacle too many", "use at most " + std::to_string(most_obstacles));
    out.push_back(read_obstacle(table, room_m, origin_m, beside));
    if (out.back().motion == ObstacleMotion::Free && scene.has("central_force"))
      table.fail("motion", "is free in a scene with a central force, which would not pull it",
                 "leave central_force out, or keep the obstacle fixed");
    check_apart(table, out);
    if (const double speed = top_speed(out.back()); speed > most_speed_m_s)
      table.fail("motion",
                 "with up to " + base::shortest(speed) + " m/s is faster than time.v_ref_m_s = " +
                     base::shortest(most_speed_m_s) + ", from which the substeps follow",
                 "raise time.v_ref_m_s to at least " + base::shortest(std::ceil(1e3 * speed) / 1e3) +
                     ", or slow the obstacle down");
  }
  return out;
}

std::string obstacles_in_words(const std::vector<Obstacle>& obstacles) {
  std::string out;
  const auto vector = [](const auto& v) {
    std::string text = "(";
    for (const double value : v) text += (text.size() > 1 ? ", " : "") + base::shortest(value);
    return text + ")";
  };
  for (const Obstacle& o : obstacles) {
    out += std::string("  obstacle: ") + shape_name(o.shape);
    if (o.shape == ObstacleShape::Box) out += " of " + vector(o.size_m) + " m";
    if (o.mesh)
      out += " " + o.mesh->sha256().substr(0, 12) + " of " + base::shortest(o.mesh->volume_m3()) + " m3";
    else if (o.shape != ObstacleShape::Box)
      out += " of radius " + base::shortest(o.radius_m) + " m";
    if (o.shape == ObstacleShape::Capsule) out += ", axis " + base::shortest(o.length_m) + " m";
    out += " at " + vector(o.start.centre_m) + " m, turned by " + vector(o.start.turn);
    if (o.motion == ObstacleMotion::Turns)
      out += ", turns about " + vector(o.about_m) + " m along " + vector(o.axis) + " at " +
             base::shortest(o.rate_rad_s) + " rad/s";
    if (o.motion == ObstacleMotion::Swings)
      out += ", swings by " + vector(o.way_m) + " m in " + base::shortest(o.period_s) + " s";
    if (o.motion == ObstacleMotion::Free) out += ", free, " + base::shortest(o.density_kg_m3) + " kg/m3";
    if (o.friction > 0) out += ", friction " + base::shortest(o.friction);
    out += "\n";
  }
  return out;
}

}  // namespace sim
