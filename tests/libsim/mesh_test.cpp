/// Meshes of obstacles: their text, the mass that they enclose, and distances from them.

#include "libsim/scene/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/libsim/mesh_shapes.hpp"

namespace {

using mesh_test::ball_text;
using mesh_test::box_text;
using mesh_test::triangles;
using testing::HasSubstr;
using Vector = std::array<double, 3>;

const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::string failure(const std::string& text) {
  try {
    triangles(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no failure";
}
std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

double box_distance(const Vector& half, const Vector& p) {
  double outside = 0, inside = -1e30;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beyond = std::abs(p[k]) - half[k];
    outside += beyond > 0 ? beyond * beyond : 0;
    inside = std::max(inside, beyond);
  }
  return inside > 0 ? std::sqrt(outside) : inside;
}

TEST(MeshText, PolygonsSlashesAndNegativeNumbersAreRead) {
  const auto plain = triangles(box_text({0, 0, 0}, {1, 2, 3}));
  EXPECT_EQ(plain.places.size(), 8u);
  EXPECT_EQ(plain.faces.size(), 12u) << "each quad is a fan of two";
  const auto other = triangles(
      "# a comment\r\nmtllib none\no thing\nv 0 0 0 1\nv +1 0 0\nvn 0 0 1\nv 0 1.0e0 0\nv 0 0 1\n"
      "vt 0 0\ng side\ns off\nf 1/1/1 3//1 2/1\nf -4 -3 -1 # behind\n  f 1 4 3\nf\t2 3 4");
  EXPECT_EQ(other.places, triangles(tetrahedron).places);
  EXPECT_EQ(other.faces, triangles(tetrahedron).faces);
  EXPECT_EQ(triangles(sim::obj_of(plain)).faces, plain.faces);
  EXPECT_EQ(triangles(sim::obj_of(plain)).places, plain.places);
}

TEST(MeshText, LoosePlacesAndAByteOrderMarkAreNoPartOfIt) {
  const auto plain = triangles(tetrahedron);
  const std::string loose =
      "v 7 7 7\nv 0 0 0\nv 1 0 0\nv 100 0 0\nv 0 1 0\nv 0 0 1\n"
      "f 2 5 3\nf 2 3 6\nf 2 6 5\nf 3 5 6\nv 1e6 0 0\n";
  for (const std::string& text : {loose, "\xEF\xBB\xBF" + tetrahedron}) {
    EXPECT_EQ(triangles(text).places, plain.places);
    EXPECT_EQ(triangles(text).faces, plain.faces);
  }
}

TEST(MeshText, FailuresNameTheLineAndTheMend) {
  struct Case {
    std::string text, problem, mend;
  };
  const Case cases[] = {
      {"", "line 0 has no face", "f a b c"},
      {"v 0 0 0\n", "line 0 has no face", "f a b c"},
      {changed(tetrahedron, "v 0 1 0", "v 0 1"), "line 3 has a vertex with fewer than three", "v x y z"},
      {changed(tetrahedron, "v 0 1 0", "v 0 x 0"), "line 3 has 'x' where a number", "v x y z"},
      {changed(tetrahedron, "v 0 1 0", "v 0 nan 0"), "line 3 has the coordinate", "scale"},
      {changed(tetrahedron, "v 0 1 0", "v 0 1e7 0"), "line 3 has the coordinate", "scale"},
      {changed(tetrahedron, "f 1 3 2", "f 1 3"), "line 5 has a face with fewer", "f a b c"},
      {changed(tetrahedron, "f 1 3 2", "f 1 3 9"), "line 5 names vertex 9 of 4", "count from 1"},
      {changed(tetrahedron, "f 1 3 2", "f 0 3 2"), "line 5 names vertex 0 of 4", "count from 1"},
      {changed(tetrahedron, "f 1 3 2", "f -5 3 2"), "line 5 names vertex -5 of 4", "count from 1"},
      {changed(tetrahedron, "f 1 3 2", "f a 3 2"), "line 5 has 'a' where the number of a vertex", "f a b c"},
      {changed(tetrahedron, "f 1 3 2", "f 1 3 3"),
       "line 5 has a face, or a triangle of its fan, without area", "remove it"},
      {changed(tetrahedron, "f 1 3 2\n", ""), "line 5 has a hole or a seam: the edge from vertex 1 to 2",
       "close the surface"},
      {changed(tetrahedron, "f 1 3 2", "f 1 2 3"), "is used twice in the same direction", "orient all faces"},
      {tetrahedron + "f 2 3 4\n", "line 9 has a hole or a seam", "two faces at each edge"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n", "line 0 looks inwards",
       "flip all"},
  };
  for (const Case& one : cases) {
    EXPECT_THAT(failure(one.text), HasSubstr(one.problem)) << one.text;
    EXPECT_THAT(failure(one.text), HasSubstr(one.mend)) << one.text;
  }
  EXPECT_EQ(failure(tetrahedron), "no failure");
  std::string fans = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (std::size_t k = 0; k <= sim::most_triangles; ++k) fans += "f 1 2 3\n";
  EXPECT_THAT(failure(fans), HasSubstr("is one triangle too many"));
}

TEST(Mesh, MassOfABoxAndOfATetrahedronIsExact) {
  const auto box = sim::mass_properties(triangles(box_text({1, -1, 4}, {3, 2, 5})));
  EXPECT_NEAR(box.volume_m3, 6, 1e-12);
  const Vector centre{2, 0.5, 4.5}, moments{10.0 / 12, 5.0 / 12, 13.0 / 12};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(box.centre_m[k], centre[k], 1e-12);
    EXPECT_NEAR(box.inertia_m2[k][k], moments[k], 1e-12);
    EXPECT_NEAR(box.inertia_m2[k][(k + 1) % 3], 0, 1e-12);
  }
  // The tetrahedron x, y, z >= 0, x + y + z <= 1: volume 1/6, int x^2 = 1/60, int x y = 1/120.
  const auto corner = sim::mass_properties(triangles(tetrahedron));
  EXPECT_NEAR(corner.volume_m3, 1.0 / 6, 1e-15);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(corner.centre_m[k], 0.25, 1e-15);
    EXPECT_NEAR(corner.inertia_m2[k][k], 2 * (0.1 - 1.0 / 16), 1e-15);
    EXPECT_NEAR(corner.inertia_m2[k][(k + 1) % 3], -(1.0 / 20 - 1.0 / 16), 1e-15);
  }
}

