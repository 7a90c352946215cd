/// Particles drawn as ellipsoids, against the quadratic formula in doubles and against spheres.
#include <cstring>
#include <random>

#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using sim::RenderParticle;
using sim::RenderShape;
using Matrix = std::array<double, 6>;  // xx, yy, zz, xy, xz, yz

RenderShape packed(const Matrix& m) {
  const auto scale = static_cast<float>(std::max({m[0], m[1], m[2]}));
  const auto half = [&](double x) {
    return static_cast<std::uint32_t>(std::lround(x / static_cast<double>(scale) * 32767)) & 0xffffU;
  };
  RenderShape out{};
  for (std::size_t k = 0; k < 3; ++k) out.word[k] = half(m[2 * k]) | half(m[2 * k + 1]) << 16;
  std::memcpy(&out.word[3], &scale, sizeof scale);
  return out;
}

/// sum of (half axis)^2 (direction) (direction)^T over three random directions.
Matrix random_matrix(std::mt19937& random, double r) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> axis(0.5, 2);
  std::array<std::array<double, 3>, 3> v{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (double& x : v[k]) x = normal(random);
    for (std::size_t before = 0; before < k; ++before) {
      double along = 0;
      for (std::size_t a = 0; a < 3; ++a) along += v[k][a] * v[before][a];
      for (std::size_t a = 0; a < 3; ++a) v[k][a] -= along * v[before][a];
    }
    const double size = std::hypot(v[k][0], v[k][1], v[k][2]);
    for (double& x : v[k]) x /= size;
  }
  Matrix out{};
  for (const auto& u : v) {
    const double a = r * axis(random), square = a * a;
    const double terms[6] = {u[0] * u[0], u[1] * u[1], u[2] * u[2], u[0] * u[1], u[0] * u[2], u[1] * u[2]};
    for (std::size_t k = 0; k < 6; ++k) out[k] += square * terms[k];
  }
  return out;
}

/// Depth at which the ray (slope_x, slope_y, -1) meets the ellipsoid; none if it misses.
std::optional<double> depth_of(const RenderParticle& p, const Matrix& m, double slope_x, double slope_y) {
  const double det = m[0] * (m[1] * m[2] - m[5] * m[5]) - m[3] * (m[3] * m[2] - m[5] * m[4]) +
                     m[4] * (m[3] * m[5] - m[1] * m[4]);
  const Matrix inverse{(m[1] * m[2] - m[5] * m[5]) / det, (m[0] * m[2] - m[4] * m[4]) / det,
                       (m[0] * m[1] - m[3] * m[3]) / det, (m[4] * m[5] - m[3] * m[2]) / det,
                       (m[3] * m[5] - m[4] * m[1]) / det, (m[3] * m[4] - m[0] * m[5]) / det};
  const auto times = [&](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return inverse[0] * a[0] * b[0] + inverse[1] * a[1] * b[1] + inverse[2] * a[2] * b[2] +
           inverse[3] * (a[0] * b[1] + a[1] * b[0]) + inverse[4] * (a[0] * b[2] + a[2] * b[0]) +
           inverse[5] * (a[1] * b[2] + a[2] * b[1]);
  };
  const std::array<double, 3> way{slope_x, slope_y, -1}, to{p.x_m, p.y_m, p.z_m};
  const double a = times(way, way), b = times(way, to), c = times(to, to) - 1;
  if (b * b < a * c) return {};
  return (b - std::sqrt(b * b - a * c)) / a;
}

class Ellipsoid : public render_test::RenderGl {
 protected:
  sim::GBuffer draw(const std::vector<RenderParticle>& particles, const std::vector<RenderShape>& shapes,
                    const sim::View& view, const sim::RenderOptions& options = render_test::exact_options()) {
    sim::FluidRenderer renderer(room(), options);
    sim::ParticleBuffer buffer;
    buffer.upload(particles, shapes);
    const sim::Offscreen target(view.viewport.width, view.viewport.height);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    image = target.read();
    counts = renderer.counts();
    return renderer.read_gbuffer();
  }
};

/// Small, group and tile footprints, some cut by the picture's edge.
TEST_F(Ellipsoid, DepthIsThatOfTheQuadraticFormula) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> across(-2.5F, 2.5F), away(3, 9), size(0.3F, 0.8F);
  std::vector<RenderParticle> particles;
  std::vector<Matrix> matrices;
  std::vector<RenderShape> shapes;
  for (int i = 0; i < 60; ++i) {
    const float r = i % 10 == 0 ? size(random) : 0.08F;
    particles.push_back({across(random), across(random), -away(random), r});
    matrices.push_back(random_matrix(random, static_cast<double>(r)));
    shapes.push_back(packed(matrices.back()));
  }
  const sim::View view = render_test::view_along_z(200, 150);
  auto options = render_test::exact_options();
  for (const int thread_px : {0, 4}) {
    options.thread_px = thread_px;
    options.group_px = thread_px ? 16 : 128;
    const sim::GBuffer g = draw(particles, shapes, view, options);
    const auto rays = sim::pixel_rays(view);
    int wet = 0, wrong = 0;
    for (std::size_t at = 0; at < g.depth.size(); ++at) {
      const double sx = (static_cast<double>(at % 200) + 0.5) * static_cast<double>(rays.scale_x) +
                        static_cast<double>(rays.offset_x);
      const double sy = (static_cast<double>(at / 200) + 0.5) * static_cast<double>(rays.scale_y) +
                        static_cast<double>(rays.offset_y);
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < particles.size(); ++i) {
        const auto depth = depth_of(particles[i], matrices[i], sx, sy);
        if (depth) nearest = std::min(nearest, *depth);
      }
      const auto drawn = static_cast<double>(g.depth[at]);
      wet += std::isfinite(nearest);
      if (std::isfinite(nearest) != std::isfinite(drawn) ||
          (std::isfinite(drawn) && std::abs(drawn - nearest) > 2e-3))
        ++wrong;
    }
    EXPECT_GT(wet, 2000);
    EXPECT_LT(wrong, wet / 100) << "only at outlines, where 16 bits of the shape move a pixel";
    EXPECT_EQ(counts.front_missing, 0U);
    if (thread_px) {
      EXPECT_GT(counts.by_group, 0U);
      EXPECT_GT(counts.by_tiles, 0U);
    }
  }
}

