#include <epoxy/gl.h>

#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::open_options;
using render_test::view_along_z;
using sim::RenderParticle;

class ShadingGl : public render_test::RenderGl {
 protected:
  sim::Image draw(sim::FluidRenderer& renderer, const std::vector<RenderParticle>& particles,
                  const sim::View& view) {
    sim::ParticleBuffer buffer;
    buffer.upload(particles);
    const sim::Offscreen target(view.viewport.x + view.viewport.width,
                                view.viewport.y + view.viewport.height);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    return target.read();
  }
};

/// Water in the tank of room(), in waves.
std::vector<RenderParticle> pool() {
  std::vector<RenderParticle> out;
  for (float x = 0.1F; x < 8; x += 0.2F) {
    for (float z = 0.1F; z < 8; z += 0.2F) {
      const float height = 1.2F + 0.6F * std::sin(1.3F * x) * std::cos(z);
      for (float y = 0.1F; y < height; y += 0.2F) out.push_back({x, y, z, 0.1F});
    }
  }
  return out;
}

std::vector<RenderParticle> ball(float x, float y, float depth) {
  std::vector<RenderParticle> out;
  for (int k = 0; k < 40; ++k) {
    const float turn = 2.4F * static_cast<float>(k), up = 0.4F - 0.02F * static_cast<float>(k);
    const float wide = std::sqrt(0.16F - up * up);
    out.push_back({x + wide * std::cos(turn), y + up, -depth + wide * std::sin(turn), 0.1F});
  }
  return out;
}

sim::View onto_the_tank(int width, int height) {
  sim::Camera camera;
  camera.eye_m = {13, 6, 14};
  camera.target_m = {4, 1, 4};
  camera.vertical_fov_deg = 50;
  return sim::make_view(camera, width, height);
}

/// The rectangle of a view's picture from pixel (x, y) on.
sim::View part_of(const sim::View& whole, int x, int y, int width, int height) {
  sim::View part = whole;
  const auto rays = sim::pixel_rays(whole);
  part.viewport = {0, 0, width, height};
  part.projection[0] *= static_cast<float>(whole.viewport.width) / static_cast<float>(width);
  part.projection[5] *= static_cast<float>(whole.viewport.height) / static_cast<float>(height);
  part.projection[8] = 1 + part.projection[0] * (rays.offset_x + rays.scale_x * static_cast<float>(x));
  part.projection[9] = 1 + part.projection[5] * (rays.offset_y + rays.scale_y * static_cast<float>(y));
  return part;
}

const std::uint8_t* pixel(const sim::Image& image, int x, int y) {
  return &image.rgba[4 * static_cast<std::size_t>(image.width * (image.height - 1 - y) + x)];
}

/// The largest difference of a channel at each pixel between a part and its place in the whole, `margin` px
/// from its borders.
std::vector<int> differences(const sim::Image& whole, const sim::Image& part, int x0, int y0, int margin) {
  std::vector<int> out;
  for (int y = margin; y < part.height - margin; ++y) {
    for (int x = margin; x < part.width - margin; ++x) {
      const std::uint8_t *a = pixel(whole, x0 + x, y0 + y), *b = pixel(part, x, y);
      int most = 0;
      for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a[k] - b[k]));
      out.push_back(most);
    }
  }
  return out;
}

TEST_F(ShadingGl, TheRoomIsTheSameWhereverTilesAndBordersLie) {
  sim::FluidRenderer renderer(room());
  const auto view = onto_the_tank(333, 217);
  const auto whole = draw(renderer, {}, view);
  for (const auto& [x, y, width, height] :
       {std::array{5, 3, 150, 101}, std::array{200, 110, 133, 107}, std::array{161, 90, 1, 1}}) {
    const auto part = draw(renderer, {}, part_of(view, x, y, width, height));
    // An outline is followed for 16 px, which the part's borders may cut off.
    for (const int most : differences(whole, part, x, y, 18)) ASSERT_LE(most, 1) << x << ", " << y;
  }
}

TEST_F(ShadingGl, WaterIsTheSameWhereverTilesLie) {
  sim::FluidRenderer renderer(room());
  const auto view = onto_the_tank(333, 217);
  const auto whole = draw(renderer, pool(), view);
  const auto part = draw(renderer, pool(), part_of(view, 53, 31, 211, 149));
  // Leaves out the filter's reach beyond the part's borders.
  const auto most = differences(whole, part, 53, 31, 40);
  // The part's rays are rounded differently, which moves outlines: 16 pixels differ.
  EXPECT_LE(std::count_if(most.begin(), most.end(), [](int levels) { return levels > 1; }), 40);
  // Where rounding moves an outline, the share of the light beyond it changes: 6 pixels.
  EXPECT_LE(std::count_if(most.begin(), most.end(), [](int levels) { return levels > 9; }), 15);
}

