#pragma once
/// Shared by the renderer's tests: a context, a camera at the origin that looks along -z, and a brute-force
/// splat on the CPU.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/render/fluid_renderer.hpp"

namespace render_test {

/// Chord of a ray through a sphere, in eye depth, cut at the near plane.
struct Chord {
  double entry, leave, length_m, distance_m;
};

/// The chord of the ray with these slopes (x right, y up, depth along the view) through a particle; in
/// doubles, by the quadratic formula.
inline std::optional<Chord> chord(const sim::RenderParticle& p, double radius, double slope_x, double slope_y,
                                  double near_m) {
  const double x = p.x_m, y = p.y_m, z = -double{p.z_m};
  const double dd = slope_x * slope_x + slope_y * slope_y + 1, dc = slope_x * x + slope_y * y + z;
  const double discriminant = dc * dc - dd * (x * x + y * y + z * z - radius * radius);
  if (!(discriminant > 0)) return std::nullopt;
  const double entry = std::max((dc - std::sqrt(discriminant)) / dd, near_m);
  const double leave = (dc + std::sqrt(discriminant)) / dd;
  if (leave <= near_m) return std::nullopt;
  const double distance = std::sqrt(std::max(0.0, x * x + y * y + z * z - dc * dc / dd));
  return Chord{entry, leave, (leave - entry) * std::sqrt(dd), distance};
}

/// Rounding moves an outline by about a millionth of a radius; this tolerance is a hundred times larger.
constexpr double rim_px = 1e-3;

inline std::optional<Chord> chord_at(const sim::RenderParticle& p, const sim::View& view, std::size_t pixel) {
  const auto rays = sim::pixel_rays(view);
  const auto width = static_cast<std::size_t>(view.viewport.width);
  return chord(p, p.radius_m, (static_cast<double>(pixel % width) + 0.5) * rays.scale_x + rays.offset_x,
               (static_cast<double>(pixel / width) + 0.5) * rays.scale_y + rays.offset_y, view.near_m);
}

struct Reference {
  std::vector<double> depth, thickness;
  std::vector<std::uint32_t> front;
  std::vector<bool> rim;  ///< a sphere's outline passes within rim_px of the pixel's centre
};

inline Reference splat(const std::vector<sim::RenderParticle>& particles, const sim::View& view,
                       double scale) {
  const int width = view.viewport.width, height = view.viewport.height;
  const auto pixels = static_cast<std::size_t>(width * height);
  const auto rays = sim::pixel_rays(view);
  Reference reference{
      std::vector<double>(pixels, std::numeric_limits<double>::infinity()), std::vector<double>(pixels, 0),
      std::vector<std::uint32_t>(pixels, sim::GBuffer::no_particle), std::vector<bool>(pixels, false)};
  for (std::size_t at = 0; at < pixels; ++at) {
    const double px = static_cast<double>(at % static_cast<std::size_t>(width)) + 0.5;
    const double py = static_cast<double>(at / static_cast<std::size_t>(width)) + 0.5;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double radius = scale * particles[i].radius_m;
      const double sx = px * rays.scale_x + rays.offset_x, sy = py * rays.scale_y + rays.offset_y;
      const double rim = rim_px * rays.scale_x * std::max(-double{particles[i].z_m}, view.near_m);
      if (chord(particles[i], radius + rim, sx, sy, view.near_m) &&
          !chord(particles[i], radius - rim, sx, sy, view.near_m)) {
        reference.rim[at] = true;
      }
      const auto hit = chord(particles[i], radius, sx, sy, view.near_m);
      if (!hit) continue;
      reference.thickness[at] += hit->length_m;
      if (hit->entry < reference.depth[at]) {
        reference.depth[at] = hit->entry;
        reference.front[at] = static_cast<std::uint32_t>(i);
      }
    }
  }
  return reference;
}

/// The default options without clipping to the tank, because the camera of these tests is in a corner of the
/// tank.
inline sim::RenderOptions open_options() {
  sim::RenderOptions options;
  options.clip_to_tank = false;
  return options;
}

/// Splats with the particles' own radius and thickness at every pixel.
inline sim::RenderOptions exact_options() {
  sim::RenderOptions options = open_options();
  options.radius_scale = 1;
  options.thickness_step = 1;
  return options;
}

inline sim::View view_along_z(int width, int height) {
  sim::Camera camera;
  camera.eye_m = {0, 0, 0};
  camera.target_m = {0, 0, -1};
  camera.vertical_fov_deg = 60;
  return sim::make_view(camera, width, height);
}

class RenderGl : public ::testing::Test {
 protected:
  static sim::Scene room() {
    sim::Scene scene;
    scene.tank_size_m = {8, 4, 8};
    return scene;
  }

  /// Draws once and returns the picture.
  sim::GBuffer render(const std::vector<sim::RenderParticle>& particles, const sim::View& view,
                      const sim::RenderOptions& options = exact_options()) {
    sim::FluidRenderer renderer(room(), options);
    sim::ParticleBuffer buffer;
    buffer.upload(particles);
    const sim::Offscreen target(view.viewport.x + view.viewport.width,
                                view.viewport.y + view.viewport.height);
    renderer.draw(buffer, {&view, 1}, target.framebuffer());
    image = target.read();
    counts = renderer.counts();
    return renderer.read_gbuffer();
  }

  sim::GlContext context = sim::GlContext::make_headless();
  sim::Image image;
  sim::RenderCounts counts;
};

inline void expect_same_bits(const sim::GBuffer& a, const sim::GBuffer& b) {
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.filtered_depth, b.filtered_depth);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.thickness, b.thickness);
  EXPECT_EQ(a.front, b.front);
  EXPECT_EQ(a.radius, b.radius);
}

}  // namespace render_test
