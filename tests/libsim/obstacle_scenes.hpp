#pragma once
/// Helpers for tests of obstacles: the obstacles, scene files that list them, options of small runs.

#include <memory>
#include <string>

#include "libsim/scene/mesh.hpp"
#include "libsim/scene/obstacle.hpp"
#include "tests/libsim/fluid_helpers.hpp"
#include "tests/libsim/mesh_shapes.hpp"

namespace obstacle_test {

using sim::Obstacle;
using sim::ObstacleMotion;
using sim::ObstacleShape;

inline Obstacle sphere(sim::Vec3d at, double radius) {
  Obstacle out;
  out.radius_m = radius;
  out.start.centre_m = at;
  return out;
}
inline Obstacle box(sim::Vec3d at, sim::Vec3d size) {
  Obstacle out;
  out.shape = ObstacleShape::Box;
  out.size_m = size;
  out.start.centre_m = at;
  return out;
}
inline std::shared_ptr<const sim::Mesh> mesh_of(const std::string& text) {
  return std::make_shared<const sim::Mesh>(mesh_test::triangles(text), 0);
}
inline Obstacle mesh(sim::Vec3d at, const std::string& text) {
  Obstacle out;
  out.shape = ObstacleShape::Mesh;
  out.mesh = mesh_of(text);
  out.start.centre_m = at;
  return out;
}
inline Obstacle free_one(Obstacle out, double density) {
  out.motion = ObstacleMotion::Free;
  out.density_kg_m3 = density;
  return out;
}
inline double mass_of(const Obstacle& o) { return o.density_kg_m3 * sim::volume_m3(o); }

/// A tank with low water in one corner, away from the tested obstacles.
inline sim::Scene dry(const std::vector<Obstacle>& obstacles) {
  auto scene = fluid_test::tank({2, 2, 2}, {0.5, 0.25, 0.5}, 0);
  scene.v_ref_m_s = 3;
  scene.obstacles = obstacles;
  return scene;
}

inline sim::SimulationOptions options_of(sim::MethodKind method = sim::MethodKind::HiRes) {
  sim::SimulationOptions out;
  out.method = method;
  out.n_star = 128;
  return out;
}

/// The text of SingleDam with a table for an obstacle.
inline std::string dam_with(const std::string& obstacle, const std::string& format = "2") {
  std::string text = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
  const std::string old = "format = 1";
  return text.replace(text.find(old), old.size(), "format = " + format) + "\n[[obstacle]]\n" + obstacle;
}
inline const std::string sphere_table = "shape = \"sphere\"\ncentre_m = [2.0, 1.0, 2.0]\nradius_m = 0.5\n";

inline std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace obstacle_test
