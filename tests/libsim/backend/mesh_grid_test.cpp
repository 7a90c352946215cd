/// Meshes in kernels: distances between nodes and beyond the grid, and contacts with walls.

#include "libsim/particles/mesh_grid.hpp"

#include <gtest/gtest.h>

#include "libsim/particles/free_body.hpp"
#include "libsim/solver/stages/obstacle_state.hpp"
#include "tests/libsim/backend/backend_test.hpp"
#include "tests/libsim/mesh_shapes.hpp"

namespace sim::SIM_BACKEND {

namespace {

/// A mesh's grid on the host.
struct OnHost {
  explicit OnHost(const std::string& text, double spacing_m) : mesh(mesh_test::triangles(text), spacing_m) {
    const DistanceGrid& from = mesh.grid();
    const auto vector = [](const std::array<double, 3>& v) {
      return Vec3{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
    };
    for (const auto& contact : mesh.contacts_m()) contacts.push_back(vector(contact));
    grid = {.low = vector(from.low_m),
            .step = static_cast<float>(from.step_m),
            .nx = from.nodes[0],
            .ny = from.nodes[1],
            .nz = from.nodes[2],
            .values = from.values_m.data(),
            .contacts = contacts.data(),
            .contact_count = static_cast<int>(contacts.size()),
            .turns = {1, 1, 1}};
  }
  Mesh mesh;
  std::vector<Vec3> contacts;
  MeshGrid grid{};
};

Body box(Vec3 half) {
  Body out{};
  out.half = half;
  out.turn = {0, 0, 0, 1};
  return out;
}
const std::string brick = mesh_test::box_text({-0.5, -0.3, -0.2}, {0.5, 0.3, 0.2});
constexpr Vec3 brick_half{0.5f, 0.3f, 0.2f};

Vec3 place(int k, float far) {
  const auto at = [&](int n) {
    return far * (2 * std::fmod(0.5f + 0.618034f * static_cast<float>(k * n) + 0.01f * static_cast<float>(n),
                                1.0f) -
                  1);
  };
  return {at(1), at(3), at(7)};
}

SIM_TEST(MeshGrids, DistancesAreThoseOfTheShapeWithinHalfACell) {
  const OnHost box_mesh(brick, 0.04), ball(mesh_test::ball_text(0.5, 32), 0.04);
  for (int k = 0; k < 5000; ++k) {
    const Vec3 p = place(k, 0.56f);
    EXPECT_NEAR(box_mesh.grid.near(p).distance, box(brick_half).distance(p), 0.02f);
    if (length(p) < 0.08f) continue;  // excludes the cusp in the middle
    EXPECT_NEAR(ball.grid.near(p).distance, length(p) - 0.5f, 0.02f);
    const Body::Near near = ball.grid.near(p);
    EXPECT_NEAR(length(near.normal), 1, 1e-5f);
    if (length(p) > 0.3f) {
      EXPECT_GT(dot(near.normal, p) / length(p), 0.98f);
    }
  }
}

SIM_TEST(MeshGrids, BeyondTheGridDistancesGoOn) {
  const OnHost ball(mesh_test::ball_text(0.5, 32), 0.04);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p = place(k, 3);
    if (length(p) < 0.6f) continue;
    const Body::Near near = ball.grid.near(p);
    EXPECT_NEAR(near.distance / (length(p) - 0.5f), 1, 0.1f);
    EXPECT_GT(dot(near.normal, p) / length(p), 0.95f);
  }
  // The distance is continuous at the grid's border.
  const float end = ball.grid.low.x;
  for (const float y : {-0.3f, 0.0f, 0.2f}) {
    const float inside = ball.grid.near({end + 1e-5f, y, 0.1f}).distance;
    EXPECT_NEAR(ball.grid.near({end - 1e-5f, y, 0.1f}).distance, inside, 1e-4f);
  }
}

/// Solids uses the mesh's grid for a mesh, and the shape itself for other bodies.
SIM_TEST(MeshGrids, SolidsAskTheGrid) {
  const OnHost ball(mesh_test::ball_text(0.5, 32), 0.04);
  Body bodies[2] = {box({0.5f, 0.5f, 0.5f}), box({0.5f, 0.5f, 0.5f})};
  bodies[0].centre = {2, 0, 0};
  bodies[1].centre = {-2, 0, 0};
  const MeshGrid meshes[2] = {{}, ball.grid};
  const Solids solids{.walls = {}, .bodies = bodies, .count = 2, .dt = 0.1f, .meshes = meshes};
  EXPECT_NEAR(solids.distance(0, {2.4f, 0.4f, 0.4f}), -0.1f, 1e-6f);
  EXPECT_NEAR(solids.distance(1, {-1.6f, 0.4f, 0.4f}), length({0.4f, 0.4f, 0.4f}) - 0.5f, 0.01f);
  int body = 0;
  EXPECT_NEAR(solids.nearest_body({-2.7f, 0, 0}, body), 0.2f, 0.01f);
  EXPECT_EQ(body, 1);
  Vec3 gradient;
  const Vec3 before{-1.5f, 0, 0};
  EXPECT_NEAR(solids.missing(before, 0.2f, gradient), 0.5f, 0.06f);
  EXPECT_LT(gradient.x, -1);
  EXPECT_EQ(solids.missing({-1.2f, 0, 0}, 0.2f, gradient), 0);
  Vec3 x{-2.45f, 0, 0};
  EXPECT_TRUE(solids.project(x, x, 0));
  EXPECT_NEAR(x.x, -2.5f, 0.01f);
}

/// A brick of triangles must touch walls as the box of its size does: both are moved out by the same way.
SIM_TEST(MeshGrids, ContactsAreThoseOfTheBox) {
  const OnHost mesh(brick, 0.04);
  Walls walls{};
  walls.planes[walls.count++] = {{0, 1, 0}, 0};
  walls.planes[walls.count++] = {{1, 0, 0}, 0};
  Body body = box(brick_half);
  body.turn = turned_by(body.turn, {0.3f, 0.2f, 0.5f});
  body.centre = {0.4f, 0.3f, 0};
  FreeBody free{};
  free.mass = 2;
  free.inertia = {0.1f, 0.2f, 0.3f};
  free.momentum = {-6, -8, 2};
  constexpr float dt = 0.005f;
  EXPECT_LT(length((WallContact{walls, body, free, dt}.way_back()) -
                   (WallContact{walls, body, free, dt, &mesh.grid}.way_back())),
            1e-5f);
  const WallContact contact{walls, body, free, dt, &mesh.grid};
  EXPECT_EQ(contact.corners(), 8);
  body.centre += contact.way_back();
  contact.stop();
  EXPECT_GT(length(free.spin), 0.0f);
  turn_on(body, free, dt);
  body.centre += (dt / free.mass) * free.momentum;
  EXPECT_LT(length(WallContact{walls, body, free, dt}.way_back()), 0.005f)
      << "as the box's corners say; without walls it would go 0.02 m";
}

}  // namespace

}  // namespace sim::SIM_BACKEND
