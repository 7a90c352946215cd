/// Light on the floor: shadows and caustics, drawn only for scenes that list them.

#include <numbers>
#include <numeric>
#include <random>

#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using sim::PictureEffect;
using sim::PictureEffectKind;
using sim::RenderParticle;
using Place = std::array<double, 2>;  ///< x and z on the floor, m

constexpr double refractive_index = 1.333;
constexpr std::array<double, 3> sun{0.3536, 0.8130, 0.4625};  // of shaders/light.glsl
constexpr PictureEffect shadows{PictureEffectKind::Shadows, 1}, caustics{PictureEffectKind::Caustics, 1};

/// Direction of sunlight below a surface with this normal, by Snell's law.
std::array<double, 3> refracted(const std::array<double, 3>& normal) {
  const double ratio = 1 / refractive_index;
  const double facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2];
  const double along = ratio * facing - std::sqrt(1 - ratio * ratio * (1 - facing * facing));
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = -ratio * sun[k] + along * normal[k];
  return out;
}
/// Horizontal shift per metre of height along sunlight: in air, and in water below a flat surface.
constexpr Place leans{sun[0] / sun[1], sun[2] / sun[1]};
Place leans_in_water() {
  const auto d = refracted({0, 1, 0});
  return {d[0] / d[1], d[2] / d[1]};
}
/// Fraction of sunlight that a flat surface reflects.
double reflected() { return 0.02 + 0.98 * std::pow(1 - sun[1], 5); }

