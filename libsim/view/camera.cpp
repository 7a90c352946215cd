#include "libsim/view/camera.hpp"

#include <cmath>
#include <numbers>

#include "libsim/scene/vector.hpp"
#include "stats/base/error.hpp"

namespace sim {

namespace {

Vec3d normalized(const Vec3d& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

}  // namespace

Mat4 identity() { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }

Mat4 multiply(const Mat4& a, const Mat4& b) {
  Mat4 product{};
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      float sum = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += a[4 * k + row] * b[4 * column + k];
      product[4 * column + row] = sum;
    }
  }
  return product;
}

Mat4 look_at(const Vec3d& eye_m, const Vec3d& target_m) {
  const Vec3d forward = minus(target_m, eye_m);
  const Vec3d right = cross(forward, {0, 1, 0});
  if (!(dot(right, right) > 1e-12 * dot(forward, forward))) {
    const auto words = [](const Vec3d& at) {
      return "(" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) +
             ") m";
    };
    throw base::Error("camera",
                      "the eye " + words(eye_m) + " and the target " + words(target_m) +
                          " coincide, or one lies straight above the other",
                      "move the eye or the target sideways");
  }
  const Vec3d z = normalized({-forward[0], -forward[1], -forward[2]});
  const Vec3d x = normalized(right);
  const Vec3d y = cross(z, x);
  Mat4 m = identity();
  const Vec3d axes[3] = {x, y, z};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      m[4 * column + row] = static_cast<float>(axes[row][column]);
    m[12 + row] = static_cast<float>(-dot(axes[row], eye_m));
  }
  return m;
}

Mat4 perspective(double vertical_fov_deg, double aspect, double near_m, double far_m) {
  if (!(vertical_fov_deg > 0 && vertical_fov_deg < 180 && aspect > 0 && near_m > 0 && far_m > near_m)) {
    throw base::Error("camera",
                      "no perspective: vertical field of view " + std::to_string(vertical_fov_deg) +
                          " degrees, aspect " + std::to_string(aspect) + ", near " + std::to_string(near_m) +
                          " m, far " + std::to_string(far_m) + " m",
                      "use 0 < field of view < 180 degrees, aspect > 0 and 0 < near < far");
  }
  const double scale = 1 / std::tan(vertical_fov_deg * std::numbers::pi / 360);
  Mat4 m{};
  m[0] = static_cast<float>(scale / aspect);
  m[5] = static_cast<float>(scale);
  m[10] = static_cast<float>((far_m + near_m) / (near_m - far_m));
  m[11] = -1;
  m[14] = static_cast<float>(2 * far_m * near_m / (near_m - far_m));
  return m;
}

Mat4 frustum(double left, double right, double down, double up, double near_m, double far_m) {
  Mat4 m{};
  m[0] = static_cast<float>(2 / (right - left));
  m[5] = static_cast<float>(2 / (up - down));
  m[8] = static_cast<float>((right + left) / (right - left));
  m[9] = static_cast<float>((up + down) / (up - down));
  m[10] = static_cast<float>((far_m + near_m) / (near_m - far_m));
  m[11] = -1;
  m[14] = static_cast<float>(2 * far_m * near_m / (near_m - far_m));
  return m;
}

Mat4 rigid_pose(const Vec3d& place_m, const std::array<double, 4>& turn) {
  const auto [x, y, z, w] = turn;
  const std::array<Vec3d, 3> axes{{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                                   {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                                   {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
  Mat4 m = identity();
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      m[4 * column + row] = static_cast<float>(axes[column][row]);
    m[12 + row] = static_cast<float>(place_m[row]);
  }
  return m;
}

Mat4 rigid_inverse(const Mat4& m) {
  Mat4 inverse = identity();
  for (std::size_t row = 0; row < 3; ++row) {
    float shift = 0;
    for (std::size_t column = 0; column < 3; ++column) {
      inverse[4 * column + row] = m[4 * row + column];
      shift -= m[4 * row + column] * m[12 + column];
    }
    inverse[12 + row] = shift;
  }
  return inverse;
}

View make_view(const Camera& camera, int width, int height) {
  if (width < 1 || height < 1)
    throw base::Error("size of the picture",
                      "is " + std::to_string(width) + " x " + std::to_string(height) + " px",
                      "make it at least 1 x 1 px");
  View view;
  view.view = look_at(camera.eye_m, camera.target_m);
  view.projection =
      perspective(camera.vertical_fov_deg, static_cast<double>(width) / height, camera.near_m, camera.far_m);
  view.viewport = {0, 0, width, height};
  view.near_m = camera.near_m;
  view.far_m = camera.far_m;
  return view;
}

PixelRays pixel_rays(const View& view) {
  const Mat4& p = view.projection;
  // The normalised device coordinate along x is p[0] * slope - p[8] and also 2 x / width - 1; along y alike,
  // with p[5] and p[9].
  return {2 / (static_cast<float>(view.viewport.width) * p[0]), (p[8] - 1) / p[0],
          2 / (static_cast<float>(view.viewport.height) * p[5]), (p[9] - 1) / p[5]};
}

}  // namespace sim
