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

/// Lowest density of a free obstacle. A lighter one would rise out of the water much too high.
inline constexpr double lightest_free_kg_m3 = 50;

/// Motion of an obstacle once the water has settled.
enum class ObstacleMotion {
  Fixed,
  Turns,   ///< about an axis at a constant rate
  Swings,  ///< back and forth along a vector
  Free     ///< moved by the water and gravity
};

/// Position and orientation of a rigid body.
struct Pose {
  std::array<double, 3> centre_m{};
  std::array<double, 4> turn{0, 0, 0,
                             1};  ///< unit quaternion x, y, z, w: from the body's axes to the world's
};

/// Pose and motion of a body.
struct BodyMotion {
  Pose pose;
  // Each of the following vectors except others_n_s is 0 unless the body is free.
  std::array<double, 3> velocity_m_s{};  ///< of its centre
  std::array<double, 3> spin_rad_s{};
  /// Impulse from the water that is not yet applied to the body. In each substep the applied force moves
  /// towards the water's force by the share mass / (mass + added mass) of their difference: a light body
  /// follows with a delay.
  std::array<double, 3> owed_n_s{};
  std::array<double, 3> walls_n_s{};  ///< impulse received from walls in the last frame
  /// Impulse received from other obstacles in the last frame. Obstacles that are not free receive it too, so
  /// that the sum over all obstacles is 0.
  std::array<double, 3> others_n_s{};
};

/// A rigid body. SI units.
struct Obstacle {
  ObstacleShape shape = ObstacleShape::Sphere;
  double radius_m = 0;             ///< of a sphere or a capsule
  double length_m = 0;             ///< of a capsule's axis, between the centres of its round ends; along y
  std::array<double, 3> size_m{};  ///< of a box, along its own axes
  std::shared_ptr<const Mesh> mesh;
  Pose start;  ///< pose while the water settles and at frame 0
  ObstacleMotion motion = ObstacleMotion::Fixed;
  std::array<double, 3> about_m{};      ///< a point of the rotation axis
  std::array<double, 3> axis{0, 1, 0};  ///< direction of the rotation axis, a unit vector
  double rate_rad_s = 0;                ///< angular velocity, right-handed about the axis
  std::array<double, 3> way_m{};        ///< from the middle of a swing to its far end
  double period_s = 0;                  ///< of a swing, which begins in the middle, towards the far end
  double density_kg_m3 = 0;             ///< of a free body, uniform
  double friction = 0;  ///< Coulomb's coefficient of the surface, for contacts that involve a free body
};

inline constexpr std::size_t most_obstacles = 16;
const char* shape_name(ObstacleShape shape);

/// Pose of the obstacle at this time since frame 0, s; for a free obstacle, its pose at the start.
Pose pose_at(const Obstacle& obstacle, double time_s);
/// pose_at() of all obstacles, with velocities of 0.
std::vector<BodyMotion> motions_at(const std::vector<Obstacle>& obstacles, double time_s);
/// World position of a point in the body's axes.
std::array<double, 3> in_world(const Pose& pose, const std::array<double, 3>& own_m);
/// Distance of a point from the surface, negative inside, m.
double signed_distance(const Obstacle& obstacle, const Pose& pose, const std::array<double, 3>& point_m);
/// True if the point is inside. Cheaper than signed_distance() for a point far from a mesh.
bool holds(const Obstacle& obstacle, const Pose& pose, const std::array<double, 3>& point_m);
/// Half sides of the shape's inner box, along its own axes: the shape is every point within radius_m of that
/// box. A capsule's inner box is its axis, a sphere's its centre. The inner box of a mesh contains the mesh.
std::array<double, 3> half_sides_m(const Obstacle& obstacle);
/// Extent of the shape from its centre along each axis of the world; of a mesh, of the box that holds it.
std::array<double, 3> reach_m(const Obstacle& obstacle, const Pose& pose);
double volume_m3(const Obstacle& obstacle);
/// Moments of inertia about the obstacle's own axes divided by its mass, for uniform density, m2.
std::array<double, 3> inertia_m2(const Obstacle& obstacle);
bool any_free(const std::vector<Obstacle>& obstacles);
/// True if contacts must be computed: at least one obstacle is free, and there are several obstacles or any
/// obstacle has friction.
bool any_meet(const std::vector<Obstacle>& obstacles);
bool any_mesh(const std::vector<Obstacle>& obstacles);
/// Thickness, m: a box's shortest side, the diameter of a sphere or capsule, twice a mesh's greatest depth.
double thickness_m(const Obstacle& obstacle);
/// Speed that no point of the obstacle ever exceeds, m/s; 0 (unknown) for a free obstacle.
double top_speed(const Obstacle& obstacle);

/// Reads the tables [[obstacle]] of a scene file of format 2. room_m: Scene::room_m(). origin_m
/// (Scene::origin_m) is subtracted from positions. Mesh files are relative to the folder `beside`.
/// base::Error at file:line:column for what the format forbids, for example an obstacle or its path outside
/// the tank, more than most_obstacles, a speed above most_speed_m_s, or a free obstacle that overlaps another
/// one. Errors in a mesh file name that file and its line.
std::vector<Obstacle> read_obstacles(const base::TomlTable& scene, const std::array<double, 3>& room_m,
                                     const std::array<double, 3>& origin_m, double most_speed_m_s,
                                     const std::optional<std::filesystem::path>& beside = {});

/// Text that lists the obstacles, for people and for keys of saved states; empty without obstacles.
std::string obstacles_in_words(const std::vector<Obstacle>& obstacles);

}  // namespace sim
