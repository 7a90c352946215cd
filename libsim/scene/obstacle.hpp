#pragma once
/// Rigid obstacles in the tank, as signed-distance shapes.

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace base {
class TomlTable;
}

namespace sim {

class Mesh;  // libsim/scene/mesh.hpp

enum class ObstacleShape { Sphere, Box, Capsule, Mesh };

/// Of free obstacles: lighter ones leap.
inline constexpr double lightest_free_kg_m3 = 50;

/// How an obstacle moves once the water has settled.
enum class ObstacleMotion {
  Fixed,
  Turns,   ///< about an axis at a constant rate
  Swings,  ///< to and fro along a vector
  Free     ///< the water and gravity move it
};

/// Place and attitude of a rigid body.
struct Pose {
  std::array<double, 3> centre_m{};
  std::array<double, 4> turn{0, 0, 0,
                             1};  ///< unit quaternion x, y, z, w: from the body's axes to the world's
};

/// A body on its way.
struct BodyMotion {
  Pose pose;
  // 0 unless it is free:
  std::array<double, 3> velocity_m_s{};  ///< of its centre
  std::array<double, 3> spin_rad_s{};
  /// Push that the water has given and the body has not followed yet. Light bodies follow with a delay, as
  /// the water that goes along has a share in it.
  std::array<double, 3> owed_n_s{};
  std::array<double, 3> walls_n_s{};  ///< what walls gave it in the last frame
  /// What other obstacles gave it in the last frame, also to one that is not free: they sum to 0.
  std::array<double, 3> others_n_s{};
};

/// A rigid body. SI units.
struct Obstacle {
  ObstacleShape shape = ObstacleShape::Sphere;
  double radius_m = 0;             ///< of a sphere or a capsule
  double length_m = 0;             ///< of a capsule's axis, between the centres of its round ends; along y
  std::array<double, 3> size_m{};  ///< of a box, along its own axes
  std::shared_ptr<const Mesh> mesh;
  Pose start;  ///< at rest and at frame 0
  ObstacleMotion motion = ObstacleMotion::Fixed;
  std::array<double, 3> about_m{};      ///< a point of the axis that it turns about
  std::array<double, 3> axis{0, 1, 0};  ///< direction of that axis, a unit vector
  double rate_rad_s = 0;                ///< right-handed about it
  std::array<double, 3> way_m{};        ///< from the middle of a swing to its far end
  double period_s = 0;                  ///< of a swing, which begins in the middle, towards the far end
  double density_kg_m3 = 0;             ///< of a free body, the same in all of it
  double friction = 0;  ///< Coulomb's coefficient of its surface against free bodies, or of a free body's
};

inline constexpr std::size_t most_obstacles = 16;
const char* shape_name(ObstacleShape shape);

/// Where the obstacle is at this time since frame 0, s; of a free one, where it began.
Pose pose_at(const Obstacle& obstacle, double time_s);
/// All of them so, at rest.
std::vector<BodyMotion> motions_at(const std::vector<Obstacle>& obstacles, double time_s);
/// Where a point of the body's own axes lies.
std::array<double, 3> in_world(const Pose& pose, const std::array<double, 3>& own_m);
/// Distance of a point from the surface, negative inside, m.
double signed_distance(const Obstacle& obstacle, const Pose& pose, const std::array<double, 3>& point_m);
/// Is the point inside? Quicker than its distance.
bool holds(const Obstacle& obstacle, const Pose& pose, const std::array<double, 3>& point_m);
/// Half the sides of the box round which the shape lies within radius_m, along its own axes: of a box half
/// its sides, of a capsule half its axis. A mesh lies in that box.
std::array<double, 3> half_sides_m(const Obstacle& obstacle);
double volume_m3(const Obstacle& obstacle);
/// Moments of inertia about its own axes over its mass, of an even density, m2.
std::array<double, 3> inertia_m2(const Obstacle& obstacle);
bool any_free(const std::vector<Obstacle>& obstacles);
/// Is one free that may meet another, or has friction?
bool any_meet(const std::vector<Obstacle>& obstacles);
bool any_mesh(const std::vector<Obstacle>& obstacles);
/// The shortest way through the middle, m; of a mesh twice the depth of its deepest place.
double thickness_m(const Obstacle& obstacle);
/// Speed that no point of it ever exceeds, m/s; of a free one nobody knows: 0.
double top_speed(const Obstacle& obstacle);

/// The tables [[obstacle]] of a scene file of format 2. Errors are base::Error at file:line:column: unknown
/// key, a size that is not positive, an axis without direction, a place or a way that leaves the tank, more
/// than most_obstacles, one that is faster than most_speed_m_s, a free one that begins inside another or
/// another in it; in a mesh's file at file:line. origin_m: Scene::origin_m, which places then count from.
/// beside: the folder that files of meshes count from, if the text has one.
std::vector<Obstacle> read_obstacles(const base::TomlTable& scene, const std::array<double, 3>& tank_size_m,
                                     const std::array<double, 3>& origin_m, double most_speed_m_s,
                                     const std::optional<std::filesystem::path>& beside = {});

/// The obstacles in words, for people and for keys of saved states; empty without any.
std::string obstacles_in_words(const std::vector<Obstacle>& obstacles);

}  // namespace sim
