#include <random>

#include "stats/base/error.hpp"
#include "tests/libsim/render/scene_fixture.hpp"

namespace {

using render_test::open_options;
using render_test::view_along_z;
using sim::RenderParticle;

class PictureGl : public render_test::RenderGl {};

/// A square lattice of touching spheres in the plane through (0, 0, -depth) that is turned about y.
std::vector<RenderParticle> sheet(float depth, float radius, float turned_rad, float half_width) {
  std::vector<RenderParticle> particles;
  for (float u = -half_width; u <= half_width; u += 2 * radius) {
    for (float v = -half_width; v <= half_width; v += 2 * radius) {
      particles.push_back({u * std::cos(turned_rad), v, -depth + u * std::sin(turned_rad), radius});
    }
  }
  return particles;
}

double angle_deg(const float* n, double x, double y, double z) {
  const double dot = n[0] * x + n[1] * y + n[2] * z;
  return std::acos(std::clamp(dot, -1.0, 1.0)) * 180 / 3.14159265358979;
}

TEST_F(PictureGl, FlatSheetHasFlatDepthAndNormals) {
  const auto g = render(sheet(4, 0.05F, 0, 1.6F), view_along_z(160, 120), open_options());
  float lowest = 1e9F, highest = 0;
  for (int y = 35; y < 85; ++y) {
    for (int x = 55; x < 105; ++x) {
      const auto at = static_cast<std::size_t>(160 * y + x);
      lowest = std::min(lowest, g.filtered_depth[at]);
      highest = std::max(highest, g.filtered_depth[at]);
      EXPECT_LT(angle_deg(&g.normal[3 * at], 0, 0, 1), 1) << x << ", " << y;
    }
  }
  EXPECT_LT(highest - lowest, 0.05 * 0.05);  // a twentieth of a radius
  EXPECT_GT(lowest, 4 - 1.5 * 0.05);
  EXPECT_LT(highest, 4);
}

TEST_F(PictureGl, TurnedSheetHasItsNormal) {
  const float turned = 0.5F;
  const auto g = render(sheet(4, 0.05F, turned, 1.6F), view_along_z(160, 120), open_options());
  double sum = 0;
  for (int y = 40; y < 80; ++y) {
    for (int x = 60; x < 100; ++x) {
      const auto at = static_cast<std::size_t>(160 * y + x);
      sum += angle_deg(&g.normal[3 * at], -std::sin(turned), 0, std::cos(turned));
    }
  }
  EXPECT_LT(sum / 1600, 1);
}

TEST_F(PictureGl, FilterKeepsAStepThatIsWiderThanItsRange) {
  auto particles = sheet(6, 0.05F, 0, 3);
  for (const auto& p : sheet(4, 0.05F, 0, 0.8F)) particles.push_back(p);
  const auto g = render(particles, view_along_z(160, 120), open_options());
  for (std::size_t p = 0; p < g.depth.size(); ++p) {
    if (!std::isfinite(g.depth[p])) continue;
    // No depth lies between the two sheets.
    const double z = g.filtered_depth[p];
    EXPECT_TRUE((z > 3.9 && z < 4.1) || (z > 5.9 && z < 6.1)) << z;
  }
}

TEST_F(PictureGl, FilterLeavesTheFluidsOutlineAlone) {
  const auto g = render(sheet(4, 0.05F, 0.3F, 0.5F), view_along_z(160, 120), open_options());
  for (std::size_t p = 0; p < g.depth.size(); ++p) {
    EXPECT_EQ(std::isfinite(g.depth[p]), std::isfinite(g.filtered_depth[p]));
    const float* n = &g.normal[3 * p];
    EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], std::isfinite(g.depth[p]) ? 1 : 0, 1e-4);
  }
}

/// A jittered slope up to a crest of columns of unequal height, against the sky.
std::vector<RenderParticle> crest() {
  constexpr float radius = 0.1F;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> shift(-0.6F * radius, 0.6F * radius);
  std::vector<RenderParticle> out;
  for (int layer = 0; layer < 3; ++layer) {
    const float down = 0.5F * radius * static_cast<float>(layer), back = 4 * down;
    for (float x = -4; x <= 4; x += 2 * radius) {
      for (float s = 0; s <= 2; s += 2 * radius) {
        const float dx = shift(random), dy = shift(random), dz = shift(random);
        out.push_back({x + dx, -1 + 1.2F * s - down + dy, -3 - s - back + dz, radius});
      }
    }
  }
  for (float x = -4; x <= 4; x += 6 * radius) {
    const auto high = static_cast<int>(random() % 7);
    for (int k = 0; k < high; ++k) {
      const float y = 1.4F + 1.6F * radius * static_cast<float>(k), z = -5 - radius * static_cast<float>(k);
      for (int side = 0; side < 3; ++side)
        out.push_back({x + 2 * radius * static_cast<float>(side), y, z, radius});
    }
  }
  return out;
}

/// Difference between the normals of columns of pixels that are four pixels apart, averaged over 24 rows:
/// root mean square.
double streaks(const sim::GBuffer& g) {
  constexpr int rows = 24;
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + rows < g.height; y += 2) {
    for (int x = 2; x + 2 < g.width; ++x) {
      double step = 0;
      bool fluid = true;
      for (int k = 0; k < rows; ++k) {
        const auto left = static_cast<std::size_t>((y + k) * g.width + x - 2), right = left + 4;
        fluid = fluid && std::isfinite(g.depth[left]) && std::isfinite(g.depth[right]);
        step += double{g.normal[3 * right]} - double{g.normal[3 * left]};
      }
      if (!fluid) continue;
      sum += step * step / (rows * rows);
      ++windows;
    }
  }
  return std::sqrt(sum / windows);
}

