/// What surrounds the tank, [light] and smooth outlines.

#include <numeric>
#include <random>

#include "libsim/surface/host_surface.hpp"
#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::open_options;
using sim::RenderParticle;

class SurroundingsGl : public render_test::RenderGl {
 protected:
  static sim::Scene lit(sim::SceneLight light) {
    sim::Scene scene = room();
    scene.light = light;
    return scene;
  }
  static sim::View from(const sim::Vec3d& eye, const sim::Vec3d& target, int width, int height) {
    sim::Camera camera;
    camera.eye_m = eye;
    camera.target_m = target;
    camera.vertical_fov_deg = 50;
    return sim::make_view(camera, width, height);
  }
  static sim::View over_the_tank(int width, int height) {
    return from({12, 5, 14}, {4, 1.5, 4}, width, height);
  }
  /// A pool in waves, and drops above it.
  static std::vector<RenderParticle> water() {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> place(1, 7);
    std::vector<RenderParticle> out;
    for (float x = 0.1F; x < 8; x += 0.2F)
      for (float z = 0.1F; z < 8; z += 0.2F)
        for (float y = 0.1F; y < 1 + 0.3F * std::sin(x + z); y += 0.2F) out.push_back({x, y, z, 0.1F});
    for (int k = 0; k < 60; ++k)
      out.push_back({place(random), 1 + 0.4F * place(random), place(random), 0.1F});
    return out;
  }

  sim::Image drawn(const sim::Scene& scene, const std::vector<RenderParticle>& particles,
                   const sim::View& view, const sim::RenderOptions& options = {},
                   const std::vector<sim::RenderShape>& shapes = {}) {
    sim::FluidRenderer renderer(scene, options);
    sim::ParticleBuffer buffer;
    buffer.upload(particles, shapes);
    const sim::Offscreen target(view.viewport.width, view.viewport.height);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    gbuffer = renderer.read_gbuffer();
    floor = scene.light.shadow ? renderer.read_floor() : sim::FloorMap{};
    return target.read();
  }

  /// Root mean square difference, in levels, between a picture and one that is `fine` times as fine, averaged
  /// over the pixels of which `counts(x, y)` is true; rows from the top.
  template <class Counts>
  static double off_finer(const sim::Image& picture, const sim::Image& finer, int fine, Counts counts) {
    double sum = 0;
    int values = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        if (!counts(x, y)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
          double mean = 0;
          for (int k = 0; k < fine * fine; ++k)
            mean += linear(*at(finer, fine * x + k % fine, fine * y + k / fine, c)) / (fine * fine);
          const double off = encoded(mean) - *at(picture, x, y, c);
          sum += off * off;
          ++values;
        }
      }
    }
    return std::sqrt(sum / values);
  }
  static const std::uint8_t* at(const sim::Image& image, int x, int y, std::size_t c = 0) {
    return &image.rgba[4 * static_cast<std::size_t>(image.width * y + x) + c];
  }
  static double linear(int level) {
    const double v = level / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  static double encoded(double v) {
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
  }
  static double mean_of(const sim::Image& image, std::size_t channel) {
    double sum = 0;
    for (std::size_t k = channel; k < image.rgba.size(); k += 4) sum += image.rgba[k];
    return 4 * sum / static_cast<double>(image.rgba.size());
  }

  sim::GBuffer gbuffer;
  sim::FloorMap floor;
};

TEST_F(SurroundingsGl, FollowTheSeedAndNothingElse) {
  for (const auto environment : {sim::Environment::Sky, sim::Environment::Room}) {
    const auto scene = lit({environment, 3});
    const auto view = over_the_tank(160, 90);
    const auto first = drawn(scene, water(), view);
    EXPECT_EQ(drawn(scene, water(), view).rgba, first.rgba);
    EXPECT_NE(drawn(lit({environment, 4}), water(), view).rgba, first.rgba);
  }
}

TEST_F(SurroundingsGl, SkyAndRoomDifferOutsideTheTankAndShareItsFloor) {
  const auto down = from({4, 3, 4}, {4.5, 0, 4.5}, 40, 40);  // sees the tank's floor alone
  EXPECT_EQ(drawn(lit({sim::Environment::Sky}), {}, down).rgba,
            drawn(lit({sim::Environment::Room}), {}, down).rgba);
  const auto out = over_the_tank(40, 40);
  EXPECT_NE(drawn(lit({sim::Environment::Sky}), {}, out).rgba,
            drawn(lit({sim::Environment::Room}), {}, out).rgba);
}

TEST_F(SurroundingsGl, SaliencysInputsDoNotKnowOfLight) {
  const auto view = over_the_tank(160, 90);
  drawn(lit({}), water(), view);
  const auto usual = gbuffer;
  drawn(lit({sim::Environment::Room, 9, {1, 0.5, 0.2}, false}), water(), view);
  render_test::expect_same_bits(gbuffer, usual);
}

