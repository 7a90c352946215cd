#include "libsim/measure/known_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "libsim/gl/offscreen.hpp"
#include "libsim/surface/host_surface.hpp"

namespace measure {

namespace {

using sim::Vec3d;
constexpr double finest_m = 0.05;  // spacing of level 0
constexpr double px_per_spacing = 32;
constexpr double far_away = 40;  // distance of the camera, in half sizes of the shape

double spacing_of(int level) { return finest_m * std::cbrt(static_cast<double>(1 << level)); }

/// A shape in a tank, and the box that holds it.
struct Body {
  KnownShape shape;
  Vec3d tank_m, low_m, high_m;
  double half_m;  ///< half its visible size

  double middle(std::size_t axis) const { return 0.5 * (low_m[axis] + high_m[axis]); }
};

Body body_of(KnownShape shape, std::int64_t n_star) {
  const double d3 = spacing_of(3);
  const double volume = static_cast<double>(n_star) * d3 * d3 * d3;
  Body out{};
  out.shape = shape;
  const auto centred = [&](double x, double y, double z) {
    const double room = 4 * std::max({x, y, z});
    out.tank_m = {room, room, room};
    const double half = room / 2;
    out.low_m = {half - x, half - y, half - z};
    out.high_m = {half + x, half + y, half + z};
    out.half_m = std::max({x, y, z});
  };
  if (shape == KnownShape::Pool) {
    const double depth = 4 * d3, side = std::sqrt(volume / depth);
    out.tank_m = {side, 3 * depth, side};
    out.high_m = {side, depth, side};
    out.half_m = side / 2;
  } else if (shape == KnownShape::Ball) {
    const double r = std::cbrt(3 * volume / (4 * std::numbers::pi));
    centred(r, r, r);
  } else if (shape == KnownShape::Column) {
    const double r = std::cbrt(volume / (4 * std::numbers::pi));  // as high as four radii
    centred(r, 2 * r, r);
  } else {
    const double thick = 3 * d3, side = std::sqrt(volume / thick);
    centred(side / 2, thick / 2, side / 2);
  }
  return out;
}

/// Lattices of one level in layers parallel to the surface, as water at rest has: planes, spheres round the
/// ball's centre, cylinders round the column's axis.
class Layers {
 public:
  Layers(const Body& body, int level, std::mt19937& random)
      : body_(body), d_(spacing_of(level)), random_(random) {
    const double r = body.high_m[0] - body.middle(0);
    if (body.shape == KnownShape::Ball) {
      for (const double shell : depths(r)) sphere(shell, r);
    } else if (body.shape == KnownShape::Column) {
      for (const double shell : depths(r)) cylinder(shell);
    } else {
      planes();
    }
  }
  std::vector<Vec3d> places;

 private:
  double chance() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  /// Middles of the layers of a body that is `whole` thick, from 0 on.
  std::vector<double> depths(double whole) const {
    std::vector<double> out;
    const double layers = std::max(1.0, std::round(whole / d_));
    for (int k = 0; k < layers; ++k) out.push_back((k + 0.5) * whole / layers);
    return out;
  }
  void planes() {
    const double x0 = body_.low_m[0] + chance() * d_, z0 = body_.low_m[2] + chance() * d_;
    for (const double y : depths(body_.high_m[1] - body_.low_m[1]))
      for (double x = x0; x < body_.high_m[0]; x += d_)
        for (double z = z0; z < body_.high_m[2]; z += d_) places.push_back({x, body_.low_m[1] + y, z});
  }
  void sphere(double r, double whole) {
    const double thick = whole / std::max(1.0, std::round(whole / d_));
    const int n =
        std::max(1, static_cast<int>(std::lround(4 * std::numbers::pi * r * r * thick / (d_ * d_ * d_))));
    const double phase = chance(), golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int k = 0; k < n; ++k) {
      const double up = 1 - (2 * k + 1.0) / n, across = std::sqrt(1 - up * up),
                   angle = golden * (k + phase * n);
      places.push_back({body_.middle(0) + r * up, body_.middle(1) + r * across * std::cos(angle),
                        body_.middle(2) + r * across * std::sin(angle)});
    }
  }
  void cylinder(double r) {
    const int round = std::max(1, static_cast<int>(std::lround(2 * std::numbers::pi * r / d_)));
    const double phase = chance();
    for (double y = body_.low_m[1] + chance() * d_; y < body_.high_m[1]; y += d_) {
      for (int k = 0; k < round; ++k) {
        const double angle = 2 * std::numbers::pi * (k + phase) / round;
        places.push_back({body_.middle(0) + r * std::cos(angle), y, body_.middle(2) + r * std::sin(angle)});
      }
    }
  }

