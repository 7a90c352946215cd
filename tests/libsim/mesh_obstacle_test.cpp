/// Obstacles that are meshes: their tables, files beside the scene, their hash, and the water.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "libsim/scene/mesh_reader.hpp"
#include "stats/base/error.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

namespace {

using namespace obstacle_test;
using mesh_test::box_text;
using sim::MethodKind;
using testing::AllOf;
using testing::HasSubstr;

std::string mesh_with(const std::string& keys) {
  return dam_with("shape = \"mesh\"\ncentre_m = [2.0, 1.0, 2.0]\n" + keys);
}
const std::string brick = box_text({1, 1, 1}, {1.6, 1.5, 1.4});
std::string inline_brick() { return "obj = '''\n" + brick + "'''\n"; }

TEST(MeshObstacles, AreReadFromAFileOrFromTheText) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder.path() / "brick.obj", brick);
  const auto scene = sim::parse_scene(
      mesh_with("file = \"brick.obj\"\nscale = 2.0\nrotation_axis = [0.0, 1.0, 0.0]\nrotation_deg = 90.0\n"),
      "scene.toml", folder.path());
  const Obstacle& o = scene.obstacles.at(0);
  EXPECT_EQ(o.shape, ObstacleShape::Mesh);
  EXPECT_NEAR(sim::volume_m3(o), 8 * 0.12, 1e-12);
  EXPECT_NEAR(sim::inertia_m2(o)[0], (1.0 + 0.64) / 12, 1e-12);
  EXPECT_NEAR(sim::signed_distance(o, o.start, {2, 1, 2.6 + 0.1}), 0.1, 1e-12) << "its x lies along z";
  EXPECT_TRUE(sim::holds(o, o.start, {2.3, 1.1, 2.1}));
  EXPECT_FALSE(sim::holds(o, o.start, {2.5, 1.1, 2.1}));
  EXPECT_FALSE(sim::holds(o, o.start, {9, 1.1, 2.1}));
  EXPECT_THAT(sim::obstacles_in_words(scene.obstacles), HasSubstr("mesh " + o.mesh->sha256().substr(0, 12)));
  const auto text = sim::parse_scene(mesh_with(inline_brick() + "scale = 2.0\n"), "scene.toml");
  EXPECT_EQ(text.obstacles.at(0).mesh->sha256(), o.mesh->sha256());
}

TEST(MeshObstacles, ErrorsNameThePlaceAndTheMend) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder.path() / "open.obj", brick.substr(0, brick.rfind("f ")));
  const auto error = [&](const std::string& keys) {
    try {
      sim::parse_scene(mesh_with(keys), "scene.toml", folder.path());
    } catch (const base::Error& problem) {
      return std::string(problem.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(error(inline_brick()), "no error");
  EXPECT_THAT(error(""), AllOf(HasSubstr("scene.toml:"), HasSubstr("is a mesh without a file")));
  EXPECT_THAT(error("file = \"none.obj\"\n"), AllOf(HasSubstr("scene.toml:"), HasSubstr("does not exist")));
  EXPECT_THAT(error("file = \"\"\n"), HasSubstr("is not the name of a file"));
  EXPECT_THAT(error("file = \"open.obj\"\n" + inline_brick()), HasSubstr("is given together with obj"));
  EXPECT_THAT(error("file = \"open.obj\"\n"), AllOf(HasSubstr("open.obj:"), HasSubstr("the edge from vertex"),
                                                    HasSubstr("close the surface")));
  EXPECT_THAT(error("obj = '''\nv 0 0\n'''\n"), AllOf(HasSubstr("scene.toml:"), HasSubstr("in its line 1 ")));
  EXPECT_THAT(error(inline_brick() + "scale = 0.0\n"), HasSubstr("scale"));
  EXPECT_THAT(error(inline_brick() + "scale = 1e-5\n"), HasSubstr("m long on one side"));
  EXPECT_THAT(error(inline_brick() + "scale = 20.0\n"), HasSubstr("outside the tank"));
  EXPECT_THAT(error(inline_brick() + "spacing_m = 1.0\n"), HasSubstr("half of the mesh's shortest side"));
  EXPECT_THAT(error(inline_brick() + "spacing_m = 1e-3\n"), HasSubstr("at most 2097152"));
  EXPECT_THAT(error(inline_brick() + "radius_m = 1.0\n"), HasSubstr("radius_m"));
  EXPECT_THAT(fluid_test::scene_error(mesh_with("file = \"open.obj\"\n")),
              HasSubstr("comes without a folder"));
}

/// The scene's hash includes the file's content, and scene_text needs no other file.
TEST(MeshObstacles, IdentifyTheSceneByTheirContent) {
  const test::TemporaryFolder folder;
  const auto scene_file = folder.path() / "scene.toml", mesh_file = folder.path() / "brick.obj";
  base::write_file_atomically(scene_file, mesh_with("  file = 'brick.obj'  # beside\n"));
  base::write_file_atomically(mesh_file, "# of no meaning\n" + brick);
  const auto scene = sim::read_scene(scene_file);
  const std::string alone = sim::scene_text(scene_file);
  const auto again = sim::parse_scene(alone, "alone");
  EXPECT_EQ(again.sha256, scene.sha256);
  EXPECT_EQ(again.obstacles.at(0).mesh->sha256(), scene.obstacles.at(0).mesh->sha256());
  base::write_file_atomically(mesh_file, brick);
  EXPECT_EQ(sim::read_scene(scene_file).sha256, scene.sha256) << "comments shape nothing";
  base::write_file_atomically(mesh_file, box_text({1, 1, 1}, {1.6, 1.5, 1.5}));
  EXPECT_NE(sim::read_scene(scene_file).sha256, scene.sha256);
  EXPECT_THAT(alone, HasSubstr("obj = '''\nv 1 1 1\n"));
  // If the scene names no mesh file, scene_text() returns the scene file's text unchanged.
  base::write_file_atomically(scene_file, mesh_with(inline_brick()));
  EXPECT_EQ(sim::scene_text(scene_file), mesh_with(inline_brick()));
  const std::string one_line =
      "obstacle = [{shape = \"mesh\", centre_m = [2.0, 1.0, 2.0], file = \"brick.obj\"}]\n";
  std::string dam = mesh_with("");
  base::write_file_atomically(scene_file, one_line + dam.substr(0, dam.find("[[obstacle]]")));
  try {
    sim::read_scene(scene_file);
    ADD_FAILURE() << "no error";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("scene.toml"), HasSubstr("on a line of its own")));
  }
}

