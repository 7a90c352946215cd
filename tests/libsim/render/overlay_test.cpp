#include <limits>

#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::view_along_z;

class OverlayGl : public render_test::RenderGl {
 protected:
  /// Two spheres side by side, painted; the colours at their centres and of the empty corner before and
  /// after.
  struct Painted {
    std::array<int, 3> left, right, corner_before, corner;
  };
  Painted paint(std::vector<float> values, sim::Overlay overlay) {
    sim::FluidRenderer renderer(room(), render_test::open_options());
    sim::ParticleBuffer buffer;
    buffer.upload(std::vector<sim::RenderParticle>{{-1, 0, -4, 0.5F}, {1, 0, -4, 0.5F}});
    const auto view = view_along_z(160, 120);
    const sim::Offscreen target(160, 120);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    Painted out;
    out.corner_before = colour(target.read(), 3, 3);
    overlay.values = values;
    renderer.paint(overlay, target.framebuffer());
    const auto painted = target.read();
    const auto rays = sim::pixel_rays(view);
    const int offset = static_cast<int>(0.25 / rays.scale_x);
    out.left = colour(painted, 80 - offset, 60);
    out.right = colour(painted, 80 + offset, 60);
    out.corner = colour(painted, 3, 3);
    return out;
  }
  static std::array<int, 3> colour(const sim::Image& of, int x, int y) {
    const auto at = 4 * static_cast<std::size_t>((of.height - 1 - y) * of.width + x);
    return {of.rgba[at], of.rgba[at + 1], of.rgba[at + 2]};
  }
};

TEST_F(OverlayGl, PaintsTheFrontParticlesValueAndNothingElse) {
  const auto low_high = paint({0, 10}, {{}, 0, 10, false});
  EXPECT_GT(low_high.left[2], low_high.left[1]) << "low values are blue";
  EXPECT_GT(low_high.right[0], low_high.right[2] + 60) << "high values are yellow";
  EXPECT_EQ(low_high.corner, low_high.corner_before);
  const auto swapped = paint({10, 0}, {{}, 0, 10, false});
  EXPECT_GT(swapped.left[0], swapped.left[2] + 60);
}

TEST_F(OverlayGl, ClassesHaveTheirOwnColoursAndNaNStandsOut) {
  const auto levels = paint({0, 3}, {{}, 0, 1, true});
  EXPECT_NE(levels.left, levels.right);
  const auto broken = paint({std::numeric_limits<float>::quiet_NaN(), 0.5F}, {{}, 0, 1, false});
  EXPECT_GT(std::min(broken.left[0], broken.left[2]), broken.left[1] + 80);
}

TEST_F(OverlayGl, OutlinesAreSmooth) {
  // Two spheres before a wall, of one class and of two values on the scale: no step from pixel to pixel is
  // that of an unpainted edge.
  sim::FluidRenderer renderer(room(), render_test::open_options());
  sim::ParticleBuffer buffer;
  buffer.upload(std::vector<sim::RenderParticle>{{-0.3F, 0, -4, 0.5F}, {0.3F, 0, -4, 0.5F}});
  const auto view = view_along_z(160, 120);
  const sim::Offscreen target(160, 120);
  renderer.draw(buffer, {&view, 1}, target.framebuffer());
  const auto bare = target.read();
  for (const bool classes : {true, false}) {
    const std::vector<float> values{0, classes ? 0.0F : 1.0F};
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    renderer.paint({values, 0, 1, classes}, target.framebuffer());
    const auto painted = target.read();
    int largest = 0, whole = 0;
    for (int x = 1; x < 160; ++x) {
      const auto here = colour(painted, x, 60), before = colour(painted, x - 1, 60);
      const auto wall = colour(bare, x, 60), wall_before = colour(bare, x - 1, 60);
      for (std::size_t c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs((here[c] - wall[c]) - (before[c] - wall_before[c])));
        whole = std::max(whole, std::abs(here[c] - wall[c]));
      }
    }
    EXPECT_GT(whole, 60);
    EXPECT_LT(largest, 0.75 * whole) << (classes ? "classes" : "scale");
  }
}

TEST_F(OverlayGl, RefusesAnEmptyRangeAndAMissingPicture) {
  EXPECT_THROW(paint({0, 1}, {{}, 1, 1, false}), base::Error);
  sim::FluidRenderer renderer(room(), render_test::open_options());
  const std::vector<float> values{1};
  EXPECT_THROW(renderer.paint({values, 0, 1, false}, 0), base::Error);
}

TEST_F(OverlayGl, FewerValuesThanParticlesLeaveTheRestUnpainted) {
  const auto one = paint({10}, {{}, 0, 10, false});
  EXPECT_GT(one.left[0], one.left[2] + 60);
  EXPECT_LT(one.right[0], one.left[0]);
}

}  // namespace