  const Body& body_;
  double d_;
  std::mt19937& random_;
};

/// The particles of one level in the part of the body from `from` to `to` along x.
void fill(const Body& body, int level, double from, double to, std::mt19937& random,
          std::vector<sim::RenderParticle>& out) {
  const double d = spacing_of(level);
  std::uniform_real_distribution<double> chance(-0.1, 0.1);
  const Layers layers(body, level, random);
  for (const Vec3d& place : layers.places) {
    if (place[0] < from || place[0] >= to) continue;
    const auto moved = [&](std::size_t axis) { return static_cast<float>(place[axis] + d * chance(random)); };
    const float x = moved(0), y = moved(1), z = moved(2);
    out.push_back({x, y, z, static_cast<float>(d / 2)});
  }
}

std::vector<sim::RenderParticle> particles_of(const Body& body, int level) {
  std::mt19937 random(1);
  std::vector<sim::RenderParticle> out;
  const double wide = (body.high_m[0] - body.low_m[0]) / 4;
  for (int l = 0; l < 4; ++l) {
    if (level == mixed_levels)
      fill(body, l, body.low_m[0] + l * wide, body.low_m[0] + (l + 1) * wide, random, out);
    else if (level == l)
      fill(body, l, -1e9, 1e9, random, out);
  }
  return out;
}

/// Mean spacing, m: the cube root of the mean volume of a particle.
double spacing_of(const std::vector<sim::RenderParticle>& particles) {
  double volume = 0;
  for (const auto& p : particles) volume += std::pow(2 * static_cast<double>(p.radius_m), 3);
  return std::cbrt(volume / static_cast<double>(particles.size()));
}

/// A picture with its camera.
struct Taken {
  sim::View view;
  sim::PixelRays rays;
  sim::GBuffer seen;
  double distance_m;

  bool wet(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < seen.width && y < seen.height)) return false;
    return std::isfinite(seen.depth[at(static_cast<int>(x), static_cast<int>(y))]);
  }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * seen.width + x); }
  double slope_x(double x) const {
    return x * static_cast<double>(rays.scale_x) + static_cast<double>(rays.offset_x);
  }
  double slope_y(double y) const {
    return y * static_cast<double>(rays.scale_y) + static_cast<double>(rays.offset_y);
  }
  Vec3d normal(int x, int y) const {
    const float* n = &seen.normal[3 * at(x, y)];
    return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
  }
};

/// The last wet place, px, along a line from (x, y) in the direction (dx, dy), within `reach` px.
double edge_px(const Taken& taken, double x, double y, double dx, double dy, double reach) {
  constexpr double step = 0.125;
  double last = 0;
  for (double r = 0; r < reach; r += step)
    if (taken.wet(x + r * dx, y + r * dy)) last = r + step / 2;
  return last;
}

using Outline = std::vector<double>;  ///< distances from the closed form, m, at equal steps