TEST_F(ShadingGl, EveryPixelOfAnySizeIsWrittenAndNoneBesideIt) {
  sim::FluidRenderer renderer(room());
  sim::ParticleBuffer buffer;
  buffer.upload(pool());
  for (const auto& [width, height] :
       {std::array{1, 1}, std::array{7, 5}, std::array{16, 8}, std::array{17, 9}, std::array{333, 217}}) {
    auto view = onto_the_tank(width, height);
    view.viewport.x = 3;
    view.viewport.y = 2;
    const sim::Offscreen target(width + 8, height + 6);
    const float before[4] = {1, 0, 1, 0};
    glClearNamedFramebufferfv(target.framebuffer(), GL_COLOR, 0, before);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    const auto seen = target.read();
    for (int y = 0; y < seen.height; ++y) {
      for (int x = 0; x < seen.width; ++x) {
        const bool inside = x >= 3 && x < 3 + width && y >= 2 && y < 2 + height;
        const std::uint8_t* rgba = pixel(seen, x, y);
        ASSERT_EQ(rgba[3], inside ? 255 : 0) << x << ", " << y << " of " << width << " x " << height;
        ASSERT_EQ(rgba[0] == 255 && rgba[1] == 0 && rgba[2] == 255, !inside) << x << ", " << y;
      }
    }
  }
}

TEST_F(ShadingGl, AFramebufferOfAnotherKindHoldsTheSamePicture) {
  sim::FluidRenderer renderer(room());
  auto view = onto_the_tank(75, 43);
  view.viewport.x = 2;
  view.viewport.y = 1;
  const auto expected = draw(renderer, pool(), view);
  sim::ParticleBuffer buffer;
  buffer.upload(pool());
  for (const GLenum format : {GL_RGB8, GL_SRGB8_ALPHA8}) {
    GLuint colour = 0, framebuffer = 0;
    glCreateRenderbuffers(1, &colour);
    glNamedRenderbufferStorage(colour, format, expected.width, expected.height);
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    renderer.draw(buffer, {&view, 1}, framebuffer);
    const auto seen = sim::read_framebuffer(framebuffer, expected.width, expected.height);
    for (int y = 1; y < expected.height; ++y) {
      for (int x = 2; x < expected.width; ++x) {
        ASSERT_TRUE(std::equal(pixel(seen, x, y), pixel(seen, x, y) + 3, pixel(expected, x, y)))
            << x << ", " << y << " of format " << format;
      }
    }
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(1, &colour);
  }
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(ShadingGl, ACoarserThicknessChangesLittle) {
  const auto view = onto_the_tank(640, 400);
  auto options = sim::RenderOptions{};
  sim::FluidRenderer usual(room(), options);
  const auto expected = draw(usual, pool(), view);
  for (const int step : {1, 4}) {
    options.thickness_step = step;
    sim::FluidRenderer other(room(), options);
    const auto seen = draw(other, pool(), view);
    double sum = 0;
    for (std::size_t k = 0; k < seen.rgba.size(); ++k) {
      const int difference = seen.rgba[k] - expected.rgba[k];
      sum += difference * difference;
    }
    const double mse = sum / (0.75 * static_cast<double>(seen.rgba.size()));
    EXPECT_GT(10 * std::log10(255 * 255 / mse), 45) << step;
  }
}

TEST_F(ShadingGl, WaterThatLeftATileLeavesNothingThere) {
  const auto view = view_along_z(167, 121), small = view_along_z(90, 70);
  const auto left = ball(-1.2F, -0.5F, 4), right = ball(1, 0.6F, 4);
  sim::FluidRenderer fresh(room(), open_options());
  const auto expected = draw(fresh, right, view);
  const auto expected_buffer = fresh.read_gbuffer();
  sim::FluidRenderer used(room(), open_options());
  draw(used, left, view);
  draw(used, right, view);
  EXPECT_EQ(draw(used, right, view).rgba, expected.rgba);
  render_test::expect_same_bits(used.read_gbuffer(), expected_buffer);
  draw(used, left, view);
  EXPECT_EQ(draw(used, right, view).rgba, expected.rgba);
  render_test::expect_same_bits(used.read_gbuffer(), expected_buffer);
  draw(used, left, small);
  EXPECT_EQ(draw(used, right, view).rgba, expected.rgba);
  render_test::expect_same_bits(used.read_gbuffer(), expected_buffer);
  draw(used, {}, view);
  for (const float z : used.read_gbuffer().filtered_depth) ASSERT_FALSE(std::isfinite(z));
}

}  // namespace
