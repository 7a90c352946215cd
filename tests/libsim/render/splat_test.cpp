#include <random>
#include <sstream>

#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::exact_options;
using render_test::view_along_z;
using sim::RenderParticle;

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class SplatGl : public render_test::RenderGl {
 protected:
  void expect_matches_brute_force(const std::vector<RenderParticle>& particles, const sim::View& view,
                                  const sim::RenderOptions& options = exact_options()) {
    const auto g = render(particles, view, options);
    const auto reference = render_test::splat(particles, view, 1);
    ASSERT_EQ(g.depth.size(), reference.depth.size());
    std::size_t compared = 0, wrong = 0;
    for (std::size_t p = 0; p < g.depth.size(); ++p) {
      if (reference.rim[p]) continue;
      ++compared;
      if (!agrees(g, reference, p, particles) && ++wrong <= 8) ADD_FAILURE() << describe(g, reference, p);
    }
    EXPECT_EQ(wrong, 0u) << "of " << compared << " pixels, on " << sim::gl_description();
    EXPECT_GE(compared, g.depth.size() * 9 / 10);
    EXPECT_EQ(counts.front_missing, 0u);
  }

 private:
  static bool agrees(const sim::GBuffer& g, const render_test::Reference& reference, std::size_t p,
                     const std::vector<RenderParticle>& particles) {
    if (std::abs(g.thickness[p] - reference.thickness[p]) > 1e-3 + 1e-3 * reference.thickness[p])
      return false;
    const double depth = reference.depth[p], tolerance = 1e-4 * depth;
    if (std::isinf(depth)) return g.depth[p] == inf && g.front[p] == sim::GBuffer::no_particle;
    if (!(std::abs(g.depth[p] - depth) <= tolerance) || g.front[p] >= particles.size()) return false;
    // Where two fronts cross within the tolerance, rounding decides which particle is named.
    const auto named = render_test::chord_at(particles[g.front[p]], g.view, p);
    return named && named->entry - depth <= tolerance;
  }

  static std::string describe(const sim::GBuffer& g, const render_test::Reference& reference, std::size_t p) {
    std::ostringstream text;
    text.precision(9);
    const auto width = static_cast<std::size_t>(g.width);
    text << "pixel (" << p % width << ", " << p / width << "): depth " << g.depth[p] << ", expected "
         << reference.depth[p] << "; thickness " << g.thickness[p] << ", expected " << reference.thickness[p]
         << "; front " << g.front[p] << ", expected " << reference.front[p];
    return text.str();
  }
};

std::vector<RenderParticle> cloud(std::size_t count, float radius_min, float radius_max, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<RenderParticle> particles(count);
  for (auto& p : particles) {
    const float depth = 2 + 6 * unit(random);
    p = {depth * (1.4F * unit(random) - 0.7F), depth * (1.4F * unit(random) - 0.7F), -depth,
         radius_min + (radius_max - radius_min) * unit(random)};
  }
  return particles;
}

TEST_F(SplatGl, LoneSphereHasItsClosedForm) {
  const auto view = view_along_z(96, 64);
  const std::vector<RenderParticle> one{{0.3F, -0.2F, -4, 0.5F}};
  const auto g = render(one, view);
  const auto rays = sim::pixel_rays(view);
  int inside = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const double sx = (x + 0.5) * rays.scale_x + rays.offset_x,
                   sy = (y + 0.5) * rays.scale_y + rays.offset_y;
      // Distance of the ray from the centre; the chord is 2 sqrt(r^2 - d^2).
      const double dot = (sx * 0.3 - sy * 0.2 + 4) / std::sqrt(sx * sx + sy * sy + 1);
      const double d2 = 0.3 * 0.3 + 0.2 * 0.2 + 16 - dot * dot;
      const auto at = static_cast<std::size_t>(96 * y + x);
      if (d2 > 0.26) {
        EXPECT_EQ(g.depth[at], inf);
      }
      if (d2 > 0.24) continue;
      ++inside;
      EXPECT_NEAR(g.thickness[at], 2 * std::sqrt(0.25 - d2), 1e-3);
      EXPECT_NEAR(g.depth[at], (dot - std::sqrt(0.25 - d2)) / std::sqrt(sx * sx + sy * sy + 1), 1e-3);
      EXPECT_EQ(g.front[at], 0u);
      EXPECT_FLOAT_EQ(g.radius[at], 0.5F);
    }
  }
  EXPECT_GT(inside, 100);
}

TEST_F(SplatGl, DepthUnderTheCentreIsTheFrontOfTheScaledSphere) {
  // Eq. 8: d_t = z - depth - scale r must vanish for a lone particle.
  auto options = exact_options();
  options.radius_scale = 1.5F;
  const auto g = render({{0, 0, -5, 0.2F}}, view_along_z(65, 65), options);
  const auto centre = static_cast<std::size_t>(65 * 32 + 32);
  EXPECT_NEAR(5 - g.depth[centre] - g.radius_scale * g.radius[centre], 0, 1e-3);
  EXPECT_FLOAT_EQ(g.radius[centre], 0.2F);
}

