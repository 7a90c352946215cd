#include "libsim/render/fluid_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"

namespace {

TEST(FluidPictureGl, SaliencySeesTheLastFrameAndTheRecordSaysHow) {
  const auto context = sim::GlContext::make_headless();
  sim::Scene scene;
  scene.tank_size_m = {4.8, 4, 2.4};
  scene.water.front().max_m = {2.4, 2.4, 1.2};
  scene.gate = false;
  scene.settle_frames = 0;
  scene.v_ref_m_s = 4;
  scene.view.eye_m = {2.4, 1.6, 5.2};
  scene.view.target_m = {2.4, 1, 1.2};
  const sim::View view = sim::make_view(scene.view, 64, 48);
  const sim::Offscreen target(64, 48);
  for (const auto method : {sim::MethodKind::Ours, sim::MethodKind::FovFluid, sim::MethodKind::LoRes}) {
    sim::SimulationOptions options;
    options.method = method;
    options.n_star = 64;
    const auto fluid = sim::make_simulation(scene, options);
    sim::FluidPicture picture(scene);
    for (int frame = 0; frame < 3; ++frame) {
      picture.look(*fluid, view, sim::gaze_at(scene.view, {2.4, 1, 1.2}));
      fluid->step_frame();
      picture.draw(*fluid, view, target.framebuffer());
    }
    const std::string seen = sim::in_words(fluid->report().seen);
    // The third step used the picture of the second.
    EXPECT_EQ(seen, method == sim::MethodKind::Ours ? "picture of frame 2 by way of host" : "no picture");
  }
}

/// Mean row of the pixels with the obstacle's colour: at least twice as much red as blue, unlike water and
/// room.
double middle_row(const sim::Image& image) {
  double sum = 0, count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* pixel = &image.rgba[static_cast<std::size_t>(4 * (y * image.width + x))];
      if (pixel[0] < 2 * pixel[2] || pixel[0] < 60) continue;
      sum += y;
      ++count;
    }
  }
  EXPECT_GT(count, 20);
  return sum / count;
}

TEST(FluidPictureGl, ShowsAFreeObstacleWhereItIs) {
  const auto context = sim::GlContext::make_headless();
  sim::Scene scene;
  scene.tank_size_m = {2, 3, 2};
  scene.water.front().max_m = {0.5, 0.25, 0.5};
  scene.settle_frames = 0;
  scene.v_ref_m_s = 4;
  scene.view.eye_m = {1, 1.5, 6};
  scene.view.target_m = {1, 1.5, 1};
  sim::Obstacle ball;
  ball.radius_m = 0.4;
  ball.start.centre_m = {1, 2, 1};
  ball.motion = sim::ObstacleMotion::Free;
  ball.density_kg_m3 = 500;
  scene.obstacles = {ball};
  sim::SimulationOptions options;
  options.n_star = 64;
  const auto fluid = sim::make_simulation(scene, options);
  sim::FluidPicture picture(scene);
  const sim::View view = sim::make_view(scene.view, 64, 96);
  const sim::Offscreen target(64, 96);
  picture.draw(*fluid, view, target.framebuffer());
  const double before = middle_row(target.read());
  for (int frame = 0; frame < 25; ++frame) fluid->step_frame();
  picture.draw(*fluid, view, target.framebuffer());
  const double fallen = middle_row(target.read()) - before;
  const double way = 2 - fluid->read_obstacles().at(0).pose.centre_m[1];
  EXPECT_GT(way, 0.5);
  // Rows go downwards; 96 of them cover the field of view at 5 m.
  const double tall = 2 * 5 * std::tan(0.5 * scene.view.vertical_fov_deg * 3.14159265 / 180);
  EXPECT_NEAR(fallen / 96 * tall, way, 0.1 * way);
}

TEST(Gaze, ThroughAPixelIsTheRayThatTheCameraDraws) {
  sim::Camera camera;
  camera.eye_m = {3, 2, 9};
  camera.target_m = {1, 1, 0};
  const sim::View view = sim::make_view(camera, 320, 200);
  const auto middle = sim::gaze_through(view, 160, 100);
  const auto at_target = sim::gaze_at(camera, camera.target_m);
  const double length = std::sqrt(4.0 + 1 + 81);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(middle.origin_m[k], camera.eye_m[k], 1e-5);
    EXPECT_NEAR(middle.direction[k], at_target.direction[k] / length, 1e-5)
        << "the middle looks at the target";
  }
  // The upper edge is half the field of view above the middle.
  const auto top = sim::gaze_through(view, 160, 200);
  double dot = 0, norm = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    dot += top.direction[k] * middle.direction[k];
    norm += top.direction[k] * top.direction[k];
  }
  EXPECT_NEAR(std::acos(dot / std::sqrt(norm)) * 180 / 3.14159265358979, camera.vertical_fov_deg / 2, 1e-3);
  EXPECT_GT(top.direction[1], middle.direction[1]);
}

}  // namespace
