#include <random>

#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using sim::RenderParticle;

/// Water in the tank of the fixture: lattice spheres that reach through the floor and two walls.
std::vector<RenderParticle> water() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> shift(-0.05F, 0.05F);
  std::vector<RenderParticle> particles;
  for (int i = 0; i < 10 * 6 * 20; ++i) {
    const auto x = static_cast<float>(i % 10), y = static_cast<float>(i / 10 % 6),
               z = static_cast<float>(i / 60);
    particles.push_back({0.4F * x + 0.2F + shift(random), 0.4F * y + 0.2F + shift(random),
                         0.4F * z + 0.2F + shift(random), 0.2F});
  }
  return particles;
}

/// A view from outside the tank, over its left wall towards its floor.
sim::View overview(int width, int height) {
  sim::Camera camera;
  camera.eye_m = {-5, 3, 13};
  camera.target_m = {3, 1, 4};
  camera.vertical_fov_deg = 50;
  return sim::make_view(camera, width, height);
}

/// World position at one eye depth along the ray of a pixel: to_world * (slope depth, -depth).
std::array<double, 3> point(const sim::View& view, int x, int y, double depth) {
  const auto rays = sim::pixel_rays(view);
  const auto world = sim::rigid_inverse(view.view);
  const double eye[3] = {depth * ((x + 0.5) * rays.scale_x + rays.offset_x),
                         depth * ((y + 0.5) * rays.scale_y + rays.offset_y), -depth};
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = world[k] * eye[0] + world[4 + k] * eye[1] + world[8 + k] * eye[2] + world[12 + k];
  return out;
}

struct Span {
  double from, to;
};

/// Depths at which a ray is within low..high on every axis.
Span within(const std::array<double, 3>& start, const std::array<double, 3>& at_one, const double* low,
            const double* high) {
  Span span{-1e9, 1e9};
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = at_one[k] - start[k];
    const double a = (low[k] - start[k]) / step, b = (high[k] - start[k]) / step;
    span = {std::max(span.from, std::min(a, b)), std::min(span.to, std::max(a, b))};
  }
  return span;
}

/// The fixture's tank, open above.
constexpr double low[3] = {0, 0, 0}, high[3] = {8, 1e6, 8};

/// Nearest depth of all spheres between the walls, in doubles and in world coordinates.
double front(const std::vector<RenderParticle>& particles, double scale, const std::array<double, 3>& start,
             const std::array<double, 3>& at_one) {
  const Span tank = within(start, at_one, low, high);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& p : particles) {
    const double centre[3] = {p.x_m, p.y_m, p.z_m};
    double dd = 0, dc = 0, cc = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = at_one[k] - start[k], c = centre[k] - start[k];
      dd += d * d;
      dc += d * c;
      cc += c * c;
    }
    const double discriminant = dc * dc - dd * (cc - scale * scale * p.radius_m * p.radius_m);
    if (discriminant <= 0) continue;
    const double entry = std::max((dc - std::sqrt(discriminant)) / dd, tank.from);
    const double leave = std::min((dc + std::sqrt(discriminant)) / dd, tank.to);
    if (entry < leave) nearest = std::min(nearest, entry);
  }
  return nearest;
}

class ClipGl : public render_test::RenderGl {};

TEST_F(ClipGl, DepthStaysInTheTank) {
  const auto view = overview(200, 150);
  const auto g = render(water(), view, {});
  std::size_t fluid = 0, at_glass = 0;
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 200; ++x) {
      const auto at = static_cast<std::size_t>(200 * y + x);
      if (!std::isfinite(g.depth[at])) continue;
      ++fluid;
      for (const double depth : {g.depth[at], g.filtered_depth[at]}) {
        const auto p = point(view, x, y, depth);
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_GT(p[k], low[k] - 1e-4) << x << ", " << y;
          EXPECT_LT(p[k], high[k] + 1e-4) << x << ", " << y;
        }
        at_glass += p[0] < 1e-3 || p[2] > 8 - 1e-3;
      }
    }
  }
  EXPECT_GT(fluid, 5000u);
  EXPECT_GT(at_glass, fluid / 2);
}