/// A mesh of a turned box recovers its principal axes, and its mass does not change.
TEST(Mesh, OwnAxesArePrincipal) {
  sim::Triangles turned = triangles(box_text({0, 0, 0}, {3, 2, 1}));
  for (Vector& at : turned.places) {
    at = {0.8 * at[0] - 0.6 * at[1], 0.6 * at[0] + 0.8 * at[1], at[2]};
    at = {at[0], 0.96 * at[1] - 0.28 * at[2], 0.28 * at[1] + 0.96 * at[2]};
  }
  const sim::Mesh mesh(turned, 0);
  Vector sides{};
  for (std::size_t k = 0; k < 3; ++k) {
    sides[k] = mesh.high_m()[k] - mesh.low_m()[k];
    EXPECT_NEAR(mesh.high_m()[k], -mesh.low_m()[k], 1e-9);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = sides[(k + 1) % 3], b = sides[(k + 2) % 3];
    EXPECT_NEAR(mesh.inertia_m2()[k], (a * a + b * b) / 12, 1e-9);
  }
  std::sort(sides.begin(), sides.end());
  EXPECT_NEAR(sides[0], 1, 1e-8);
  EXPECT_NEAR(sides[2], 3, 1e-8);
  // Turned back, the first corner lies at its place in the text.
  const auto [x, y, z, w] = mesh.turn();
  EXPECT_NEAR(x * x + y * y + z * z + w * w, 1, 1e-12);
  const Vector u{x, y, z}, own = mesh.places_m()[7];
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Vector t = cross(u, own), tt = cross(u, t);
  const Vector centre = sim::mass_properties(turned).centre_m;
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(own[k] + 2 * w * t[k] + 2 * tt[k] + centre[k], turned.places[7][k], 1e-9);
  EXPECT_EQ(sim::Mesh(triangles(box_text({0, 0, 0}, {3, 2, 1})), 0).turn(),
            (std::array<double, 4>{0, 0, 0, 1}));
}