TEST_F(SurroundingsGl, WaterTakesTheColoursThatTheSceneSays) {
  const auto view = over_the_tank(160, 90);
  const auto clear = drawn(lit({sim::Environment::Sky, 0, {0, 0, 0}}), water(), view);
  const auto red = drawn(lit({sim::Environment::Sky, 0, {0, 2, 2}}), water(), view);
  EXPECT_GT(mean_of(red, 0), mean_of(clear, 0) - 8);
  EXPECT_LT(mean_of(red, 1), mean_of(clear, 1) - 15);
  EXPECT_LT(mean_of(red, 2), mean_of(clear, 2) - 15);
}

// The floor has 1 m tiles and the ground 2 m slabs. At 20 px per degree and at 5 both are finer than a pixel
// in the distance: there the pattern must fade to its mean and form no other.
TEST_F(SurroundingsGl, PatternsInTheDistanceFadeToTheirMean) {
  auto scene = lit({});
  scene.tank_size_m = {400, 4, 400};
  scene.light.shadow = false;
  for (const int px : {90, 360}) {
    sim::Camera camera;
    camera.eye_m = {200.3, 1.7, 399};
    camera.target_m = {150, 1.2, 0};
    camera.vertical_fov_deg = 18;
    const auto picture = drawn(scene, {}, sim::make_view(camera, px, px));
    const auto finer = drawn(scene, {}, sim::make_view(camera, 4 * px, 4 * px));
    const auto on_the_floor = [&](int, int y) { return y > 6 * px / 10; };
    // Measured: 2.2 and 1.3 levels. Without the average over the footprint 17 and 12.
    EXPECT_LT(off_finer(picture, finer, 4, on_the_floor), 5) << px;
  }
}

/// Pixels that a finer picture shows to lie on an outline of the water: some of their parts hold water.
std::vector<bool> on_outlines(const sim::GBuffer& finer, int width, int height, int fine) {
  std::vector<bool> out;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int wet = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const int px = fine * x + k % fine, py = fine * (height - 1 - y) + k / fine;
        wet += std::isfinite(finer.depth[static_cast<std::size_t>(finer.width * py + px)]);
      }
      out.push_back(wet > 0 && wet < fine * fine);
    }
  }
  return out;
}

TEST_F(SurroundingsGl, OutlinesOfWaterAreSmooth) {
  auto scene = lit({});
  scene.light.absorption_per_m = {20, 20, 20};  // dark water before a bright sky
  scene.light.shadow = false;
  const std::vector<RenderParticle> drop{{0.3F, 4, -2.1F, 0.8F}};
  sim::Camera camera;
  camera.eye_m = {0, 0.5, 3};
  camera.target_m = {0, 4, -2};
  camera.vertical_fov_deg = 40;
  const auto options = render_test::exact_options();
  const auto picture = drawn(scene, drop, sim::make_view(camera, 160, 120), options);
  const auto finer = drawn(scene, drop, sim::make_view(camera, 640, 480), options);
  const auto outline = on_outlines(gbuffer, 160, 120, 4);
  const auto counts = [&](int x, int y) { return outline[static_cast<std::size_t>(160 * y + x)]; };
  EXPECT_GT(std::count(outline.begin(), outline.end(), true), 100);
  // Measured: 12.8 levels, and 22.7 without smoothing.
  EXPECT_LT(off_finer(picture, finer, 4, counts), 16);
}

TEST_F(SurroundingsGl, OutlinesOfSolidsAreSmooth) {
  auto scene = lit({});
  scene.light.shadow = false;
  sim::Obstacle ball;
  ball.radius_m = 0.8;
  ball.start.centre_m = {0.3, 0.6, -3};
  scene.obstacles = {ball};
  const auto coarse = render_test::view_along_z(160, 120), fine = render_test::view_along_z(640, 480);
  const auto picture = drawn(scene, {}, coarse), finer = drawn(scene, {}, fine);
  const auto counts = [&](int x, int y) {
    int hits = 0;
    for (int k = 0; k < 16; ++k) {
      const int px = 4 * x + k % 4, py = 4 * (119 - y) + k / 4;
      hits += render_test::chord_at({0.3F, 0.6F, -3, 0.8F}, fine, static_cast<std::size_t>(640 * py + px))
                  .has_value();
    }
    return hits > 0 && hits < 16;
  };
  // Measured: 15.8 levels, and 35.1 without smoothing.
  EXPECT_LT(off_finer(picture, finer, 4, counts), 20);
}