TEST_F(ClipGl, DepthIsThatOfTheSpheresCutByTheWalls) {
  const auto view = overview(120, 90);
  auto particles = water();
  particles.resize(particles.size() / 2);  // gaps to look through
  const auto g = render(particles, view, {});
  std::size_t fluid = 0, wrong = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const auto start = point(view, x, y, 0), at_one = point(view, x, y, 1);
      const double depth = g.depth[static_cast<std::size_t>(120 * y + x)];
      const double least = front(particles, 1.5 + 1e-5, start, at_one);
      const double most = front(particles, 1.5 - 1e-5, start, at_one);
      fluid += std::isfinite(least);
      // The two bounds differ at outlines and at walls seen at a grazing angle.
      if (depth > least - 1e-3 && (depth < most + 1e-3 || std::isinf(most))) continue;
      if (std::isinf(depth) && std::isinf(most)) continue;
      if (++wrong <= 8) {
        ADD_FAILURE() << "pixel (" << x << ", " << y << "): depth " << depth << ", expected " << least
                      << " to " << most;
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(fluid, 800u);
}

TEST_F(ClipGl, ParticlesBeyondTheWallsAreCountedAndShownOnDemand) {
  const std::vector<RenderParticle> leaked{
      {-1, 1, 4, 0.2F}, {4, -1, 4, 0.2F}, {4, 1, 9, 0.2F}, {4, 1, 4, 0.2F}};
  const auto fluid_pixels = [&](const sim::RenderOptions& options) {
    const auto g = render(leaked, overview(100, 80), options);
    return std::count_if(g.depth.begin(), g.depth.end(), [](float d) { return std::isfinite(d); });
  };
  const auto clipped = fluid_pixels({});
  EXPECT_EQ(counts.beyond_walls, 3u);
  EXPECT_EQ(counts.by_thread, 1u);
  EXPECT_GT(clipped, 0);
  const auto open = fluid_pixels(render_test::open_options());
  EXPECT_EQ(counts.beyond_walls, 0u);
  EXPECT_GT(open, 2 * clipped);
}

TEST_F(ClipGl, ALidCutsLikeAWall) {
  sim::Scene scene = room();
  scene.tank_size_m[1] = 2.3;  // through the spheres of the uppermost layer
  const auto view = overview(120, 90);
  sim::ParticleBuffer buffer;
  auto particles = water();
  particles.push_back({4, 3, 4, 0.2F});
  buffer.upload(particles);
  const sim::Offscreen target(120, 90);
  const auto highest = [&](bool lid) {
    scene.lid = lid;
    sim::FluidRenderer renderer(scene, {});
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    EXPECT_EQ(renderer.counts().beyond_walls, lid ? 1u : 0u);
    const auto g = renderer.read_gbuffer();
    double out = 0;
    for (int pixel = 0; pixel < 120 * 90; ++pixel) {
      const double depth = g.depth[static_cast<std::size_t>(pixel)];
      if (std::isfinite(depth)) out = std::max(out, point(view, pixel % 120, pixel / 120, depth)[1]);
    }
    return out;
  };
  EXPECT_GT(highest(false), 3);
  EXPECT_NEAR(highest(true), 2.3, 1e-3);
}

TEST_F(ClipGl, EverySplitCutsAlike) {
  const auto view = overview(160, 120);
  sim::RenderOptions options;
  options.thread_px = 1000;
  options.group_px = 1000;
  const auto by_thread = render(water(), view, options);
  options.thread_px = 1;
  options.group_px = 8;
  const auto split = render(water(), view, options);
  EXPECT_GT(counts.by_tiles, 100u);
  EXPECT_EQ(counts.front_missing, 0u);
  render_test::expect_same_bits(by_thread, split);
}

}  // namespace
