#pragma once
/// Cameras as matrices. Right-handed; an eye looks along -z of its own space; matrices are column-major as in
/// OpenGL.

#include <array>

#include "libsim/scene/scene.hpp"

namespace sim {

/// Column-major 4 x 4: element (row, column) is m[4 * column + row].
using Mat4 = std::array<float, 16>;

Mat4 identity();
Mat4 multiply(const Mat4& a, const Mat4& b);
/// World to eye. Errors (base::Error): eye and target coincide, or the view direction is parallel to the y
/// axis.
Mat4 look_at(const Vec3d& eye_m, const Vec3d& target_m);
/// Symmetric frustum; vertical field of view in (0, 180) degrees, aspect = width / height, 0 < near < far;
/// base::Error otherwise.
Mat4 perspective(double vertical_fov_deg, double aspect, double near_m, double far_m);
/// The frustum between slopes relative to the viewing direction, right > left and up > down; 0 < near < far.
Mat4 frustum(double left, double right, double down, double up, double near_m, double far_m);
/// Eye to world: a position and a rotation by a unit quaternion x, y, z, w.
Mat4 rigid_pose(const Vec3d& place_m, const std::array<double, 4>& turn);
/// Inverse of a rotation and translation (no scale).
Mat4 rigid_inverse(const Mat4& m);

/// Position of a view in its framebuffer, px; (0, 0) is the lower left corner.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
};

/// One eye. The projection may be off-centre (a headset's) but must be a perspective frustum.
struct View {
  Mat4 view = identity();  ///< world to eye, rigid
  Mat4 projection = identity();
  Viewport viewport;
  double near_m = 0.1;
  double far_m = 200;
};

/// The view of a scene's camera that fills a picture of width x height px.
View make_view(const Camera& camera, int width, int height);

/// Ray through pixel coordinates (x, y), pixel centres at half-integers, as slopes (right, up) per unit of
/// eye depth: slope = {x * scale_x + offset_x, y * scale_y + offset_y}.
struct PixelRays {
  float scale_x, offset_x, scale_y, offset_y;
};
PixelRays pixel_rays(const View& view);

}  // namespace sim
