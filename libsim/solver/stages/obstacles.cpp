#include "libsim/scene/mesh.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

namespace {

static_assert(most_bodies == static_cast<int>(most_obstacles));

/// Sets the bodies that are not free. They are passed as a kernel argument, which needs no separate copy to
/// the device.
struct PlaceBodies {
  Body from[most_bodies];
  int which[most_bodies];
  Body* to;
  SIM_FN void operator()(int i) const { to[which[i]] = from[i]; }
};

Vec3 vector(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Body shape_of(const Obstacle& o) {
  Body out{};
  out.half = vector(half_sides_m(o));
  out.radius = static_cast<float>(o.radius_m);
  return out;
}

void place(FluidState& state, ColumnView<ColumnSet{}, ColumnSet{}>) {
  auto& o = state.obstacles;
  const auto dt = static_cast<double>(state.parameters.dt);
  PlaceBodies pass{};
  const auto bodies = bodies_at(o.obstacles, o.frame_begin_s + dt * (state.substep + 1), dt);
  int count = 0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (o.obstacles[k].motion == ObstacleMotion::Free) continue;
    pass.from[count] = bodies[k];
    pass.which[count++] = static_cast<int>(k);
  }
  pass.to = o.bodies.data();
  for_each("place obstacles", count, pass);
}

}  // namespace

std::vector<Body> bodies_at(const std::vector<Obstacle>& obstacles, double time_s, double dt) {
  std::vector<Body> out;
  for (const Obstacle& o : obstacles) {
    Body body = shape_of(o);
    const Pose now = pose_at(o, time_s);
    body.centre = vector(now.centre_m);
    body.turn = {static_cast<float>(now.turn[0]), static_cast<float>(now.turn[1]),
                 static_cast<float>(now.turn[2]), static_cast<float>(now.turn[3])};
    if (dt > 0) {
      const Pose before = pose_at(o, time_s - dt);
      for (std::size_t k = 0; k < 3; ++k) {
        float& v = k == 0 ? body.velocity.x : k == 1 ? body.velocity.y : body.velocity.z;
        v = static_cast<float>((now.centre_m[k] - before.centre_m[k]) / dt);
      }
      if (o.motion == ObstacleMotion::Turns) body.spin = static_cast<float>(o.rate_rad_s) * vector(o.axis);
    }
    out.push_back(body);
  }
  return out;
}

void place_meshes(ObstacleState& state) {
  if (!any_mesh(state.obstacles)) return;
  std::vector<float> distances;
  std::vector<Vec3> contacts;
  std::vector<std::array<std::size_t, 2>> begin;
  for (const Obstacle& o : state.obstacles) {
    begin.push_back({distances.size(), contacts.size()});
    if (!o.mesh) continue;
    const auto& values = o.mesh->grid().values_m;
    distances.insert(distances.end(), values.begin(), values.end());
    for (const auto& contact : o.mesh->contacts_m()) contacts.push_back(vector(contact));
  }
  state.distances.from_host(distances);
  state.mesh_contacts.from_host(contacts);
  std::vector<MeshGrid> meshes;
  for (std::size_t k = 0; k < state.obstacles.size(); ++k) {
    MeshGrid out{};
    if (const auto& mesh = state.obstacles[k].mesh) {
      const DistanceGrid& grid = mesh->grid();
      const auto turns = [&](std::size_t axis) { return mesh->round_about()[axis] ? 0.0f : 1.0f; };
      const std::size_t end = k + 1 < begin.size() ? begin[k + 1][1] : contacts.size();
      out = {.low = vector(grid.low_m),
             .step = static_cast<float>(grid.step_m),
             .nx = grid.nodes[0],
             .ny = grid.nodes[1],
             .nz = grid.nodes[2],
             .values = state.distances.data() + begin[k][0],
             .contacts = state.mesh_contacts.data() + begin[k][1],
             .contact_count = static_cast<int>(end - begin[k][1]),
             .turns = {turns(0), turns(1), turns(2)}};
    }
    meshes.push_back(out);
  }
  state.meshes.from_host(meshes);
}

Stage obstacles_stage() {
  return stage_of<place>({.name = "obstacles",
                          .source = "rigid bodies on the ways that the scene gives them",
                          .phase = Phase::Substep,
                          .called_for = [](const Demand& demand) -> std::string {
                            return demand.moving_obstacles ? "an obstacle moves" : "";
                          }});
}

}  // namespace sim::SIM_BACKEND
