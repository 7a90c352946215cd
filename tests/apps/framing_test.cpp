/// The part of a scene that a picture shows, and its visual angle.
#include "libstudy/stimulus/framing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

sim::Scene shipped(const char* name) {
  return sim::read_scene(base::resource(std::string("data/scenes/") + name + ".toml"));
}

study::Viewing seen_at(double angle_deg, bool true_angle) {
  study::Viewing viewing;
  viewing.visual_angle_deg = [=](int, int) { return angle_deg; };
  viewing.true_angle = true_angle;
  return viewing;
}

TEST(Framing, TheCameraKeepsTheScenesAngleUnlessTheTrueOneIsAsked) {
  sim::Camera camera;
  camera.vertical_fov_deg = 75;
  const study::Framing unknown = study::frame_picture(camera, {}, 160, 90);
  EXPECT_EQ(unknown.camera_deg, 75);
  EXPECT_FALSE(unknown.visual_deg);
  EXPECT_FALSE(unknown.ratio());
  EXPECT_EQ(unknown.visual_scale(), 1);

  const study::Framing known = study::frame_picture(camera, seen_at(27, false), 160, 90);
  EXPECT_EQ(known.camera_deg, 75);
  EXPECT_EQ(known.visual_deg, 27);
  EXPECT_DOUBLE_EQ(*known.ratio(), 27.0 / 75);
  const double half_degree = std::acos(-1.0) / 360;
  EXPECT_NEAR(known.visual_scale(), std::tan(27 * half_degree) / std::tan(75 * half_degree), 1e-12);

  const study::Framing asked = study::frame_picture(camera, seen_at(27, true), 160, 90);
  EXPECT_EQ(asked.camera_deg, 27);
  EXPECT_EQ(*asked.ratio(), 1);
  EXPECT_EQ(asked.visual_scale(), 1);
}

TEST(Framing, PointsLieWhereTheCameraDrawsThem) {
  sim::Camera camera;
  camera.eye_m = {0, 0, 0};
  camera.target_m = {0, 0, -1};
  camera.vertical_fov_deg = 90;
  const sim::View view = sim::make_view(camera, 200, 100);
  const auto place = study::place_in(view, {1, 0.5, -2});
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->first, 125, 1e-4);
  EXPECT_NEAR(place->second, 62.5, 1e-4);
  EXPECT_FALSE(study::place_in(view, {0, 0, 1})) << "behind the eye";
}

TEST(Framing, APictureKeepsItsShapeInTheMiddle) {
  const study::Rectangle to = study::fit_picture(1280, 720, 1000, 1000);
  EXPECT_EQ(to.x0, 0);
  EXPECT_EQ(to.x1, 1000);
  EXPECT_EQ(to.y1 - to.y0, 563);
  EXPECT_EQ(to.y0, 218);
}

/// Small balls over the surface of a box.
std::vector<sim::RenderParticle> particles_on(const sim::VisibleBox& box) {
  constexpr int steps = 24;
  std::vector<sim::RenderParticle> out;
  const auto at = [&](std::size_t k, int i) {
    return static_cast<float>(box.min_m[k] + (box.max_m[k] - box.min_m[k]) * i / steps);
  };
  for (int x = 0; x <= steps; ++x) {
    for (int y = 0; y <= steps; ++y) {
      for (int z = 0; z <= steps; ++z) {
        const bool on_surface = x % steps == 0 || y % steps == 0 || z % steps == 0;
        if (on_surface) out.push_back({at(0, x), at(1, y), at(2, z), 0.05f});
      }
    }
  }
  return out;
}

class FramingGl : public ::testing::Test {
 protected:
  struct Seen {
    bool any = false, edge = false;  ///< whether pixels show fluid, and whether some at the edge do
  };
  /// Draws the boxes that must be visible, as balls on their surfaces.
  Seen draw(const sim::Scene& scene, const sim::View& view) {
    sim::RenderOptions options;
    options.clip_to_tank = false;
    sim::FluidRenderer renderer(scene, options);
    const int width = view.viewport.width, height = view.viewport.height;
    const sim::Offscreen target(width, height);
    sim::ParticleBuffer buffer;
    Seen seen;
    for (const auto& box : scene.visible) {
      buffer.upload(particles_on(box));
      renderer.draw(buffer, {&view, 1}, target.framebuffer());
      const auto depth = renderer.read_depth();
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (!std::isfinite(depth[static_cast<std::size_t>(y * width + x)])) continue;
          seen.any = true;
          seen.edge |= x == 0 || y == 0 || x == width - 1 || y == height - 1;
        }
      }
    }
    return seen;
  }

  sim::GlContext context = sim::GlContext::make_headless();
};

struct Shape {
  int width, height;
};
constexpr Shape wide{320, 180}, old{240, 180}, ultra_wide{420, 180};

