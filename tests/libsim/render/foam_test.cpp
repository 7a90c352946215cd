/// Pictures of foam in front of the water, on it and below it. Only scenes with foam have its pass.

#include <numeric>

#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::open_options;
using render_test::view_along_z;
using sim::RenderParticle;

class FoamGl : public render_test::RenderGl {
 protected:
  static sim::Scene sea(double emission_per_s) {
    sim::Scene scene = room();
    if (emission_per_s >= 0) scene.effects = {{sim::EffectKind::Foam, emission_per_s}};
    return scene;
  }
  static std::vector<std::string> passes(const sim::FluidRenderer& renderer) {
    std::vector<std::string> out;
    for (const auto& time : renderer.times()) out.push_back(time.pass);
    return out;
  }

  /// Water 2 m ahead: a wall of particles of 0.1 m radius.
  static std::vector<RenderParticle> water() {
    std::vector<RenderParticle> out;
    for (int y = -12; y <= 12; ++y)
      for (int x = -12; x <= 12; ++x)
        for (int z = 0; z < 4; ++z)
          out.push_back({0.2F * static_cast<float>(x), 0.2F * static_cast<float>(y),
                         -2 - 0.2F * static_cast<float>(z), 0.1F});
    return out;
  }

  sim::Image drawn(const sim::Scene& scene, const std::vector<RenderParticle>& foam) {
    sim::RenderOptions options = open_options();
    options.time_passes = true;
    sim::FluidRenderer renderer(scene, options);
    sim::ParticleBuffer buffer, diffuse;
    buffer.upload(water());
    diffuse.upload(foam);
    const auto view = view_along_z(64, 64);
    const sim::Offscreen target(64, 64);
    // The second picture must not depend on the first.
    for (int k = 0; k < 2; ++k) renderer.draw(buffer, {&view, 1}, target.framebuffer(), &diffuse);
    last_passes = passes(renderer);
    last_seen = renderer.read_gbuffer();
    return target.read();
  }
  /// Sum of the differences of the middle pixel's channels.
  static int change(const sim::Image& a, const sim::Image& b) {
    int out = 0;
    const std::size_t at = 4 * static_cast<std::size_t>(64 * 32 + 32);
    for (std::size_t c = 0; c < 3; ++c) out += b.rgba[at + c] - a.rgba[at + c];
    return out;
  }

  /// Mean of |n - n of the middle| over the square of 17 px round the middle of the last picture.
  double roughness() const {
    const auto normal = [&](int x, int y, int c) {
      return static_cast<double>(last_seen.normal[static_cast<std::size_t>(3 * (64 * y + x) + c)]);
    };
    double sum = 0;
    for (int y = 24; y <= 40; ++y)
      for (int x = 24; x <= 40; ++x)
        sum += std::hypot(normal(x, y, 0) - normal(32, 32, 0), normal(x, y, 1) - normal(32, 32, 1),
                          normal(x, y, 2) - normal(32, 32, 2));
    return sum / (17 * 17);
  }

  std::vector<std::string> last_passes;
  sim::GBuffer last_seen;
};

TEST_F(FoamGl, HasAPassOnlyWhereTheSceneListsIt) {
  const RenderParticle spray{0, 0, -1, 0.1F};
  const auto bare = drawn(sea(-1), {spray});
  const auto without = last_passes;
  EXPECT_EQ(std::count(without.begin(), without.end(), "foam"), 0);
  const auto dropped = drawn(sea(0), {spray});
  EXPECT_EQ(last_passes, without);
  EXPECT_EQ(dropped.rgba, bare.rgba);
  const auto empty = drawn(sea(1), {});
  EXPECT_EQ(last_passes, without) << "nobody is drawn by no pass";
  EXPECT_EQ(empty.rgba, bare.rgba) << "and the composite with foam is the composite";
  drawn(sea(1), {spray});
  // passes_in_words names the passes that run.
  for (const auto& pass : last_passes)
    EXPECT_NE(sim::passes_in_words(sea(1)).find(pass), std::string::npos) << pass;
  EXPECT_NE(sim::passes_in_words(sea(0)).find("not called for"), std::string::npos);
  EXPECT_EQ(std::count(last_passes.begin(), last_passes.end(), "foam"), 1);
}