TEST_F(SplatGl, NearerOfTwoOnARayIsInFront) {
  const RenderParticle near{0, 0, -3, 0.3F}, far{0, 0, -5, 0.3F};
  const auto centre = static_cast<std::size_t>(33 * 16 + 16);
  const auto g = render({far, near}, view_along_z(33, 33));
  EXPECT_EQ(g.front[centre], 1u);
  EXPECT_NEAR(g.depth[centre], 2.7, 1e-3);
  EXPECT_NEAR(g.thickness[centre], 1.2, 1e-3);
  EXPECT_EQ(render({near, far}, view_along_z(33, 33)).front[centre], 0u);
}

TEST_F(SplatGl, EqualDepthGoesToTheLowestIndex) {
  std::vector<RenderParticle> particles{{0, 0, -6, 0.3F}};
  particles.insert(particles.end(), 300, RenderParticle{0, 0, -3, 0.3F});
  const auto g = render(particles, view_along_z(33, 33));
  for (std::size_t p = 0; p < g.front.size(); ++p) {
    if (std::isfinite(g.depth[p])) {
      EXPECT_EQ(g.front[p], 1u) << "pixel " << p;
    }
  }
}

TEST_F(SplatGl, CloudMatchesBruteForce) {
  expect_matches_brute_force(cloud(200, 0.12F, 0.3F, 1), view_along_z(80, 60));
}

TEST_F(SplatGl, LargeFootprintsMatchBruteForce) {
  expect_matches_brute_force(cloud(25, 0.4F, 1.2F, 2), view_along_z(200, 150));
}

TEST_F(SplatGl, LargeFootprintsMatchBruteForceHoweverTheyAreSplit) {
  // thread_px decides how a footprint is split between invocations; its default depends on the driver.
  auto options = exact_options();
  const auto particles = cloud(25, 0.4F, 1.2F, 2);
  for (const int thread_px : {1, 16, 64, 400}) {
    SCOPED_TRACE(thread_px);
    options.thread_px = thread_px;
    options.group_px = std::max(128, thread_px);
    expect_matches_brute_force(particles, view_along_z(200, 150), options);
    EXPECT_EQ(counts.by_thread > 0, thread_px >= 64);
    EXPECT_EQ(counts.by_group > 0, thread_px < 400);
  }
}

TEST_F(SplatGl, OddAndTinyPicturesMatchBruteForce) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {33, 17}, {1, 40}}) {
    SCOPED_TRACE(width);
    const auto g = render(cloud(60, 1.2F, 2.0F, 3), view_along_z(width, height));
    const auto reference = render_test::splat(cloud(60, 1.2F, 2.0F, 3), view_along_z(width, height), 1);
    for (std::size_t p = 0; p < g.depth.size(); ++p) {
      if (reference.rim[p] || std::isinf(reference.depth[p])) continue;
      EXPECT_NEAR(g.depth[p], reference.depth[p], 1e-3);
    }
    EXPECT_EQ(image.rgba.size(), 4 * g.depth.size());
  }
}

TEST_F(SplatGl, EverySplitOfAFootprintGivesTheSameBits) {
  auto particles = cloud(60, 0.1F, 1.0F, 4);
  particles.push_back({0.05F, 0, -0.1F, 0.3F});  // crosses the near plane: covers the picture
  const auto view = view_along_z(161, 121);
  auto options = exact_options();
  options.thread_px = 1000;
  options.group_px = 1000;
  const auto by_thread = render(particles, view, options);
  EXPECT_EQ(counts.by_group + counts.by_tiles, 0u);
  options.thread_px = 1;
  const auto by_group = render(particles, view, options);
  EXPECT_GT(counts.by_group, 40u);
  options.group_px = 1;
  const auto by_tiles = render(particles, view, options);
  EXPECT_GT(counts.by_tiles, 40u);
  options.thread_px = 16;
  options.group_px = 64;
  const auto mixed = render(particles, view, options);
  EXPECT_GT(counts.by_thread, 0u);
  EXPECT_GT(counts.by_group, 0u);
  EXPECT_GT(counts.by_tiles, 0u);
  render_test::expect_same_bits(by_thread, by_group);
  render_test::expect_same_bits(by_thread, by_tiles);
  render_test::expect_same_bits(by_thread, mixed);
}

TEST_F(SplatGl, NearPlaneCutsSpheres) {
  const std::vector<RenderParticle> particles{{0, 0, -0.15F, 0.2F}, {0.4F, 0.1F, -0.3F, 0.25F}, {0, 0, 3, 1}};
  expect_matches_brute_force(particles, view_along_z(64, 48));
  EXPECT_EQ(counts.near_crossing, 2u);
  EXPECT_EQ(counts.outside, 1u);
}

TEST_F(SplatGl, SphereBelowAPixelFillsThePixelOfItsCentre) {
  const auto view = view_along_z(64, 64);
  // A sphere with a radius of 2 mm at 10 m, where a pixel is 0.18 m wide. It contains no pixel's centre.
  const auto g = render({{0.01F, 0.01F, -10, 0.002F}}, view);
  EXPECT_EQ(counts.subpixel, 1u);
  const auto at = static_cast<std::size_t>(64 * 32 + 32);
  EXPECT_NEAR(g.depth[at], 10, 0.01);
  EXPECT_EQ(std::count_if(g.depth.begin(), g.depth.end(), [](float d) { return std::isfinite(d); }), 1);
}