TEST_F(PictureGl, TwoRoundsOfTheFilterLeaveFewerStreaksBelowACrest) {
  auto once = open_options();
  once.filter_rounds = 1;
  once.filter_sigma_r = std::sqrt(2.0F) * open_options().filter_sigma_r;  // the same smoothing in one round
  const double by_one = streaks(render(crest(), view_along_z(320, 240), once));
  const double by_two = streaks(render(crest(), view_along_z(320, 240), open_options()));
  EXPECT_LT(by_two, 0.87 * by_one) << by_one;  // measured: 0.77
}

TEST_F(PictureGl, CappedFilterIsCounted) {
  auto options = open_options();
  options.filter_max_px = 4;
  render(sheet(4, 0.2F, 0, 1), view_along_z(160, 120), options);
  EXPECT_GT(counts.filter_capped, 100u);
  render(sheet(4, 0.2F, 0, 1), view_along_z(160, 120), open_options());
  EXPECT_EQ(counts.filter_capped, 0u);
}

TEST_F(PictureGl, WaterChangesThePictureOnlyWhereItIs) {
  const auto view = view_along_z(120, 80);
  render({}, view);
  const auto room_only = image;
  const auto g = render(sheet(4, 0.1F, 0, 1), view);
  std::size_t changed = 0, fluid = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const auto at = static_cast<std::size_t>(120 * y + x),
                 top = static_cast<std::size_t>(120 * (79 - y) + x);
      const bool same = std::equal(&image.rgba[4 * top], &image.rgba[4 * top] + 4, &room_only.rgba[4 * top]);
      if (std::isfinite(g.depth[at])) {
        ++fluid;
        changed += !same;
        continue;
      }
      // A smooth outline reaches into the pixels beside it.
      const auto is_fluid = [&](int to_x, int to_y) {
        return std::isfinite(
            g.depth[static_cast<std::size_t>(120 * std::clamp(to_y, 0, 79) + std::clamp(to_x, 0, 119))]);
      };
      const bool beside =
          is_fluid(x - 1, y) || is_fluid(x + 1, y) || is_fluid(x, y - 1) || is_fluid(x, y + 1);
      EXPECT_TRUE(same || beside) << x << ", " << y;
    }
  }
  EXPECT_GT(fluid, 1000u);
  EXPECT_GT(changed, fluid / 2);
}

TEST_F(PictureGl, TwoViewsAreThoseOfEachEyeAlone) {
  auto particles = sheet(4, 0.1F, 0.4F, 1);
  auto left = view_along_z(90, 70), right = view_along_z(90, 70);
  right.view[12] -= 0.064F;
  right.projection[8] = 0.1F;  // off-centre, as a headset's
  const auto left_alone = render(particles, left, open_options());
  const auto left_image = image;
  const auto right_alone = render(particles, right, open_options());
  const auto right_image = image;

  right.viewport.x = 100;
  right.viewport.y = 5;
  sim::FluidRenderer renderer(room(), open_options());
  sim::ParticleBuffer buffer;
  buffer.upload(particles);
  const sim::Offscreen target(200, 80);
  const std::array<sim::View, 2> views{left, right};
  renderer.draw(buffer, views, target.framebuffer());
  const auto both = target.read();
  render_test::expect_same_bits(left_alone, renderer.read_gbuffer(0));
  render_test::expect_same_bits(right_alone, renderer.read_gbuffer(1));
  const auto pixel = [](const sim::Image& i, int x, int row) {
    return &i.rgba[4 * static_cast<std::size_t>(i.width * row + x)];
  };
  for (int row = 0; row < 70; ++row) {
    EXPECT_TRUE(
        std::equal(pixel(left_image, 0, row), pixel(left_image, 0, row) + 360, pixel(both, 0, row + 10)));
    EXPECT_TRUE(
        std::equal(pixel(right_image, 0, row), pixel(right_image, 0, row) + 360, pixel(both, 100, row + 5)));
  }
  EXPECT_EQ(pixel(both, 95, 40)[3], 0);  // between the eyes nothing is drawn
}

TEST_F(PictureGl, BadRequestsAreErrors) {
  sim::RenderOptions options = open_options();
  options.thickness_step = 3;
  EXPECT_THROW(sim::FluidRenderer(room(), options), base::Error);
  options = open_options();
  options.radius_scale = 0;
  EXPECT_THROW(sim::FluidRenderer(room(), options), base::Error);
  sim::FluidRenderer renderer(room());
  EXPECT_THROW(renderer.read_gbuffer(0), base::Error);
  const sim::ParticleBuffer none;
  EXPECT_THROW(renderer.draw(none, {}, 0), base::Error);
  const sim::View empty;
  EXPECT_THROW(renderer.draw(none, {&empty, 1}, 0), base::Error);
}

TEST_F(PictureGl, PassTimesAreKeptOnDemand) {
  sim::RenderOptions options = open_options();
  const auto view = view_along_z(32, 32);
  sim::ParticleBuffer buffer;
  buffer.upload(sheet(4, 0.1F, 0, 1));
  const sim::Offscreen target(32, 32);
  sim::FluidRenderer silent(room(), options);
  silent.draw(buffer, {&view, 1}, target.framebuffer());
  EXPECT_TRUE(silent.times().empty());
  options.time_passes = true;
  sim::FluidRenderer timed(room(), options);
  const std::array<sim::View, 2> views{view, view};
  timed.draw(buffer, views, target.framebuffer());
  const auto times = timed.times();
  ASSERT_GE(times.size(), 6u);
  EXPECT_EQ(times.front().pass, "clear");
  EXPECT_EQ(times.back().pass, "edges");
  for (const auto& time : times) EXPECT_GE(time.ms, 0);
}

}  // namespace