double rms_of(const std::vector<Outline>& outlines) {
  double sum = 0;
  std::size_t count = 0;
  for (const Outline& one : outlines) {
    for (const double e : one) sum += e * e;
    count += one.size();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Adds up squares of angles.
struct Angles {
  double sum = 0;
  std::size_t count = 0;
  void add(const Vec3d& drawn, const Vec3d& truth) {
    if (!(dot(drawn, drawn) > 0.25)) return;
    const double cosine = dot(drawn, truth) / std::sqrt(dot(drawn, drawn) * dot(truth, truth));
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
    sum += angle * angle;
    ++count;
  }
  double rms() const { return std::sqrt(sum / static_cast<double>(count)); }
};

ShapeErrors errors_of_ball(const Taken& taken, double r, double d) {
  const double D = taken.distance_m, scale = static_cast<double>(taken.rays.scale_x);
  const double cx = 0.5 * taken.seen.width, cy = 0.5 * taken.seen.height;
  const double truth = r / std::sqrt(D * D - r * r);
  const auto samples = static_cast<int>(std::ceil(2 * std::numbers::pi * r / d * 32));
  Outline outline;
  for (int k = 0; k < samples; ++k) {
    const double angle = 2 * std::numbers::pi * k / samples;
    const double edge = edge_px(taken, cx, cy, std::cos(angle), std::sin(angle), 1.2 * truth / scale);
    outline.push_back((edge * scale - truth) * D);
  }
  Angles angles;
  for (int y = 0; y < taken.seen.height; ++y) {
    for (int x = 0; x < taken.seen.width; ++x) {
      const double sx = taken.slope_x(x + 0.5), sy = taken.slope_y(y + 0.5);
      if (std::hypot(sx, sy) >= 0.8 * truth) continue;
      const double square = sx * sx + sy * sy + 1;
      const double depth = (D - std::sqrt(D * D - square * (D * D - r * r))) / square;
      angles.add(taken.normal(x, y), {depth * sx, depth * sy, D - depth});
    }
  }
  return {rms_of({outline}) / d, angles.rms(),
          curvature_energy(outline, 2 * std::numbers::pi * r / samples, d)};
}

ShapeErrors errors_of_column(const Taken& taken, double r, double d) {
  const double D = taken.distance_m, scale = static_cast<double>(taken.rays.scale_x);
  const double cx = 0.5 * taken.seen.width, truth = r / std::sqrt(D * D - r * r);
  const double half = 0.6 * 2 * r / D / scale;  // 60 % of the height
  std::vector<Outline> outlines(2);
  Angles angles;
  for (int y = static_cast<int>(0.5 * taken.seen.height - half); y < 0.5 * taken.seen.height + half; ++y) {
    for (const int side : {0, 1}) {
      const double edge = edge_px(taken, cx, y + 0.5, side ? 1 : -1, 0, 1.4 * truth / scale);
      outlines[static_cast<std::size_t>(side)].push_back((edge * scale - truth) * D);
    }
    for (int x = 0; x < taken.seen.width; ++x) {
      const double sx = taken.slope_x(x + 0.5);
      if (std::abs(sx) >= 0.8 * truth) continue;
      const double square = sx * sx + 1;
      const double depth = (D - std::sqrt(D * D - square * (D * D - r * r))) / square;
      angles.add(taken.normal(x, y), {depth * sx, 0, D - depth});
    }
  }
  double scallop = 0;
  for (const Outline& one : outlines) scallop += curvature_energy(one, scale * D, d) / 2;
  return {rms_of(outlines) / d, angles.rms(), scallop};
}

ShapeErrors errors_of_sheet(const Taken& taken, const Body& body, double d) {
  const double scale = static_cast<double>(taken.rays.scale_x);
  const double thick = body.high_m[1] - body.low_m[1], near = taken.distance_m - body.half_m;
  const double truth = 0.5 * thick / near, half = 0.6 * body.half_m / taken.distance_m / scale;
  std::vector<Outline> outlines(2);
  for (int x = static_cast<int>(0.5 * taken.seen.width - half); x < 0.5 * taken.seen.width + half; ++x) {
    for (const int side : {0, 1}) {
      const double edge =
          edge_px(taken, x + 0.5, 0.5 * taken.seen.height, 0, side ? 1 : -1, 2 * truth / scale + 32);
      outlines[static_cast<std::size_t>(side)].push_back((edge * scale - truth) * near);
    }
  }
  double scallop = 0;
  for (const Outline& one : outlines) scallop += curvature_energy(one, scale * near, d) / 2;
  ShapeErrors out;
  out.outline_d = rms_of(outlines) / d;
  out.scallop = scallop;
  return out;
}

ShapeErrors errors_of_pool(const Taken& taken, const Body& body, double d) {
  const sim::Mat4 pose = sim::rigid_inverse(taken.view.view);
  const auto to_world = [&](const Vec3d& v, std::size_t row) {
    return static_cast<double>(pose[row]) * v[0] + static_cast<double>(pose[4 + row]) * v[1] +
           static_cast<double>(pose[8 + row]) * v[2];
  };
  const auto up = taken.view.view;  // its second column is the world's y axis in eye space
  const Vec3d truth{static_cast<double>(up[4]), static_cast<double>(up[5]), static_cast<double>(up[6])};
  Outline heights;
  Angles angles;
  for (int y = 0; y < taken.seen.height; ++y) {
    for (int x = 0; x < taken.seen.width; ++x) {
      const double depth = static_cast<double>(taken.seen.filtered_depth[taken.at(x, y)]);
      if (!std::isfinite(depth)) continue;
      const Vec3d eye{depth * taken.slope_x(x + 0.5), depth * taken.slope_y(y + 0.5), -depth};
      Vec3d place{};
      for (std::size_t row = 0; row < 3; ++row)
        place[row] = static_cast<double>(pose[12 + row]) + to_world(eye, row);
      const double aside = std::max(std::abs(place[0] - body.half_m), std::abs(place[2] - body.half_m));
      if (aside > 0.7 * body.half_m) continue;
      heights.push_back(place[1] - body.high_m[1]);
      angles.add(taken.normal(x, y), truth);
    }
  }
  ShapeErrors out;
  out.outline_d = rms_of({heights}) / d;
  out.normals_deg = angles.rms();
  return out;
}

}  // namespace

std::string shape_name(KnownShape shape) {
  switch (shape) {
    case KnownShape::Pool:
      return "pool";
    case KnownShape::Ball:
      return "ball";
    case KnownShape::Column:
      return "column";
    default:
      return "sheet";
  }
}

double curvature_energy(const std::vector<double>& away, double step, double d) {
  const auto n = static_cast<double>(away.size());
  double mean = 0;
  for (const double e : away) mean += e / n;
  double energy = 0;
  const double whole = n * step;
  for (int k = static_cast<int>(std::ceil(whole / (1.5 * d))); k <= whole * 1.5 / d; ++k) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < away.size(); ++i) {
      const double phase = 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / n;
      const double window = 1 - std::cos(phase);  // Hann, of mean square 1.5
      sum += window * (away[i] - mean) * std::polar(1.0, -k * phase);
    }
    const double wave = 2 * std::numbers::pi * k / whole;
    energy += 2 * std::norm(sum / n) / 1.5 * std::pow(wave, 4);
  }
  return energy * d * d;
}

