/// Obstacles that are meshes must look like the shapes that they copy, in both eyes.
#include "libsim/scene/mesh.hpp"

#include <cstdlib>
#include <memory>

#include "tests/libsim/mesh_shapes.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

class MeshObstaclesGl : public render_test::RenderGl {
 protected:
  /// A ball and a turned box that swings, with their shadows.
  static sim::Scene scene_of(bool meshes) {
    sim::Scene scene = room();
    scene.picture_effects = {{sim::PictureEffectKind::Shadows, 1}};
    sim::Obstacle ball, box;
    ball.radius_m = 0.8;
    ball.start.centre_m = {2.5, 1.5, 5};
    box.shape = sim::ObstacleShape::Box;
    box.size_m = {1.6, 1.2, 1};
    box.start = {{5.5, 1.2, 4}, {0.2705980501, 0.2705980501, 0.2705980501, 0.8833883476}};
    box.motion = sim::ObstacleMotion::Swings;
    box.way_m = {0.5, 0, 0};
    box.period_s = 1;
    if (meshes) {
      for (sim::Obstacle* o : {&ball, &box}) o->shape = sim::ObstacleShape::Mesh;
      ball.mesh = std::make_shared<const sim::Mesh>(mesh_test::triangles(mesh_test::ball_text(0.8)), 0);
      box.mesh = std::make_shared<const sim::Mesh>(
          mesh_test::triangles(mesh_test::box_text({-0.8, -0.6, -0.5}, {0.8, 0.6, 0.5})), 0);
      ball.radius_m = 0;
    }
    scene.obstacles = {ball, box};
    return scene;
  }
  static std::vector<sim::RenderParticle> pool() {
    std::vector<sim::RenderParticle> out;
    for (float x = 0.1F; x < 8; x += 0.2F) {
      for (float z = 0.1F; z < 8; z += 0.2F) {
        for (float y = 0.1F; y < 1; y += 0.2F) out.push_back({x, y, z, 0.1F});
      }
    }
    return out;
  }
  static sim::RenderOptions few_floor_cells() {
    sim::RenderOptions out = render_test::open_options();
    out.floor_cells = 128;
    return out;
  }
  /// Two eyes side by side.
  static sim::Image both_eyes(sim::FluidRenderer& renderer,
                              const std::vector<sim::RenderParticle>& particles) {
    renderer.place_obstacles(0.25);
    std::vector<sim::View> views;
    for (int eye = 0; eye < 2; ++eye) {
      sim::Camera camera;
      camera.eye_m = {3.9 + 0.2 * eye, 4, 13};
      camera.target_m = {4, 1, 4};
      camera.vertical_fov_deg = 50;
      views.push_back(sim::make_view(camera, 160, 120));
      views.back().viewport.x = 160 * eye;
    }
    sim::ParticleBuffer buffer;
    buffer.upload(particles);
    const sim::Offscreen target(320, 120);
    renderer.draw(buffer, views, target.framebuffer());
    return target.read();
  }
  /// Share of the pixels of one eye that differ by more than a tenth.
  static double unlike(const sim::Image& a, const sim::Image& b, int eye) {
    int count = 0;
    for (int y = 0; y < a.height; ++y) {
      for (int x = 160 * eye; x < 160 * (eye + 1); ++x) {
        int most = 0;
        for (int k = 0; k < 3; ++k) {
          const auto at = static_cast<std::size_t>(4 * (y * a.width + x) + k);
          most = std::max(most, std::abs(int{a.rgba[at]} - int{b.rgba[at]}));
        }
        count += most > 25;
      }
    }
    return count / (160.0 * a.height);
  }
};

TEST_F(MeshObstaclesGl, LookLikeTheShapesThatTheyCopyToBothEyes) {
  auto empty = scene_of(false);
  empty.obstacles.clear();
  const auto options = few_floor_cells();
  sim::FluidRenderer of_shapes(scene_of(false), options), of_meshes(scene_of(true), options),
      of_nothing(empty, options);
  for (const auto& particles : {std::vector<sim::RenderParticle>{}, pool()}) {
    const auto shapes = both_eyes(of_shapes, particles);
    const auto meshes = both_eyes(of_meshes, particles);
    const auto nothing = both_eyes(of_nothing, particles);
    for (int eye = 0; eye < 2; ++eye) {
      EXPECT_GT(unlike(shapes, nothing, eye), 0.05) << "they are seen at all";
      EXPECT_LT(unlike(shapes, meshes, eye), 0.1 * unlike(shapes, nothing, eye)) << eye;
    }
  }
}

}  // namespace