TEST_F(SplatGl, NotFiniteParticlesAreSkippedAndCounted) {
  const auto good = cloud(20, 0.1F, 0.3F, 5);
  std::vector<RenderParticle> mixed;
  for (const auto& p : good) mixed.push_back(p);
  mixed.push_back({nan, 0, -3, 0.2F});
  mixed.push_back({0, inf, -3, 0.2F});
  mixed.push_back({0, 0, -3, nan});
  mixed.push_back({0, 0, -3, 0});
  mixed.push_back({0, 0, -3, -1});
  const auto expected = render(good, view_along_z(64, 48));
  EXPECT_EQ(counts.not_finite, 0u);
  const auto g = render(mixed, view_along_z(64, 48));
  EXPECT_EQ(counts.not_finite, 5u);
  render_test::expect_same_bits(expected, g);
}

TEST_F(SplatGl, ThicknessSaturatesAndSaysSo) {
  auto options = exact_options();
  options.thickness_unit_m = 1e-10F;  // full at 0.43 m
  const std::vector<RenderParticle> particles(3, RenderParticle{0, 0, -3, 0.15F});
  const auto g = render(particles, view_along_z(33, 33), options);
  EXPECT_GT(counts.thickness_full, 0u);
  EXPECT_FLOAT_EQ(g.thickness[33 * 16 + 16], 4294967295.0F * 1e-10F);
  render({particles[0]}, view_along_z(33, 33), options);
  EXPECT_EQ(counts.thickness_full, 0u);
}

TEST_F(SplatGl, NoParticlesLeaveTheRoom) {
  const auto g = render({}, view_along_z(40, 30));
  EXPECT_TRUE(std::all_of(g.depth.begin(), g.depth.end(), [](float d) { return d == inf; }));
  EXPECT_TRUE(
      std::all_of(g.filtered_depth.begin(), g.filtered_depth.end(), [](float d) { return d == inf; }));
  EXPECT_TRUE(std::all_of(g.normal.begin(), g.normal.end(), [](float n) { return n == 0; }));
  EXPECT_TRUE(std::all_of(g.thickness.begin(), g.thickness.end(), [](float t) { return t == 0; }));
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) EXPECT_EQ(image.rgba[i], 255);
  const auto empty = image;
  // Fluid behind the eye changes nothing.
  render({{0, 0, 5, 1}}, view_along_z(40, 30));
  EXPECT_EQ(image.rgba, empty.rgba);
}

/// A dense body with droplets before and behind it, in random order.
std::vector<RenderParticle> body(unsigned seed, float shift) {
  std::mt19937 random(seed);
  auto particles = cloud(60, 0.19F, 0.25F, seed);
  for (int i = 0; i < 12 * 12 * 12; ++i) {
    const auto x = static_cast<float>(i % 12), y = static_cast<float>(i / 12 % 12),
               z = static_cast<float>(i / 144);
    particles.push_back({0.2F * x - 1.1F + shift, 0.2F * y - 1.1F, -3 - 0.2F * z, 0.13F});
  }
  std::shuffle(particles.begin(), particles.end(), random);
  return particles;
}

TEST_F(SplatGl, WhatIsRememberedOfTheLastPictureNeverShows) {
  const auto view = view_along_z(48, 36);
  for (const int thread_px : {64, 2}) {  // small footprints, wide footprints
    auto options = exact_options();
    options.thread_px = thread_px;
    sim::FluidRenderer renderer(room(), options);
    sim::ParticleBuffer buffer;
    const sim::Offscreen target(48, 36);
    // The third picture has as many particles, in other places and another order.
    for (const auto& particles : {body(1, 0), body(1, 0), body(2, 0.9F)}) {
      buffer.upload(particles);
      renderer.draw(buffer, {&view, 1}, target.framebuffer());
      const auto g = renderer.read_gbuffer();
      const auto picture = target.read();
      render_test::expect_same_bits(render(particles, view, options), g);
      EXPECT_EQ(picture.rgba, image.rgba);
      const auto reference = render_test::splat(particles, view, 1);
      for (std::size_t p = 0; p < g.depth.size(); ++p) {
        if (reference.rim[p] || std::isinf(reference.depth[p])) continue;
        EXPECT_NEAR(g.depth[p], reference.depth[p], 1e-3);
        EXPECT_EQ(g.front[p], reference.front[p]);
      }
    }
  }
}

TEST_F(SplatGl, TwoRunsAgreeInEveryBit) {
  const auto particles = cloud(3000, 0.05F, 0.2F, 6);
  const auto first = render(particles, view_along_z(160, 120), render_test::open_options());
  const auto picture = image;
  const auto second = render(particles, view_along_z(160, 120), render_test::open_options());
  render_test::expect_same_bits(first, second);
  EXPECT_EQ(picture.rgba, image.rgba);
}

}  // namespace