ShapePicture draw_shape(KnownShape shape, int level, std::int64_t n_star, sim::Surface surface) {
  const Body body = body_of(shape, n_star);
  auto particles = particles_of(body, level);
  const double d = spacing_of(particles);
  sim::Scene scene;
  scene.tank_size_m = body.tank_m;
  std::vector<sim::RenderShape> shapes;
  if (surface == sim::Surface::Ellipsoids) sim::HostSurface(scene).shape(particles, shapes);
  sim::RenderOptions options;
  options.surface = surface;
  sim::FluidRenderer renderer(scene, options);
  sim::ParticleBuffer buffer;
  buffer.upload(particles, shapes);

  const double D = far_away * body.half_m;
  const Vec3d target{body.tank_m[0] / 2, (body.low_m[1] + body.high_m[1]) / 2, body.tank_m[2] / 2};
  sim::Camera camera;
  camera.target_m = target;
  camera.eye_m = target;
  const bool slant = shape == KnownShape::Pool;
  camera.eye_m[1] += slant ? D * std::sqrt(0.5) : 0;
  camera.eye_m[2] += slant ? D * std::sqrt(0.5) : D;
  const double shown = 1.25 * body.half_m;
  camera.vertical_fov_deg = 2 * std::atan(shown / D) * 180 / std::numbers::pi;
  camera.near_m = 0.1 * D;
  camera.far_m = 4 * D;
  const int side = static_cast<int>(std::ceil(2 * shown / d * px_per_spacing));
  Taken taken{sim::make_view(camera, side, side), {}, {}, D};
  taken.rays = sim::pixel_rays(taken.view);
  const sim::Offscreen picture(side, side);
  renderer.draw(buffer, {&taken.view, 1}, picture.framebuffer());
  taken.seen = renderer.read_gbuffer();
  ShapePicture out;
  out.image = picture.read();
  out.errors = shape == KnownShape::Ball     ? errors_of_ball(taken, body.half_m, d)
               : shape == KnownShape::Column ? errors_of_column(taken, body.half_m / 2, d)
               : shape == KnownShape::Sheet  ? errors_of_sheet(taken, body, d)
                                             : errors_of_pool(taken, body, d);
  return out;
}

}  // namespace measure