/// True if the ray through a point of the picture, px from the top left, passes the box from 0 to `size_m`.
bool passes(const sim::View& view, double x, double y, const sim::Vec3d& size_m) {
  const auto rays = sim::pixel_rays(view);
  const auto pose = sim::rigid_inverse(view.view);
  const double slopes[3] = {x * rays.scale_x + rays.offset_x,
                            (view.viewport.height - y) * rays.scale_y + rays.offset_y, -1};
  double enter = 0, leave = 1e9;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = slopes[0] * pose[k] + slopes[1] * pose[4 + k] + slopes[2] * pose[8 + k];
    const double a = -pose[12 + k] / along, b = (size_m[k] - pose[12 + k]) / along;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

TEST_F(SurroundingsGl, OutlinesOfTheTankAreSmooth) {
  auto scene = lit({});
  scene.light.shadow = false;
  scene.tank_size_m = {2.8, 2, 1.2};
  const sim::Vec3d eye{1.2, 1.8, 4.6}, target{1.4, 0.7, 0.6};
  const auto fine = from(eye, target, 960, 640);
  const auto picture = drawn(scene, {}, from(eye, target, 240, 160)), finer = drawn(scene, {}, fine);
  const auto counts = [&](int x, int y) {
    int hits = 0;
    for (int k = 0; k < 16; ++k)
      hits += passes(fine, 4 * x + k % 4 + 0.5, 4 * y + k / 4 + 0.5, scene.tank_size_m);
    return hits > 0 && hits < 16;
  };
  // Measured: 8.1 levels; 12.5 if rays that miss the tank by 2 mm see its frame; 24.4 without smoothing.
  EXPECT_LT(off_finer(picture, finer, 4, counts), 10);
}

TEST_F(SurroundingsGl, ADropShowsNoFrameOfTheTank) {
  auto scene = lit({});
  scene.light.shadow = false;
  // Behind the drop stands the far corner of the tank.
  const std::vector<RenderParticle> drop{{4, 2, 4, 0.3F}};
  const auto view = from({7.9, 2, 7.9}, {4, 2, 4}, 300, 300);
  EXPECT_LT(*at(drawn(scene, {}, view), 150, 150), 110) << "the corner's post stands in the middle";
  const auto picture = drawn(scene, drop, view);
  int dark = 0;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x) {
      const auto pixel = static_cast<std::size_t>(300 * (299 - y) + x);
      dark += std::isfinite(gbuffer.depth[pixel]) && *at(picture, x, y, 1) < 110;
    }
  EXPECT_EQ(dark, 0);
}

TEST_F(SurroundingsGl, APoolMirrorsAColumnOfWaterBehindIt) {
  sim::SceneLight light;
  light.absorption_per_m = {20, 0, 20};
  light.shadow = false;
  std::vector<RenderParticle> pool;
  for (float x = 0.1F; x < 8; x += 0.2F)
    for (float z = 0.1F; z < 8; z += 0.2F)
      for (float y = 0.1F; y < 0.6F; y += 0.2F) pool.push_back({x, y, z, 0.1F});
  auto with_column = pool;
  for (float x = 3.1F; x < 4.9F; x += 0.2F)
    for (float z = 1.9F; z < 2.7F; z += 0.2F)
      for (float y = 0.7F; y < 3.5F; y += 0.2F) with_column.push_back({x, y, z, 0.1F});
  const auto view = from({4, 1.4, 7.8}, {4, 0.8, 2}, 120, 120);
  const auto bare = drawn(lit(light), pool, view), mirrored = drawn(lit(light), with_column, view);
  // Pixels of the pool at z = 3.8 to 4.6, between the eye and the column.
  const auto rays = sim::pixel_rays(view);
  const auto pose = sim::rigid_inverse(view.view);
  int pixels = 0, redder = 0;
  for (int row = 60; row < 120; ++row) {
    const double slope = (119.5 - row) * rays.scale_y + rays.offset_y;
    const double down = -(slope * pose[5] - pose[9]), ahead = -(slope * pose[6] - pose[10]);
    const double z = 7.8 - (1.4 - 0.6) * ahead / down;
    if (!(z > 3.8 && z < 4.6)) continue;
    ++pixels;
    redder += *at(bare, 60, row, 0) - *at(mirrored, 60, row, 0);
  }
  ASSERT_GT(pixels, 2);
  EXPECT_GT(redder, 10 * pixels) << redder;
}

