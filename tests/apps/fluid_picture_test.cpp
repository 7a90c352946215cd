#include "apps/common/fluid_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

TEST(Gaze, ThroughAPixelIsTheRayThatTheCameraDraws) {
  sim::Camera camera;
  camera.eye_m = {3, 2, 9};
  camera.target_m = {1, 1, 0};
  const sim::View view = sim::make_view(camera, 320, 200);
  const auto middle = apps::gaze_through(view, 160, 100);
  const auto at_target = apps::gaze_at(camera, camera.target_m);
  const double length = std::sqrt(4.0 + 1 + 81);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(middle.origin_m[k], camera.eye_m[k], 1e-5);
    EXPECT_NEAR(middle.direction[k], at_target.direction[k] / length, 1e-5)
        << "the middle looks at the target";
  }
  // The upper edge lies half the field of view above the middle.
  const auto top = apps::gaze_through(view, 160, 200);
  double dot = 0, norm = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    dot += top.direction[k] * middle.direction[k];
    norm += top.direction[k] * top.direction[k];
  }
  EXPECT_NEAR(std::acos(dot / std::sqrt(norm)) * 180 / 3.14159265358979, camera.vertical_fov_deg / 2, 1e-3);
  EXPECT_GT(top.direction[1], middle.direction[1]);
}

}  // namespace