/// With shapes that are spheres, the picture is that of spheres up to rounding.
TEST_F(Ellipsoid, RoundShapesAreSpheres) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> across(-0.2F, 0.2F), away(2, 6);
  std::vector<RenderParticle> particles;
  std::vector<RenderShape> shapes;
  for (int i = 0; i < 200; ++i) {
    particles.push_back({across(random), across(random), i % 20 == 0 ? -0.15F : -away(random), 0.1F});
    shapes.push_back(packed({0.01, 0.01, 0.01, 0, 0, 0}));
  }
  const sim::View view = render_test::view_along_z(160, 120);
  const sim::GBuffer spheres = render(particles, view);
  const sim::RenderCounts sphere_counts = counts;
  const sim::GBuffer drawn = draw(particles, shapes, view);
  int different = 0;
  for (std::size_t at = 0; at < drawn.depth.size(); ++at) {
    const bool same =
        drawn.depth[at] == spheres.depth[at] || std::abs(drawn.depth[at] - spheres.depth[at]) < 1e-3F;
    different += !same;
    if (same && std::isfinite(drawn.depth[at])) {
      EXPECT_NEAR(drawn.thickness[at], spheres.thickness[at], 0.02F + 0.01F * spheres.thickness[at]);
    }
  }
  EXPECT_LT(different, 20) << "pixels at outlines";
  EXPECT_EQ(counts.outside, sphere_counts.outside);
  EXPECT_EQ(counts.near_crossing, sphere_counts.near_crossing) << "some cross the near plane";
  EXPECT_GT(counts.near_crossing, 0U);
}

TEST_F(Ellipsoid, WallsCutThem) {
  // Half of the ellipsoid lies behind the wall x = 0.
  sim::RenderOptions options;
  options.radius_scale = 1;
  options.thickness_step = 1;
  const std::vector<RenderParticle> particles{{0, 2, 2, 0.5F}};
  sim::Camera camera;
  camera.eye_m = {0, 2, 7};
  camera.target_m = {0, 2, 0};
  const sim::View view = sim::make_view(camera, 101, 101);
  const sim::GBuffer g = draw(particles, {packed({1, 0.25, 0.25, 0, 0, 0})}, view, options);
  int left = 0, right = 0;
  for (std::size_t at = 0; at < g.depth.size(); ++at)
    if (std::isfinite(g.depth[at])) ++(at % 101 < 50 ? left : right);
  EXPECT_EQ(left, 0);
  EXPECT_GT(right, 50);
}

TEST_F(Ellipsoid, ThePictureRepeatsBitForBit) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> across(-2, 2);
  std::vector<RenderParticle> particles;
  std::vector<RenderShape> shapes;
  for (int i = 0; i < 500; ++i) {
    particles.push_back({across(random), across(random), -4 + across(random), 0.1F});
    shapes.push_back(packed(random_matrix(random, 0.1)));
  }
  const sim::View view = render_test::view_along_z(160, 120);
  const sim::GBuffer first = draw(particles, shapes, view);
  const auto picture = image.rgba;
  render_test::expect_same_bits(first, draw(particles, shapes, view));
  EXPECT_EQ(picture, image.rgba);
}

TEST_F(Ellipsoid, EachParticleNeedsAShape) {
  sim::ParticleBuffer buffer;
  const std::vector<RenderParticle> two(2, RenderParticle{0, 0, -3, 0.1F});
  const std::vector<RenderShape> one(1, packed({0.01, 0.01, 0.01, 0, 0, 0}));
  EXPECT_THROW(buffer.upload(two, one), base::Error);
  buffer.upload(two);
  EXPECT_EQ(buffer.shapes_name(), 0U) << "spheres";
}

TEST(Surface, HasTwoWords) {
  EXPECT_EQ(sim::parse_surface("ellipsoids"), sim::Surface::Ellipsoids);
  EXPECT_EQ(sim::parse_surface("spheres"), sim::Surface::Spheres);
  EXPECT_THROW(sim::parse_surface("blobs"), base::Error);
  EXPECT_EQ(sim::RenderOptions{}.surface, sim::Surface::Ellipsoids);
}

}  // namespace