TEST_F(FoamGl, SprayIsBeforeTheWaterAndBubblesAreDimmedBelowIt) {
  const auto bare = drawn(sea(1), {});
  const int before = change(bare, drawn(sea(1), {{0, 0, -1, 0.1F}}));
  const int on_it = change(bare, drawn(sea(1), {{0, 0, -1.9F, 0.1F}}));
  const int below = change(bare, drawn(sea(1), {{0, 0, -2.4F, 0.1F}}));
  const int deep = change(bare, drawn(sea(1), {{0, 0, -4, 0.1F}}));
  EXPECT_GT(before, 60);
  EXPECT_GT(on_it, 60);
  EXPECT_GT(below, 10);
  EXPECT_LT(below, on_it);
  EXPECT_LT(deep, below);
}

TEST_F(FoamGl, IsRoughForSaliencyAsFarAsItCovers) {
  const RenderParticle wide{0, 0, -1, 0.6F};
  drawn(sea(1), {});
  const double bare = roughness();
  drawn(sea(-1), {wide});
  EXPECT_EQ(roughness(), bare) << "nothing without the effect";
  drawn(sea(1), {wide});
  const double covered = roughness();
  for (std::size_t p = 0; p < last_seen.depth.size(); ++p) {
    const float* n = &last_seen.normal[3 * p];
    if (last_seen.front[p] == sim::GBuffer::no_particle) continue;
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-3);
  }
  EXPECT_GT(covered, bare + 0.4);
  // Bubbles deep below the surface leave it smooth.
  drawn(sea(1), {{0, 0, -4, 0.6F}});
  EXPECT_NEAR(roughness(), bare, 1e-6);
  // Foam that covers little changes little.
  const std::vector<RenderParticle> one{{0.1F, 0.1F, -1, 0.006F}};
  drawn(sea(1), one);
  EXPECT_LT(roughness(), bare + 0.1 * covered);
}

TEST_F(FoamGl, WhoeverHasNoRadiusOrPlaceIsNobody) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto bare = drawn(sea(1), {});
  EXPECT_EQ(drawn(sea(1), {{0, 0, -1, 0}, {nan, 0, -1, 1}, {0, 0, 1, 0.1F}, {0, 0, -1, nan}}).rgba,
            bare.rgba);
}

TEST_F(FoamGl, FarFoamFadesInsteadOfGrowing) {
  // A tenth of the size at the same place gives a hundredth of the light, even below a pixel.
  const auto bare = drawn(sea(1), {});
  const auto light = [&](float radius) {
    const auto picture = drawn(sea(1), {{0.01F, 0.01F, -1, radius}});
    return std::transform_reduce(picture.rgba.begin(), picture.rgba.end(), bare.rgba.begin(), 0,
                                 std::plus<>(), [](int a, int b) { return std::abs(a - b); });
  };
  const int whole = light(0.06F), small = light(0.006F);
  EXPECT_GT(whole, 500);
  EXPECT_GT(small, 0);
  EXPECT_LT(small, whole / 20);
}

TEST_F(FoamGl, OrderDoesNotMatter) {
  std::vector<RenderParticle> foam;
  for (int k = 0; k < 200; ++k)
    foam.push_back({0.3F * std::sin(static_cast<float>(k)), 0.3F * std::cos(static_cast<float>(3 * k)),
                    -1 - 0.01F * static_cast<float>(k), 0.03F});
  const auto picture = drawn(sea(1), foam);
  std::reverse(foam.begin(), foam.end());
  EXPECT_EQ(drawn(sea(1), foam).rgba, picture.rgba);
}

}  // namespace