TEST_F(FramingGl, WhatMustStayVisibleIsDrawnWholeAtEveryShapeOfScreen) {
  for (const char* name : {"faucet", "jet_impact", "single_dam"}) {
    const sim::Scene scene = shipped(name);
    ASSERT_FALSE(scene.visible.empty()) << name;
    for (const Shape& shape : {wide, old, ultra_wide}) {
      const sim::View view = study::framed_view(scene.view, seen_at(27, false), shape.width, shape.height);
      const Seen seen = draw(scene, view);
      EXPECT_TRUE(seen.any) << name;
      EXPECT_FALSE(seen.edge) << name << " " << shape.width;
      EXPECT_THAT(study::cut_off(scene, view), IsEmpty()) << name << " " << shape.width;
    }
  }
}

/// 27.4 degrees is the vertical angle of a 16:9 picture 520 mm wide, seen from 600 mm. A camera with this
/// angle cuts off parts of the scenes, and cut_off() must name them.
TEST_F(FramingGl, ATrueAngleThatCutsItIsToldAsItIsDrawn) {
  for (const char* name : {"faucet", "jet_impact", "single_dam"}) {
    const sim::Scene scene = shipped(name);
    const sim::View view = study::framed_view(scene.view, seen_at(27.4, true), wide.width, wide.height);
    const Seen seen = draw(scene, view);
    EXPECT_TRUE(!seen.any || seen.edge) << name;
    EXPECT_THAT(study::cut_off(scene, view), ElementsAre(scene.visible.front().name)) << name;
  }
}

/// A camera 2 m up that looks down along -x, like that of a scene.
sim::Camera tilted() {
  sim::Camera camera;
  camera.eye_m = {3, 2, 1};
  camera.target_m = {0, 1, 1};
  return camera;
}

/// An eye `right_m` to the right of the anchor. Its picture has 200 x 100 px, and its frustum reaches further
/// left and down.
study::EyeView eye_at(double right_m) {
  study::EyeView eye;
  eye.position_m = {right_m, 0, 0};
  eye.left_rad = -std::atan(1.2), eye.right_rad = std::atan(0.8);
  eye.up_rad = std::atan(0.4), eye.down_rad = std::atan(-0.6);
  eye.x_px = 200, eye.width_px = 200, eye.height_px = 100;
  return eye;
}

TEST(EyeView, StandsAtTheScenesCameraWithItsHeadingAndALevelHorizon) {
  const sim::View view = study::eye_view(tilted(), eye_at(0));
  // A ray of slope s to the right and t up is at (s + 1.2) / 2 of the width and (t + 0.6) / 1 of the height.
  const auto ahead = study::place_in(view, {-7, 2, 1});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->first, 120, 1e-3);
  EXPECT_NEAR(ahead->second, 60, 1e-3);
  const auto aside = study::place_in(view, {-1, 2.8, -1});  // 4 m ahead, 2 m to the right, 0.8 m up
  ASSERT_TRUE(aside);
  EXPECT_NEAR(aside->first, 170, 1e-3);
  EXPECT_NEAR(aside->second, 80, 1e-3);
  EXPECT_EQ(view.viewport.x, 200);
}

TEST(EyeView, TwoEyesSeeATargetApartByItsDistance) {
  for (const double distance_m : {0.5, 1.0, 2.0}) {
    const sim::Vec3d target{3 - distance_m, 2, 1};
    const auto left = study::place_in(study::eye_view(tilted(), eye_at(-0.032)), target);
    const auto right = study::place_in(study::eye_view(tilted(), eye_at(0.032)), target);
    ASSERT_TRUE(left && right);
    EXPECT_NEAR(left->first - right->first, 100 * 0.064 / distance_m, 1e-3);
    EXPECT_NEAR(left->second, right->second, 1e-3);
  }
}

TEST(EyeView, TurnsWithTheHead) {
  study::EyeView eye = eye_at(0);
  const double half = std::atan(0.5) / 2;
  eye.orientation = {0, std::sin(half), 0, std::cos(half)};                      // turned to the left
  const auto met = study::place_in(study::eye_view(tilted(), eye), {-1, 2, 3});  // 4 m ahead, 2 m to the left
  ASSERT_TRUE(met);
  EXPECT_NEAR(met->first, 120, 1e-3);
  EXPECT_NEAR(met->second, 60, 1e-3);
}

TEST(EyeView, WithoutAnAreaIsRefused) {
  study::EyeView eye = eye_at(0);
  std::swap(eye.left_rad, eye.right_rad);
  EXPECT_THROW(study::eye_view(tilted(), eye), base::Error);
  eye = eye_at(0);
  eye.up_rad = eye.down_rad;
  EXPECT_THROW(study::eye_view(tilted(), eye), base::Error);
}

}  // namespace
}  // namespace apps
