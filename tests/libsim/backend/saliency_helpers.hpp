#pragma once
/// Shared by the tests of saliency: pictures in closed form or splatted on the host, and fluids at rest or in
/// motion with their neighbours and densities.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "libsim/saliency/saliency.hpp"
#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND::saliency_test {

inline View view_of(const Vec3d& eye, const Vec3d& target, int width, int height) {
  Camera camera;
  camera.eye_m = eye;
  camera.target_m = target;
  camera.vertical_fov_deg = 60;
  return make_view(camera, width, height);
}
/// From the origin along -z: a point at depth z on the axis is (0, 0, -z).
inline View view_along_z(int width, int height) { return view_of({0, 0, 0}, {0, 0, -1}, width, height); }

/// Depth (m) and unit normal of the surface along the ray with these slopes.
struct Hit {
  double depth;
  Vec3d normal;
};
using Surface = std::function<std::optional<Hit>(double, double)>;

inline GBuffer picture_of(const View& view, const Surface& surface) {
  GBuffer g;
  g.width = view.viewport.width;
  g.height = view.viewport.height;
  g.view = view;
  const PixelRays rays = pixel_rays(view);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const auto hit =
          surface((x + 0.5) * static_cast<double>(rays.scale_x) + static_cast<double>(rays.offset_x),
                  (y + 0.5) * static_cast<double>(rays.scale_y) + static_cast<double>(rays.offset_y));
      g.depth.push_back(hit ? static_cast<float>(hit->depth) : std::numeric_limits<float>::infinity());
      for (std::size_t k = 0; k < 3; ++k) g.normal.push_back(hit ? static_cast<float>(hit->normal[k]) : 0);
    }
  }
  return g;
}

inline Surface plane(double depth) {
  return [=](double, double) { return Hit{depth, {0, 0, 1}}; };
}
inline Surface nothing() {
  return [](double, double) { return std::nullopt; };
}
/// A ball on the line of sight.
inline Surface ball(double centre_depth, double radius) {
  return [=](double sx, double sy) -> std::optional<Hit> {
    const double a = sx * sx + sy * sy + 1;
    const double root = centre_depth * centre_depth - a * (centre_depth * centre_depth - radius * radius);
    if (root < 0) return std::nullopt;
    const double z = (centre_depth - std::sqrt(root)) / a;
    return Hit{z, {sx * z / radius, sy * z / radius, (centre_depth - z) / radius}};
  };
}

/// Front of spheres of radius_scale x their radius, then a depth filter that stays within two layers, then
/// normals by differences: a plain version of what the renderer does.
inline GBuffer splat(const std::vector<Vec4>& points, const View& view, float radius_scale) {
  GBuffer g = picture_of(view, nothing());
  g.radius_scale = radius_scale;
  const PixelRays rays = pixel_rays(view);
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * g.width + x); };
  const auto slope_x = [&](int x) { return (static_cast<float>(x) + 0.5f) * rays.scale_x + rays.offset_x; };
  const auto slope_y = [&](int y) { return (static_cast<float>(y) + 0.5f) * rays.scale_y + rays.offset_y; };
  float largest = 0;
  for (const Vec4& p : points) {
    const float r = radius_scale * 0.25f * p.w;
    largest = std::max(largest, r);
    const Mat4& m = view.view;
    const float ex = m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12];
    const float ey = m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13];
    const float z = -(m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]);
    if (z <= 1.5f * r) continue;
    const float reach = r / (z - r);
    const auto column = [&](float slope) {
      return std::clamp(static_cast<int>((slope - rays.offset_x) / rays.scale_x), 0, g.width - 1);
    };
    const auto row = [&](float slope) {
      return std::clamp(static_cast<int>((slope - rays.offset_y) / rays.scale_y), 0, g.height - 1);
    };
    for (int y = row(ey / z - reach); y <= row(ey / z + reach); ++y) {
      for (int x = column(ex / z - reach); x <= column(ex / z + reach); ++x) {
        const float sx = slope_x(x), sy = slope_y(y);
        const float dd = sx * sx + sy * sy + 1, dc = sx * ex + sy * ey + z;
        const float root = dc * dc - dd * (ex * ex + ey * ey + z * z - r * r);
        if (root > 0) g.depth[at(x, y)] = std::min(g.depth[at(x, y)], (dc - std::sqrt(root)) / dd);
      }
    }
  }
  std::vector<float> smooth = g.depth;
  const float range = 2 * largest;
  for (int round = 0; round < 8; ++round) {
    const std::vector<float> from = smooth;
    for (int y = 1; y + 1 < g.height; ++y) {
      for (int x = 1; x + 1 < g.width; ++x) {
        const float own = from[at(x, y)];
        if (!std::isfinite(own)) continue;
        float sum = 0;
        for (int k = 0; k < 9; ++k) {
          const float other = from[at(x + k % 3 - 1, y + k / 3 - 1)];
          sum += std::isfinite(other) ? std::clamp(other, own - range, own + range) : own;
        }
        smooth[at(x, y)] = sum / 9;
      }
    }
  }
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const float own = smooth[at(x, y)];
      if (!std::isfinite(own)) continue;
      const auto slope_of = [&](float before, float after) {
        const float back = std::isfinite(before) ? own - before : 0,
                    on = std::isfinite(after) ? after - own : 0;
        return std::abs(back) < std::abs(on) ? back : on;
      };
      const float dzx = x > 0 && x + 1 < g.width ? slope_of(smooth[at(x - 1, y)], smooth[at(x + 1, y)]) : 0;
      const float dzy = y > 0 && y + 1 < g.height ? slope_of(smooth[at(x, y - 1)], smooth[at(x, y + 1)]) : 0;
      // z(x, y) towards the viewer is -depth; a pixel is own * scale wide.
      const float nx = dzx / (own * rays.scale_x), ny = dzy / (own * rays.scale_y);
      const float size = std::sqrt(nx * nx + ny * ny + 1);
      const float normal[3] = {nx / size, ny / size, 1 / size};
      std::copy_n(normal, 3, &g.normal[3 * at(x, y)]);
    }
  }
  return g;
}