TEST(Mesh, KnowsTheAxesAboutWhichItIsRound) {
  const auto round = [](sim::Triangles mesh, double stretch) {
    for (Vector& at : mesh.places) at[1] *= stretch;
    return sim::Mesh(mesh, 0).round_about();
  };
  using Axes = std::array<bool, 3>;
  EXPECT_EQ(round(triangles(ball_text(0.5, 12)), 1), (Axes{true, true, true}));
  EXPECT_EQ(round(triangles(ball_text(0.5, 12)), 2), (Axes{false, true, false}));
  EXPECT_EQ(round(triangles(ball_text(0.5, 6)), 2), (Axes{false, false, false})) << "twelve sides";
  EXPECT_EQ(round(triangles(box_text({0, 0, 0}, {1, 1, 1})), 1), (Axes{false, false, false}));
}

TEST(Mesh, DistancesAreThoseOfTheShape) {
  const sim::Mesh box(triangles(box_text({-0.5, -0.3, -0.2}, {0.5, 0.3, 0.2})), 0);
  const sim::Mesh ball(triangles(ball_text(0.5)), 0);
  for (int k = 0; k < 4000; ++k) {
    const auto at = [&](int n) { return 1.6 * std::fmod(0.5 + 0.6180339887 * k * n + 0.01 * n, 1.0) - 0.8; };
    const Vector p{at(1), at(3), at(7)};
    EXPECT_NEAR(box.distance_m(p), box_distance({0.5, 0.3, 0.2}, p), 1e-9);
    const double from_middle = std::hypot(p[0], p[1], p[2]);
    EXPECT_NEAR(ball.distance_m(p), from_middle - 0.5, 0.002) << "facets lie below the sphere";
  }
  // Beyond edges and corners the sign must not come from the first face: the apex of a sharp wedge.
  const sim::Mesh wedge(triangles("v 0 0 0\nv 1 0.02 0\nv 1 -0.02 0\nv 0 0 1\nv 1 0.02 1\nv 1 -0.02 1\n"
                                  "f 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 1 3 6 4\nf 2 5 6 3\n"),
                        0.01);
  const double apex = wedge.low_m()[0];
  for (const double y : {-0.1, -0.01, 0.0, 0.01, 0.1})
    EXPECT_NEAR(wedge.distance_m({apex - 0.1, y, 0}), std::hypot(0.1, y), 1e-9);
}

/// Threads compute nodes independently: each node holds the exact distance up to the rounding of a float. If
/// the compiler fuses products and sums, this file may round a node's place differently than the mesh did.
TEST(Mesh, TheGridHoldsTheDistancesOfItsNodes) {
  const sim::Mesh ball(triangles(ball_text(0.5, 12)), 0.1);
  const sim::DistanceGrid& grid = ball.grid();
  ASSERT_EQ(static_cast<double>(grid.values_m.size()), ball.grid_nodes());
  std::size_t k = 0;
  for (int z = 0; z < grid.nodes[2]; ++z) {
    for (int y = 0; y < grid.nodes[1]; ++y) {
      for (int x = 0; x < grid.nodes[0]; ++x, ++k) {
        const Vector at{grid.low_m[0] + grid.step_m * x, grid.low_m[1] + grid.step_m * y,
                        grid.low_m[2] + grid.step_m * z};
        ASSERT_NEAR(static_cast<double>(grid.values_m[k]), ball.distance_m(at), 1e-7);
      }
    }
  }
  for (std::size_t a = 0; a < 3; ++a) EXPECT_LT(grid.low_m[a], ball.low_m()[a] - 1.9 * grid.step_m);
  EXPECT_NEAR(ball.thickness_m(), 1, 0.1);
  EXPECT_LT(ball.contacts_m().size(), 71u);
  EXPECT_EQ(sim::Mesh(triangles(box_text({0, 0, 0}, {3, 2, 1})), 0).contacts_m().size(), 8u) << "corners";
}

}  // namespace