std::string text_error(const std::filesystem::path& scene_file) {
  try {
    sim::scene_text(scene_file);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

/// Only the `file` of an obstacle is replaced, whatever text surrounds it, and none is missed.
TEST(MeshObstacles, OnlyTheFileOfAnObstacleIsReplaced) {
  const test::TemporaryFolder folder;
  const auto scene_file = folder.path() / "scene.toml";
  base::write_file_atomically(folder.path() / "brick.obj", brick);
  const auto text = [&](const std::string& keys) {
    base::write_file_atomically(scene_file, mesh_with(keys));
    return sim::scene_text(scene_file);
  };
  const std::string obj = "obj = '''\n" + sim::obj_of(mesh_test::triangles(brick)) + "'''\n";
  const std::string names = "file = \"brick.obj\"", blanks(300'000, ' ');
  EXPECT_EQ(text(names + " #" + blanks + "file\n"), mesh_with(obj));
  EXPECT_EQ(text(blanks + "\n\t" + names + blanks + "\r\n"), mesh_with(blanks + "\n" + obj));
  EXPECT_EQ(text("  file='brick.obj'"), mesh_with(obj));
  // In a multi-line string, after text that looks like the begin or end of one.
  const std::string other = "[[obstacle]]\nshape = \"mesh\"\ncentre_m = [1.0, 1.0, 1.0]\n";
  const std::string three = "'''", doubled = "\"\"\"";
  for (const auto& [quotes, others] : {std::pair{three, doubled}, std::pair{doubled, three}}) {
    const std::string within = "# ''' \"\"\"\nobj = " + quotes + "\n# \\\" '' # " + others + "\n" + names +
                               "\n" + brick + quotes + " # ''' \"\"\"\n" + other;
    EXPECT_EQ(text(within + inline_brick()), mesh_with(within + inline_brick()));
    EXPECT_EQ(text(within + names + "\n"), mesh_with(within + obj)) << quotes;
  }
  const std::string four = "obj = '''\n" + brick + "# '''' # ''''\n" + other;
  EXPECT_EQ(text(four + names + "\n"), mesh_with(four + obj)) << "a quote before those that close";
  for (const std::string keys : {"\"f\\u0069le\" = \"brick.obj\"\n", "\"file\" = \"brick.obj\"\n",
                                 "file = \"br\\u0069ck.obj\"\n", "file = '''brick.obj'''\n"}) {
    base::write_file_atomically(scene_file, mesh_with(keys));
    EXPECT_THAT(text_error(scene_file), AllOf(HasSubstr("scene.toml"), HasSubstr("in another notation"),
                                              HasSubstr("on a line of its own, without escapes")))
        << keys;
    EXPECT_THROW(sim::read_scene(scene_file), base::Error) << keys;
  }
}

TEST(MeshObstacles, TooManyTrianglesForTheTextAreAnErrorOfTheirFile) {
  const test::TemporaryFolder folder;
  const auto scene_file = folder.path() / "scene.toml";
  base::write_file_atomically(scene_file, mesh_with("file = \"ball.obj\"\n"));
  base::write_file_atomically(folder.path() / "ball.obj", mesh_test::ball_text(0.25, 90));
  EXPECT_THAT(text_error(scene_file), AllOf(HasSubstr("ball.obj"), HasSubstr("bytes with its triangles"),
                                            HasSubstr("use fewer triangles: a scene has at most 1048576")));
  base::write_file_atomically(folder.path() / "ball.obj", mesh_test::ball_text(0.25, 40));
  EXPECT_EQ(text_error(scene_file), "no error");
}

/// A mesh whose text holds a box turned by 30 degrees about x, turned by the scene by 50 about y, and a box
/// with both rotations: their order matters.
TEST(MeshObstacles, AttitudesAreThoseOfTheFileThenOfTheScene) {
  auto turned_text = mesh_test::triangles(brick);
  const double x_turn = std::numbers::pi / 6, y_turn = std::numbers::pi / 3.6;
  for (auto& at : turned_text.places)
    at = {at[0], std::cos(x_turn) * at[1] - std::sin(x_turn) * at[2],
          std::sin(x_turn) * at[1] + std::cos(x_turn) * at[2]};
  const std::string turns =
      "motion = \"turns\"\nabout_m = [2.0, 1.0, 1.5]\naxis = [0.0, 0.6, 0.8]\nrate_rad_s = 0.5\n";
  const auto scene =
      sim::parse_scene(mesh_with("obj = '''\n" + sim::obj_of(turned_text) +
                                 "'''\nrotation_axis = [0.0, 1.0, 0.0]\nrotation_deg = 50.0\n" + turns),
                       "scene.toml");
  const Obstacle& mesh = scene.obstacles.at(0);
  Obstacle box = mesh;
  box.shape = ObstacleShape::Box;
  box.mesh.reset();
  box.size_m = {0.6, 0.5, 0.4};
  const double sx = std::sin(x_turn / 2), cx = std::cos(x_turn / 2);
  const double sy = std::sin(y_turn / 2), cy = std::cos(y_turn / 2);
  box.start.turn = {cy * sx, sy * cx, -sy * sx, cy * cx};
  for (const double time : {0.0, 0.7, 3.0}) {
    const sim::Pose of_mesh = sim::pose_at(mesh, time), of_box = sim::pose_at(box, time);
    for (int k = 0; k < 500; ++k) {
      const auto at = [&](std::size_t axis, double n) {
        return of_box.centre_m[axis] + std::fmod(0.6180339887 * k * n, 1.0) - 0.5;
      };
      const sim::Vec3d p{at(0, 1), at(1, 3), at(2, 7)};
      ASSERT_NEAR(sim::signed_distance(mesh, of_mesh, p), sim::signed_distance(box, of_box, p), 1e-6) << time;
    }
  }
}

/// A pool with a cube, as a box or as a mesh.
sim::Scene pool(bool as_mesh, ObstacleMotion motion = ObstacleMotion::Fixed) {
  auto scene = fluid_test::tank({1, 1.5, 1}, {1, 0.75, 1}, 20);
  scene.v_ref_m_s = 2;
  const sim::Vec3d at{0.5, 0.45, 0.5};
  Obstacle cube =
      as_mesh ? mesh(at, box_text({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2})) : box(at, {0.4, 0.4, 0.4});
  cube.motion = motion;
  cube.way_m = {0.1, 0, 0};
  cube.period_s = 1;
  cube.density_kg_m3 = 500;
  scene.obstacles = {cube};
  return scene;
}

TEST(MeshObstacles, WaterInsideIsLeftOutAndStaysOut) {
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) {
    auto scene = pool(true, ObstacleMotion::Swings);
    Obstacle& ball = scene.obstacles[0];
    ball.mesh = mesh_of(mesh_test::ball_text(0.25, 24));
    const auto fluid = sim::make_simulation(scene, options_of(method));
    EXPECT_NEAR(static_cast<double>(fluid->report().mass_units) / 1024, 1 - sim::volume_m3(ball) / 0.75,
                0.02);
    for (int frame = 0; frame < 60; ++frame) fluid->step_frame();
    const sim::Pose now = sim::pose_at(ball, fluid->time_s());
    int in_its_box = 0;
    for (const auto& p : fluid->read_state()) {
      const sim::Vec3d at{static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
      EXPECT_GT(sim::signed_distance(ball, now, at), -0.03 * fluid->spacing_m()) << p.id;
      double out = 0;
      for (std::size_t k = 0; k < 3; ++k) out = std::max(out, std::abs(at[k] - now.centre_m[k]));
      in_its_box += out < 0.24;
    }
    EXPECT_GT(in_its_box, 5) << "the water knows the ball from the box round it";
    EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  }
}

/// Means over the run's second second.
struct Afloat {
  double height_m = 0, push_n = 0;
};
Afloat afloat(bool as_mesh, ObstacleMotion motion) {
  auto options = options_of();
  options.wall_impulse = true;
  const auto fluid = sim::make_simulation(pool(as_mesh, motion), options);
  Afloat out;
  constexpr int frames = 60;
  for (int frame = 0; frame < 2 * frames; ++frame) {
    fluid->step_frame();
    if (frame < frames) continue;
    out.height_m += fluid->read_obstacles().at(0).pose.centre_m[1] / frames;
    out.push_n -= 60 * fluid->momentum().obstacles.at(0).push[1] / frames;
  }
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  return out;
}

TEST(MeshObstacles, ACubeOfTrianglesIsABox) {
  const Afloat box = afloat(false, ObstacleMotion::Free), mesh = afloat(true, ObstacleMotion::Free);
  // Measured: box 0.68 m, mesh 0.64 m, Archimedes 0.72 m, at a spacing of 0.09 m.
  EXPECT_NEAR(mesh.height_m, box.height_m, 0.5 * 0.09);
  EXPECT_NEAR(mesh.push_n, 9.81 * 500 * 0.064, 0.03 * 9.81 * 500 * 0.064) << "it bears its weight";
  // Measured: 479 N and 549 N, because a mesh keeps the water farther from its edges. Archimedes: 628 N.
  const Afloat held = afloat(false, ObstacleMotion::Fixed), mesh_held = afloat(true, ObstacleMotion::Fixed);
  EXPECT_NEAR(mesh_held.push_n, held.push_n, 0.12 * 9810 * 0.064);
}

std::vector<sim::ParticleState> run(const sim::Scene& scene, const sim::SimulationOptions& options,
                                    int frames) {
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
  return fluid->read_state();
}
bool same_bits(const std::vector<sim::ParticleState>& a, const std::vector<sim::ParticleState>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(MeshObstacles, NothingTurnsABallOfTriangles) {
  for (const bool ball : {true, false}) {
    auto scene = pool(true, ObstacleMotion::Free);
    if (ball) scene.obstacles[0].mesh = mesh_of(mesh_test::ball_text(0.25, 24));
    const auto fluid = sim::make_simulation(scene, options_of());
    for (int frame = 0; frame < 30; ++frame) fluid->step_frame();
    const auto spin = fluid->read_obstacles().at(0).spin_rad_s;
    const double rate = std::hypot(spin[0], spin[1], spin[2]);
    EXPECT_EQ(rate == 0, ball) << rate << " rad/s; a cube may turn";
  }
}

TEST(MeshObstacles, ThreadsChangeNoBit) {
  const int usual = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = run(pool(true, ObstacleMotion::Free), options_of(MethodKind::Ours), 20);
  omp_set_num_threads(3);
  const auto three = run(pool(true, ObstacleMotion::Free), options_of(MethodKind::Ours), 20);
  omp_set_num_threads(usual);
  EXPECT_TRUE(same_bits(one, three));
}

TEST(MeshObstacles, ASavedRunGoesOnBitForBit) {
  const test::TemporaryFolder folder;
  const auto scene = pool(true, ObstacleMotion::Free);
  auto options = options_of();
  const auto whole = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 10; ++frame) whole->step_frame();
  whole->save_state(folder.path() / "state");
  for (int frame = 0; frame < 10; ++frame) whole->step_frame();
  options.resume_from = folder.path() / "state";
  EXPECT_TRUE(same_bits(run(scene, options, 10), whole->read_state()));
  auto other = scene;
  other.obstacles[0].mesh = mesh_of(box_text({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.21}));
  EXPECT_THROW(sim::make_simulation(other, options), base::Error) << "a state of another mesh";
}

TEST(MeshObstacles, ThinOnesAreRefused) {
  auto scene = pool(true);
  scene.obstacles[0].mesh = mesh_of(box_text({-0.2, -0.2, -0.02}, {0.2, 0.2, 0.02}));
  EXPECT_THROW(sim::make_simulation(scene, options_of()), base::Error);
}

}  // namespace
