#include <epoxy/gl.h>

#include <random>

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
  // The part begins at even pixels, so that the thickness has the same cells of 2 x 2 px.
  const auto part = draw(renderer, pool(), part_of(view, 52, 30, 211, 149));
  // Leaves out the filter's reach beyond the part's borders.
  const auto most = differences(whole, part, 52, 30, 40);
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

double linear(int level) {
  const double v = level / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// room() with this absorption of red, 1/m, and of green and blue.
sim::Scene absorbing(sim::Scene scene, double red, double rest) {
  scene.light.absorption_per_m = {red, rest, rest};
  return scene;
}

sim::View seen_from(const sim::Vec3d& eye, const sim::Vec3d& target, int width, int height) {
  sim::Camera camera;
  camera.eye_m = eye;
  camera.target_m = target;
  camera.vertical_fov_deg = 50;
  return sim::make_view(camera, width, height);
}

TEST_F(ShadingGl, WaterAwayFromTheWallsAbsorbsOverItsOwnLength) {
  // A cube with edges of 1.2 m in mid-air. Red light decays by Beer and Lambert.
  std::vector<RenderParticle> cube;
  for (float x = 3.45F; x < 4.6F; x += 0.1F)
    for (float y = 1.45F; y < 2.6F; y += 0.1F)
      for (float z = 3.45F; z < 4.6F; z += 0.1F) cube.push_back({x, y, z, 0.05F});
  const auto view = seen_from({4, 2, 7.9}, {4, 2, 4}, 101, 101);
  const auto red = [&](double per_m) {
    sim::FluidRenderer renderer(absorbing(room(), per_m, 0));
    return linear(*pixel(draw(renderer, cube, view), 50, 50));
  };
  const double opaque = red(20);
  const double kept = (red(0.5) - opaque) / (red(0) - opaque);
  EXPECT_NEAR(-std::log(kept) / 0.5, 1.2, 0.15);
}

TEST_F(ShadingGl, ShadowsInWaterHaveItsColour) {
  // On the floor below 1 m of water, what absorption leaves of red is the same in a ball's shadow as beside
  // it.
  auto scene = room();
  scene.picture_effects = {{sim::PictureEffectKind::Shadows, 1}};
  sim::Obstacle ball;
  ball.radius_m = 0.5;
  ball.start.centre_m = {4.2, 2.5, 4.4};
  std::vector<RenderParticle> water;
  for (float x = 0.05F; x < 8; x += 0.1F)
    for (float z = 0.05F; z < 8; z += 0.1F)
      for (float y = 0.05F; y < 1; y += 0.1F) water.push_back({x, y, z, 0.05F});
  const auto view = seen_from({3.3, 8, 5}, {3.3, 0, 3.2}, 80, 80);
  const auto drawn = [&](double red, bool shaded) {
    auto of = absorbing(scene, red, 0);
    if (shaded) of.obstacles = {ball};
    sim::FluidRenderer renderer(of);
    return draw(renderer, water, view);
  };
  const auto lit = drawn(0, false), dark = drawn(0, true);
  const auto kept = [&](bool shaded) {
    const auto some = drawn(0.5, shaded), opaque = drawn(20, shaded);
    const auto& none = shaded ? dark : lit;
    double left = 0, all = 0;
    for (std::size_t at = 0; at < lit.rgba.size(); at += 4) {
      const bool in_shadow =
          dark.rgba[at + 1] < lit.rgba[at + 1] - 50 && dark.rgba[at] < dark.rgba[at + 1] + 20;
      if (!in_shadow) continue;
      left += linear(some.rgba[at]) - linear(opaque.rgba[at]);
      all += linear(none.rgba[at]) - linear(opaque.rgba[at]);
    }
    EXPECT_GT(all, 1);
    return left / all;
  };
  EXPECT_NEAR(kept(true) / kept(false), 1, 0.15);  // 1.7 if water left the light of the sky as it is
}

TEST_F(ShadingGl, CrestsSeenAtASlantHaveNoDarkSpecks) {
  // Dark water under a bright sky: near the crest, where it mirrors the sky, pixels must be like their
  // neighbours.
  std::mt19937 random(7);
  std::uniform_real_distribution<float> shift(-0.04F, 0.04F);
  std::vector<RenderParticle> hill;
  for (float x = 0.1F; x < 8; x += 0.2F) {
    for (float z = 0.1F; z < 8; z += 0.2F) {
      const float top = 0.3F + 0.25F * (8 - z) - 0.02F * (8 - z) * (8 - z);
      for (float y = top; y > std::max(top - 0.7F, 0.0F); y -= 0.2F)
        hill.push_back({x + shift(random), y + shift(random), z + shift(random), 0.1F});
    }
  }
  sim::FluidRenderer renderer(absorbing(room(), 20, 20));
  const auto picture = draw(renderer, hill, seen_from({4, 1.1, 12}, {4, 1.1, 2}, 480, 270));
  const auto depth = renderer.read_depth();
  const auto wet = [&](int x, int y) { return std::isfinite(depth[static_cast<std::size_t>(480 * y + x)]); };
  int specks = 0, columns = 0;
  for (int x = 10; x < 470; ++x) {
    int top = 260;
    while (top > 20 && !wet(x, top)) --top;
    if (top == 20 || top > 250) continue;
    ++columns;
    for (int y = top; y > top - 12; --y) {
      std::vector<int> around;
      for (int k = 0; k < 25; ++k) {
        const int near_x = x + k % 5 - 2, near_y = y + k / 5 - 2;
        if (wet(near_x, near_y)) around.push_back(pixel(picture, near_x, near_y)[1]);
      }
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
      std::nth_element(around.begin(), middle, around.end());
      specks += pixel(picture, x, y)[1] < *middle - 25;
    }
  }
  ASSERT_GT(columns, 300);
  // Measured: 28 in 460 columns; 64 if a pixel beside a jump of depth has the normal of its own particle.
  EXPECT_LT(specks, columns / 15) << specks;
}

TEST_F(ShadingGl, MirroredLightHasNoStepWhereItsRaysBeginToFall) {
  // On a dark ball before the eye, the rays that its middle row mirrors are level: below it they fall.
  const std::vector<RenderParticle> one{{4, 2, 4, 0.8F}};
  sim::FluidRenderer renderer(absorbing(room(), 20, 20));
  const auto picture = draw(renderer, one, seen_from({4, 2, 7.9}, {4, 2, 4}, 301, 301));
  const auto depth = renderer.read_depth();
  int most = 0, pixels = 0;
  for (int y = 140; y < 160; ++y) {
    for (int x = 4; x < 297; ++x) {
      const auto at = static_cast<std::size_t>(301 * y + x);
      if (!std::isfinite(depth[at - 4]) || !std::isfinite(depth[at + 4])) continue;
      most = std::max(most, std::abs(pixel(picture, x, y)[1] - pixel(picture, x, y + 1)[1]));
      ++pixels;
    }
  }
  ASSERT_GT(pixels, 2000);
  // Measured: 10 levels, and 31 if the light halves where the rays begin to fall.
  EXPECT_LT(most, 16);
}

TEST_F(ShadingGl, WaterThatFallsAwayFromTheEyeShowsNoGround) {
  // Dark water slopes down by 15 degrees away from the eye, which looks down by 5 degrees. The surface
  // mirrors the eye's rays downwards, into the water.
  std::vector<RenderParticle> slope;
  for (float x = 2; x < 6; x += 0.1F)
    for (float along = 0; along < 6; along += 0.1F)
      for (float deep = 0; deep < 0.4F; deep += 0.1F)
        slope.push_back(
            {x, 2.5F - 0.2588F * along - 0.9659F * deep, 7 - 0.9659F * along + 0.2588F * deep, 0.05F});
  sim::FluidRenderer renderer(absorbing(room(), 20, 20));
  const auto picture = draw(renderer, slope, seen_from({4, 3.01, 7.89}, {4, 1.98, 5.07}, 201, 201));
  double sum = 0;
  for (int y = 96; y <= 104; ++y)
    for (int x = 80; x <= 120; ++x) sum += linear(pixel(picture, x, y)[0]);
  // Measured: 0.012, and 0.22 if a ray that hardly turns shows what lies beyond the water.
  EXPECT_LT(sum / (9 * 41), 0.05);
}

TEST_F(ShadingGl, WaterThatTurnsWithinAParticleShowsNoBentLines) {
  // A dome of coarse particles on a pool. Through flat water the floor's joints are seen.
  std::vector<RenderParticle> pool;
  for (float x = 0.1F; x < 8; x += 0.2F)
    for (float z = 0.1F; z < 8; z += 0.2F)
      for (float y = 0.1F; y < 1; y += 0.2F) pool.push_back({x, y, z, 0.1F});
  auto with_dome = pool;
  for (int k = 0; k < 60; ++k) {
    const float up = (static_cast<float>(k) + 0.5F) / 60, wide = 0.4F * std::sqrt(1 - up * up);
    const float turn = 2.39996F * static_cast<float>(k);
    with_dome.push_back({4 + wide * std::cos(turn), 0.9F + 0.4F * up, 5.5F + wide * std::sin(turn), 0.2F});
  }
  sim::FluidRenderer renderer(absorbing(room(), 0, 0));
  const auto view = seen_from({4, 2, 7.9}, {4, 1.2, 5.5}, 320, 240);
  const auto flat = draw(renderer, pool, view);
  const auto flat_depth = renderer.read_depth();
  const auto picture = draw(renderer, with_dome, view);
  const auto depth = renderer.read_depth();
  const auto on_dome = [&](int x, int y) {
    const auto at = static_cast<std::size_t>(320 * y + x);
    return depth[at] < flat_depth[at] - 0.1F;
  };
  // Root mean square difference between neighbours inside the dome's outline.
  const auto contrast = [&](const sim::Image& of) {
    double sum = 0;
    int pixels = 0;
    for (int y = 20; y < 220; ++y) {
      for (int x = 20; x < 300; ++x) {
        bool counts = true;
        for (const int by : {-5, 0, 5}) counts = counts && on_dome(x + by, y) && on_dome(x, y + by);
        if (!counts) continue;
        const int across = pixel(of, x + 1, y)[1] - pixel(of, x, y)[1];
        const int upward = pixel(of, x, y + 1)[1] - pixel(of, x, y)[1];
        sum += across * across + upward * upward;
        ++pixels;
      }
    }
    return std::sqrt(sum / pixels);
  };
  // Measured: 12.2 levels through flat water; through the dome 6.3, and 10.1 if only the turn of the normal
  // within a pixel counts.
  EXPECT_GT(contrast(flat), 10);
  EXPECT_LT(contrast(picture), 8);
}

}  // namespace