TEST_F(SurroundingsGl, WaterIsLevelWhereItMeetsAWall) {
  sim::SceneLight light;
  light.shadow = false;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> shift(-0.03F, 0.03F);
  std::vector<RenderParticle> pool;
  for (float x = 0.1F; x < 8; x += 0.2F)
    for (float z = 0.1F; z < 8; z += 0.2F)
      for (float y = 0.1F; y < 1; y += 0.2F)
        pool.push_back({x + shift(random), y + shift(random), z + shift(random), 0.1F});
  std::vector<sim::RenderShape> shapes;
  sim::HostSurface(lit(light)).shape(pool, shapes);
  const auto view = from({4, 2, 2}, {4, 1, 0}, 400, 400);
  const auto picture = drawn(lit(light), pool, view, {}, shapes);
  const auto rays = sim::pixel_rays(view);
  const auto pose = sim::rigid_inverse(view.view);
  double sum = 0;
  int pixels = 0;
  for (int row = 0; row < 400; ++row) {
    // Distance from the far wall, m, of the water surface (y = 1 m) that this row of pixels shows.
    const double slope = (399.5 - row) * rays.scale_y + rays.offset_y;
    const double z = 2 + (slope * pose[6] - pose[10]) / (pose[9] - slope * pose[5]);
    if (!(z > 0.065 && z < 0.1)) continue;
    for (int x = 40; x < 360; ++x, ++pixels) {
      const double by = *at(picture, x, row, 1) - *at(picture, x + 1, row, 1);
      sum += by * by;
    }
  }
  ASSERT_GT(pixels, 600);
  // Measured: 0.55 levels, and 1.34 with the normals of particles that the wall cuts.
  EXPECT_LT(std::sqrt(sum / pixels), 0.9);
}

class PipesGl : public SurroundingsGl {
 protected:
  static sim::Scene poured() {
    sim::Scene scene = room();
    sim::Nozzle nozzle;
    nozzle.diameter_m = 0.8;
    nozzle.position_m = {4, 2.5, 4};
    nozzle.speed_m_s = 1;
    scene.nozzles = {nozzle};
    return scene;
  }
};

TEST_F(PipesGl, HideWaterAboveTheMouthAndNoneBelow) {
  const auto view = from({4, 2.5, 11}, {4, 2.5, 4}, 100, 100);
  const auto bare = drawn(poured(), {}, view);
  const auto above = drawn(poured(), {{4, 3, 4, 0.1F}}, view);
  const auto below = drawn(poured(), {{4, 2, 4, 0.1F}}, view);
  EXPECT_EQ(above.rgba, bare.rgba);
  EXPECT_NE(below.rgba, bare.rgba);
  EXPECT_NE(bare.rgba, drawn(room(), {}, view).rgba);
}

TEST_F(PipesGl, CastAShadow) {
  drawn(poured(), {}, over_the_tank(40, 40));
  // The shadow of the mouth's middle lies in the direction of the sun (shaders/light.glsl).
  const double x = 4 - 2.5 * 0.3536 / 0.8130, z = 4 - 2.5 * 0.4625 / 0.8130;
  const auto open = [&](double at_x, double at_z) {
    const auto cell = [&](double m) { return static_cast<std::size_t>(m / double{floor.cell_m}); };
    return floor.open[cell(at_z) * static_cast<std::size_t>(floor.width) + cell(at_x)];
  };
  EXPECT_EQ(open(x - 0.1, z - 0.1), 0);
  EXPECT_EQ(open(x + 1, z + 1), 1);
}

TEST_F(SurroundingsGl, WaterShadesTheFloorUnlessTheSceneSaysNo) {
  std::vector<RenderParticle> cloud;
  for (float x = 3; x < 5; x += 0.1F)
    for (float z = 3; z < 5; z += 0.1F)
      for (float y = 2; y < 2.6F; y += 0.1F) cloud.push_back({x, y, z, 0.05F});
  const auto view = from({4, 1.2, 7.5}, {3, 0, 3}, 60, 60);  // looks below the cloud
  sim::SceneLight without;
  without.shadow = false;
  const auto shaded = drawn(lit({}), cloud, view);
  const auto bright = drawn(lit(without), cloud, view);
  EXPECT_LT(mean_of(shaded, 1), mean_of(bright, 1) - 2);
  EXPECT_NE(sim::passes_in_words(lit({})).find("shadows ([light]"), std::string::npos);
  EXPECT_NE(sim::passes_in_words(lit(without)).find("shadows             not called for"), std::string::npos);
}

TEST_F(SurroundingsGl, LightOutOfRangeIsAnError) {
  for (const sim::SceneLight& light :
       {sim::SceneLight{sim::Environment::Sky, -1}, sim::SceneLight{sim::Environment::Sky, 1'000'001},
        sim::SceneLight{sim::Environment::Sky, 0, {0, -1, 0}},
        sim::SceneLight{sim::Environment::Sky, 0, {0, 0, std::nan("")}}})
    EXPECT_THROW(sim::FluidRenderer(lit(light), {}), base::Error);
}

}  // namespace