/// Columns of particles on a lattice that fill the tank up to `height(x, z)`.
template <class Height>
std::vector<RenderParticle> water(const sim::Scene& scene, double radius, Height height) {
  std::vector<RenderParticle> out;
  for (double x = radius; x < scene.tank_size_m[0]; x += 2 * radius)
    for (double z = radius; z < scene.tank_size_m[2]; z += 2 * radius)
      for (double y = height(x, z) - radius; y > 0; y -= 2 * radius)
        out.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                       static_cast<float>(radius)});
  return out;
}
std::vector<RenderParticle> flat_water(const sim::Scene& scene, double depth) {
  return water(scene, 0.05, [&](double, double) { return depth; });
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
Place place_of(const sim::FloorMap& map, std::size_t cell) {
  const auto width = static_cast<std::size_t>(map.width);
  return {(static_cast<double>(cell % width) + 0.5) * static_cast<double>(map.cell_m),
          (static_cast<double>(cell / width) + 0.5) * static_cast<double>(map.cell_m)};
}

/// Centre and area of the shadow on a floor, m and m2.
struct Dark {
  Place middle{};
  double area_m2 = 0;
};
Dark dark_of(const sim::FloorMap& map) {
  Dark out;
  double cells = 0;
  for (std::size_t k = 0; k < map.open.size(); ++k) {
    const double dark = 1 - double{map.open[k]};
    const Place place = place_of(map, k);
    for (std::size_t axis = 0; axis < 2; ++axis) out.middle[axis] += dark * place[axis];
    cells += dark;
  }
  for (double& x : out.middle) x /= cells;
  out.area_m2 = cells * double{map.cell_m} * double{map.cell_m};
  return out;
}

class FloorLightGl : public render_test::RenderGl {
 protected:
  static sim::Scene tank(std::vector<PictureEffect> effects) {
    sim::Scene scene;
    scene.tank_size_m = {4, 3, 4};
    scene.picture_effects = std::move(effects);
    scene.light.shadow = false;
    return scene;
  }
  static sim::Scene with_ball(sim::Scene scene, double y, double radius) {
    sim::Obstacle ball;
    ball.radius_m = radius;
    ball.start.centre_m = {2.2, y, 2.4};
    scene.obstacles = {ball};
    return scene;
  }
  static sim::View onto_the_floor() {
    sim::Camera camera;
    camera.eye_m = {2, 6, 5};
    camera.target_m = {2, 0, 2};
    camera.vertical_fov_deg = 50;
    return sim::make_view(camera, 96, 80);
  }

  /// Draws twice, so that leftovers of the first draw would show.
  sim::FloorMap drawn(const sim::Scene& scene, const std::vector<RenderParticle>& particles,
                      std::vector<sim::View> views = {onto_the_floor()}, int floor_cells = 512) {
    sim::RenderOptions options;
    options.time_passes = true;
    options.floor_cells = floor_cells;
    sim::FluidRenderer renderer(scene, options);
    sim::ParticleBuffer buffer;
    buffer.upload(particles);
    const sim::Offscreen target(96 * static_cast<int>(views.size()), 80);
    for (std::size_t k = 0; k < views.size(); ++k) views[k].viewport.x = 96 * static_cast<int>(k);
    for (int k = 0; k < 2; ++k) renderer.draw(buffer, views, target.framebuffer());
    picture = target.read();
    gbuffer = renderer.read_gbuffer();
    passes.clear();
    for (const auto& time : renderer.times()) passes.push_back(time.pass);
    return scene.picture_effects.empty() || !has("light") ? sim::FloorMap{} : renderer.read_floor();
  }
  bool has(const std::string& pass) const {
    return std::find(passes.begin(), passes.end(), pass) != passes.end();
  }

  sim::Image picture;
  sim::GBuffer gbuffer;
  std::vector<std::string> passes;
};

TEST_F(FloorLightGl, HasPassesOnlyWhereTheSceneListsThem) {
  const auto pool = flat_water(tank({}), 0.6);
  drawn(tank({}), pool);
  const auto bare = picture;
  const auto without = passes;
  EXPECT_FALSE(has("light") || has("shadows") || has("caustics"));
  drawn(tank({{PictureEffectKind::Shadows, 0}, {PictureEffectKind::Caustics, 0}}), pool);
  EXPECT_EQ(passes, without);
  EXPECT_EQ(picture.rgba, bare.rgba);
  for (const PictureEffect& effect : {shadows, caustics}) {
    const auto map = drawn(tank({effect}), pool);
    auto expected = without;
    expected.insert(expected.end() - 2, {"light", sim::traits_of(effect.kind).word});
    EXPECT_EQ(passes, expected);
    EXPECT_EQ(map.open.empty(), effect.kind != PictureEffectKind::Shadows);
    EXPECT_EQ(map.gathered.empty(), effect.kind != PictureEffectKind::Caustics);
  }
  // passes_in_words names the passes that run.
  const auto all = sim::passes_in_words(tank({shadows, caustics}));
  drawn(tank({shadows, caustics}), pool);
  for (const auto& pass : passes) EXPECT_NE(all.find(pass), std::string::npos) << pass;
  EXPECT_EQ(all.find("shadows             not called for"), std::string::npos);
  const auto none = sim::passes_in_words(tank({{PictureEffectKind::Shadows, 0}}));
  EXPECT_NE(none.find("shadows             not called for"), std::string::npos);
  EXPECT_NE(none.find("caustics            not called for"), std::string::npos);
  EXPECT_EQ(none.find("light"), std::string::npos);
}

TEST_F(FloorLightGl, SaliencysPictureDoesNotKnowOfIt) {
  const auto pool = flat_water(tank({}), 0.6);
  drawn(tank({}), pool);
  const auto bare = gbuffer;
  drawn(tank({shadows, caustics}), pool);
  render_test::expect_same_bits(gbuffer, bare);
}

TEST_F(FloorLightGl, BelowFlatWaterLightIsEven) {
  for (const double depth : {0.4, 1.5}) {
    const auto map = drawn(tank({caustics}), flat_water(tank({}), depth));
    EXPECT_NEAR(mean(map.gathered), 1 - reflected(), 0.005) << depth;
    const auto [least, most] = std::minmax_element(map.gathered.begin(), map.gathered.end());
    EXPECT_GT(*least, 0.93) << depth;
    EXPECT_LT(*most, 1.03) << depth;
  }
  const auto dry = drawn(tank({caustics}), {});
  for (const float light : dry.gathered) ASSERT_NEAR(light, 1, 1e-3);
}

TEST_F(FloorLightGl, WavesMoveLightAndKeepIt) {
  // Crossing waves, behind which many rays meet.
  const auto height = [](double x, double z) {
    return 1.2 + 0.05 * std::sin(4.1 * x + 1.7 * z) + 0.05 * std::cos(2.3 * x - 4.4 * z) +
           0.04 * std::sin(5 * z);
  };
  const auto map = drawn(tank({caustics}), water(tank({}), 0.04, height));
  EXPECT_NEAR(mean(map.gathered), 1 - reflected(), 0.03);
  EXPECT_GT(*std::max_element(map.gathered.begin(), map.gathered.end()), 2);
  EXPECT_LT(*std::min_element(map.gathered.begin(), map.gathered.end()), 0.7);
}

/// Waves along the unit vector `along`, and how a crest and a trough change the distance of neighbouring
/// rays.
struct Waves {
  Place along;
  double depth, height, number_per_m;

  double phase(double s) const { return number_per_m * s; }
  double at(double s) const { return depth + height * std::cos(phase(s)); }
  double rise(double s) const { return -height * number_per_m * std::sin(phase(s)); }
  /// Where a ray that enters at s meets the floor, and where it would through air alone.
  std::array<double, 2> ends(double s) const {
    const double length = std::hypot(1.0, rise(s));
    const auto d = refracted({-rise(s) * along[0] / length, 1 / length, -rise(s) * along[1] / length});
    const double bent = (d[0] * along[0] + d[2] * along[1]) / -d[1];
    return {s + bent * at(s), s - (leans[0] * along[0] + leans[1] * along[1]) * at(s)};
  }
  double widening(double s) const {
    const auto before = ends(s - 1e-4), after = ends(s + 1e-4);
    return (after[0] - before[0]) / (after[1] - before[1]);
  }
};

TEST_F(FloorLightGl, CrestsFocusAsSnellsLawSays) {
  const double heading = std::hypot(sun[0], sun[2]);
  const Place across{sun[2] / heading, -sun[0] / heading}, along{sun[0] / heading, sun[2] / heading};
  for (const Place& direction : {across, along}) {
    for (const double depth : {0.7, 1.2}) {
      const Waves waves{direction, depth, 0.08, 2 * std::numbers::pi / 1.6};
      const auto map = drawn(tank({caustics}), water(tank({}), 0.04, [&](double x, double z) {
                               return waves.at((x - 2) * direction[0] + (z - 2) * direction[1]);
                             }));
      // Light below the crest and the trough in the tank's middle, along their lines.
      const auto light_at = [&](double s) {
        double sum = 0, cells = 0;
        for (std::size_t k = 0; k < map.gathered.size(); ++k) {
          const Place from{place_of(map, k)[0] - 2, place_of(map, k)[1] - 2};
          if (std::abs(from[0] * direction[0] + from[1] * direction[1] - waves.ends(s)[0]) > 0.012) continue;
          if (std::abs(from[0] * direction[1] - from[1] * direction[0]) > 1) continue;
          sum += double{map.gathered[k]};
          ++cells;
        }
        return sum / cells / (1 - reflected());
      };
      const double half = std::numbers::pi / waves.number_per_m;
      const double crest = light_at(0), trough = light_at(half);
      EXPECT_GT(crest, 1.2);
      EXPECT_LT(trough, 0.9);
      // At a crest and a trough 1 / light differs from 1 by depth over focal length, with opposite signs.
      const double expected = waves.widening(half) - waves.widening(0);
      EXPECT_NEAR(1 / trough - 1 / crest, expected, 0.15 * expected) << depth << " " << direction[0];
    }
  }
}

TEST_F(FloorLightGl, AnObstaclesShadowLiesWhereTheSunPutsIt) {
  const auto scene = with_ball(tank({shadows}), 1, 0.4);
  const auto dry = dark_of(drawn(scene, {}));
  const double disc = std::numbers::pi * 0.4 * 0.4;
  EXPECT_NEAR(dry.middle[0], 2.2 - leans[0], 0.01);
  EXPECT_NEAR(dry.middle[1], 2.4 - leans[1], 0.01);
  EXPECT_NEAR(dry.area_m2, disc / sun[1], 0.02 * disc);
  // Refraction makes sunlight steeper below 2 m of water.
  const auto wet = dark_of(drawn(scene, flat_water(scene, 2)));
  EXPECT_NEAR(wet.middle[0], 2.2 - leans_in_water()[0], 0.02);
  EXPECT_NEAR(wet.middle[1], 2.4 - leans_in_water()[1], 0.02);
  EXPECT_NEAR(wet.area_m2, disc / -refracted({0, 1, 0})[1], 0.03 * disc);
}

TEST_F(FloorLightGl, CausticsGatherNoLightThatAnObstacleKeepsOff) {
  const auto scene = with_ball(tank({caustics}), 1, 0.4);
  const auto map = drawn(scene, {});
  double dark = 0;
  for (const float light : map.gathered) dark += 1 - double{light};
  const double disc = std::numbers::pi * 0.4 * 0.4;
  EXPECT_NEAR(dark * double{map.cell_m} * double{map.cell_m}, disc / sun[1], 0.03 * disc);
  // The shadow's edge is gradual, so that the cells of the surface map do not show as steps.
  const auto partly = std::count_if(map.gathered.begin(), map.gathered.end(),
                                    [](float light) { return light > 0.1F && light < 0.9F; });
  const double edge_cells = 2 * std::numbers::pi * 0.4 / double{map.cell_m};
  EXPECT_GT(static_cast<double>(partly), 2 * edge_cells) << "measured: 3.2 times, and 1.4 with steps";
}

TEST_F(FloorLightGl, WhatStandsOnTheFloorHasNoGapToItsShadow) {
  auto scene = tank({shadows});
  sim::Obstacle box;
  box.shape = sim::ObstacleShape::Box;
  box.size_m = {0.5, 0.5, 0.5};
  box.start.centre_m = {2, 0.25, 2};
  scene.obstacles = {box};
  const auto map = drawn(scene, {});
  // Dark below the box, lit on the sun's side; the borders may have one cell of penumbra.
  for (std::size_t k = 0; k < map.open.size(); ++k) {
    const auto [x, z] = place_of(map, k);
    if (x > 1.77 && x < 2.23 && z > 1.77 && z < 2.23) {
      ASSERT_EQ(map.open[k], 0) << x << " " << z;
    }
    if (x > 2.27 || z > 2.27) {
      ASSERT_EQ(map.open[k], 1) << x << " " << z;
    }
  }
}

TEST_F(FloorLightGl, ThePoolsDepthIsTheWayThroughIt) {
  for (const double depth : {0.6, 1.6}) {
    const auto map = drawn(tank({shadows}), flat_water(tank({}), depth));
    const double way = depth / -refracted({0, 1, 0})[1];
    for (std::size_t k = 0; k < map.way_m.size(); ++k) {
      ASSERT_NEAR(map.way_m[k], way, 0.1 * way);
      ASSERT_GT(map.open[k], 0.99);
    }
    EXPECT_NEAR(mean(map.way_m), way, 0.05 * way);
  }
}

TEST_F(FloorLightGl, AJetInTheAirHasAShadowAndAPoolHasNone) {
  auto jet = water(tank({}), 0.05,
                   [](double x, double z) { return std::hypot(x - 2.5, z - 2.5) < 0.2 ? 2.9 : 0.0; });
  std::erase_if(jet, [](const RenderParticle& p) { return p.y_m < 1.5F; });
  const auto dark = dark_of(drawn(tank({shadows}), jet));
  EXPECT_NEAR(dark.middle[0], 2.5 - 2.2 * leans[0], 0.05);
  EXPECT_NEAR(dark.middle[1], 2.5 - 2.2 * leans[1], 0.05);
  EXPECT_GT(dark.area_m2, 0.1);
  EXPECT_LT(dark.area_m2, 0.5);
}

TEST_F(FloorLightGl, ThePictureShowsIt) {
  const auto level = [&](const sim::View& view, const Place& place) {
    const auto& m = view.view;
    std::array<double, 3> eye{};
    for (std::size_t row = 0; row < 3; ++row)
      eye[row] = double{m[row]} * place[0] + double{m[8 + row]} * place[1] + double{m[12 + row]};
    const auto rays = sim::pixel_rays(view);
    const int x = static_cast<int>((eye[0] / -eye[2] - double{rays.offset_x}) / double{rays.scale_x});
    const int y = static_cast<int>((eye[1] / -eye[2] - double{rays.offset_y}) / double{rays.scale_y});
    return int{picture.rgba[4 * static_cast<std::size_t>(96 * (79 - y) + x)]};
  };
  const auto view = onto_the_floor();
  const Place middle{2.2 - 2 * leans[0], 2.4 - 2 * leans[1]};
  drawn(with_ball(tank({}), 2, 0.4), {});
  const int bright = level(view, middle), beside = level(view, {3.3, 1});
  drawn(with_ball(tank({shadows}), 2, 0.4), {});
  EXPECT_LT(level(view, middle), bright - 60);
  EXPECT_EQ(level(view, {3.3, 1}), beside);
  // Half the strength removes half the light.
  const int dark = level(view, middle);
  drawn(with_ball(tank({{PictureEffectKind::Shadows, 0.5}}), 2, 0.4), {});
  EXPECT_GT(level(view, middle), dark + 20);
  EXPECT_LT(level(view, middle), bright - 20);
}

TEST_F(FloorLightGl, BothEyesHaveOneFloor) {
  const auto scene = with_ball(tank({shadows, caustics}), 1, 0.4);
  const auto pool = flat_water(scene, 1);
  auto other = onto_the_floor();
  other.view[12] -= 0.064F;
  const auto one = drawn(scene, pool);
  const auto left = picture;
  const auto two = drawn(scene, pool, {onto_the_floor(), other});
  EXPECT_EQ(two.open, one.open);
  EXPECT_EQ(two.gathered, one.gathered);
  for (std::size_t row = 0; row < 80; ++row)
    ASSERT_TRUE(std::equal(&left.rgba[4 * 96 * row], &left.rgba[4 * 96 * row] + std::size_t{4} * 96,
                           &picture.rgba[8 * 96 * row]))
        << row;
}

TEST_F(FloorLightGl, OrderDoesNotMatter) {
  const auto scene = tank({shadows, caustics});
  auto pool =
      water(scene, 0.05, [](double x, double z) { return 1 + 0.1 * std::sin(4 * x) * std::cos(3 * z); });
  const auto map = drawn(scene, pool);
  const auto before = picture;
  std::shuffle(pool.begin(), pool.end(), std::mt19937(1));
  const auto other = drawn(scene, pool);
  EXPECT_EQ(other.gathered, map.gathered);
  EXPECT_EQ(other.open, map.open);
  EXPECT_EQ(picture.rgba, before.rgba);
}

TEST_F(FloorLightGl, WhoeverHasNoPlaceOrIsOutsideIsNobody) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto map =
      drawn(tank({shadows, caustics}),
            {{nan, 1, 1, 0.1F}, {1, 1, 1, 0}, {1, 1, 1, nan}, {9, 1, 1, 0.1F}, {1, -1, 1, 0.1F}});
  for (std::size_t k = 0; k < map.open.size(); ++k) {
    ASSERT_EQ(map.open[k], 1);
    ASSERT_NEAR(map.gathered[k], 1, 1e-3);
  }
}

TEST_F(FloorLightGl, RefusesWhatItCannotDo) {
  for (const int cells : {63, 2049}) {
    sim::RenderOptions options;
    options.floor_cells = cells;
    EXPECT_THROW(sim::FluidRenderer(tank({}), options), base::Error);
  }
  EXPECT_THROW(sim::FluidRenderer(tank({{PictureEffectKind::Shadows, 1.5}})), base::Error);
  EXPECT_THROW(sim::FluidRenderer(tank({shadows, shadows})), base::Error);
  EXPECT_THROW(sim::FluidRenderer(tank({})).read_floor(), base::Error);
  EXPECT_THROW(sim::FluidRenderer(tank({shadows})).read_floor(), base::Error);
}

}  // namespace