/// A fluid with its neighbours and densities, ready for saliency.
struct Fluid {
  FluidState state;
  SaliencyState saliency;
  Array<float> s;
  Array<std::uint8_t> target;
  Array<SaliencyParts> parts;

  SaliencyFluid view() {
    auto& p = state.particles;
    return {p.all().position.data(),
            p.all().velocity.data(),
            p.all().density.data(),
            p.all().level.data(),
            state.particle_neighbours(),
            p.size(),
            state.finest_support,
            state.parameters.gravity.strength,
            nullptr,
            {},
            s.data(),
            target.data(),
            parts.data(),
            state.guard()};
  }
  std::vector<int> levels() const {
    const auto values = target.to_host();
    return {values.begin(), values.end()};
  }
  std::vector<Vec4> points() const { return state.particles.all().position.to_host(); }
};

/// Sorts the particles into the grid, lists neighbours and measures densities. h = points[i].w.
inline Fluid fluid_of(const std::vector<Vec4>& points, const std::vector<Vec4>& velocity, const Walls& walls,
                      float finest_support) {
  Fluid out;
  auto& state = out.state;
  state.walls = walls;
  state.finest_support = finest_support;
  state.lightest_support = finest_support;
  state.supports = level_supports(static_cast<double>(finest_support));
  state.one_level =
      std::all_of(points.begin(), points.end(), [&](const Vec4& p) { return p.w == finest_support; });
  state.guards.resize(1);
  state.guards.zero();
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(points.size()));
  p.all().position.from_host(points);
  p.all().predicted.from_host(points);
  p.all().velocity.from_host(velocity);
  std::vector<int> id(points.size());
  std::vector<std::uint8_t> level(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    id[i] = static_cast<int>(i);
    level[i] = static_cast<std::uint8_t>(std::lround(3 * std::log2(points[i].w / finest_support)));
  }
  p.all().id.from_host(id);
  p.all().level.from_host(level);
  neighbours_stage().run(state);
  density_stage().run(state);
  out.s.resize(points.size());
  out.s.zero();
  out.target.resize(points.size());
  out.target.zero();
  out.parts.resize(points.size());
  return out;
}

/// Rank correlation with ties at their mean rank.
inline double spearman(const std::vector<int>& a, const std::vector<int>& b) {
  const auto ranks = [](const std::vector<int>& values) {
    std::vector<int> count(256, 0);
    for (const int v : values) ++count[static_cast<std::size_t>(v)];
    std::vector<double> rank(256, 0), out;
    double before = 0;
    for (std::size_t v = 0; v < 256; ++v) {
      rank[v] = before + (count[v] - 1) / 2.0;
      before += count[v];
    }
    for (const int v : values) out.push_back(rank[static_cast<std::size_t>(v)]);
    return out;
  };
  const auto x = ranks(a), y = ranks(b);
  const double middle = (static_cast<double>(a.size()) - 1) / 2;
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - middle) * (y[i] - middle);
    xx += (x[i] - middle) * (x[i] - middle);
    yy += (y[i] - middle) * (y[i] - middle);
  }
  return xy / std::sqrt(xx * yy);
}

}  // namespace sim::SIM_BACKEND::saliency_test
