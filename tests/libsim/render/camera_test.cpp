#include "libsim/view/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stats/base/error.hpp"

namespace {

std::array<double, 4> transform(const sim::Mat4& m, const sim::Vec3d& p) {
  std::array<double, 4> out{};
  for (std::size_t row = 0; row < 4; ++row) {
    out[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
  }
  return out;
}

sim::Camera dam_camera() {
  sim::Camera camera;
  camera.eye_m = {12.8, 3.2, 15.3};
  camera.target_m = {12.8, 2.8, 6.4};
  return camera;
}

TEST(Camera, PutsTheTargetOnTheAxis) {
  const auto camera = dam_camera();
  const auto view = sim::look_at(camera.eye_m, camera.target_m);
  const auto eye = transform(view, camera.eye_m), target = transform(view, camera.target_m);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(eye[i], 0, 1e-5);
  EXPECT_NEAR(target[0], 0, 1e-5);
  EXPECT_NEAR(target[1], 0, 1e-5);
  EXPECT_NEAR(target[2], -std::hypot(0.4, 8.9), 1e-5);
  // Up is up in the picture, right is right.
  EXPECT_GT(transform(view, {12.8, 4, 6.4})[1], 0);
  EXPECT_GT(transform(view, {13.8, 2.8, 6.4})[0], 0);
}

TEST(Camera, PixelRaysInvertTheProjection) {
  const auto view = sim::make_view(dam_camera(), 641, 359);
  const auto rays = sim::pixel_rays(view);
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {640.5, 358.5}, {100.5, 300.5}}) {
    // A point on the ray at 7 m depth must project to the ray's pixel.
    const sim::Vec3d eye{7 * (x * rays.scale_x + rays.offset_x), 7 * (y * rays.scale_y + rays.offset_y), -7};
    const auto clip = transform(view.projection, eye);
    EXPECT_NEAR((clip[0] / clip[3] + 1) * 641 / 2, x, 1e-3);
    EXPECT_NEAR((clip[1] / clip[3] + 1) * 359 / 2, y, 1e-3);
  }
  EXPECT_NEAR(std::atan(359 * rays.scale_y + rays.offset_y) * 360 / M_PI, 75, 1e-3);
}

TEST(Camera, RigidInverseUndoes) {
  const auto view = sim::look_at({1, 2, 3}, {-4, 0, 2});
  const auto product = sim::multiply(view, sim::rigid_inverse(view));
  for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(product[i], sim::identity()[i], 1e-6);
}

TEST(Camera, RefusesWhatHasNoPicture) {
  EXPECT_THROW(sim::look_at({1, 1, 1}, {1, 1, 1}), base::Error);
  EXPECT_THROW(sim::look_at({1, 1, 1}, {1, 5, 1}), base::Error);
  EXPECT_THROW(sim::perspective(180, 1, 0.1, 10), base::Error);
  EXPECT_THROW(sim::perspective(60, 1, 0, 10), base::Error);
  EXPECT_THROW(sim::perspective(60, 1, 2, 1), base::Error);
  EXPECT_THROW(sim::make_view(dam_camera(), 0, 10), base::Error);
}

}  // namespace
