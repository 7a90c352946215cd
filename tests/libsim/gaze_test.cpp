#include "libsim/scene/gaze.hpp"

#include <gtest/gtest.h>

namespace {

TEST(GazePoint, HoldsBetweenKeysAndJumpsInTwoFrames) {
  sim::Scene scene;
  scene.gaze = {{0, {1, 2, 3}}, {60, {5, 2, 3}}, {61, {5, 4, 3}}};
  EXPECT_EQ(sim::gaze_point(scene, 0), (sim::Vec3d{1, 2, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 59), (sim::Vec3d{1, 2, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 60), (sim::Vec3d{1, 2, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 62), (sim::Vec3d{5, 3, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 63), (sim::Vec3d{5, 4, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 1000), (sim::Vec3d{5, 4, 3}));
}

TEST(GazePoint, StartsAtTheFirstKeyAndFallsBackToTheViewsTarget) {
  sim::Scene scene;
  scene.view.target_m = {7, 8, 9};
  EXPECT_EQ(sim::gaze_point(scene, 5), (sim::Vec3d{7, 8, 9}));
  scene.gaze = {{10, {1, 2, 3}}};
  EXPECT_EQ(sim::gaze_point(scene, 5), (sim::Vec3d{1, 2, 3}));
  EXPECT_EQ(sim::gaze_point(scene, 10), (sim::Vec3d{1, 2, 3}));
}

}  // namespace
