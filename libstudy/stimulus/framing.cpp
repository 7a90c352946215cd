#include "libstudy/stimulus/framing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "stats/base/error.hpp"

namespace study {

namespace {

/// Slope of the ray through the upper edge of a picture with this vertical angle: tan(angle / 2).
double slope(double vertical_deg) { return std::tan(vertical_deg * std::numbers::pi / 360); }

bool sees_point(const sim::View& view, const sim::Vec3d& point_m) {
  const auto place = place_in(view, point_m);
  return place && place->first >= 0 && place->first <= view.viewport.width && place->second >= 0 &&
         place->second <= view.viewport.height;
}

}  // namespace

std::optional<double> Framing::ratio() const {
  if (!visual_deg) return {};
  return *visual_deg / camera_deg;
}

double Framing::visual_scale() const { return visual_deg ? slope(*visual_deg) / slope(camera_deg) : 1; }

Framing frame_picture(const sim::Camera& camera, const Viewing& viewing, int width_px, int height_px) {
  Framing framing{camera.vertical_fov_deg, {}};
  if (!viewing.visual_angle_deg) return framing;
  framing.visual_deg = viewing.visual_angle_deg(width_px, height_px);
  if (viewing.true_angle) framing.camera_deg = *framing.visual_deg;
  return framing;
}

sim::View framed_view(sim::Camera camera, const Viewing& viewing, int width_px, int height_px) {
  camera.vertical_fov_deg = frame_picture(camera, viewing, width_px, height_px).camera_deg;
  return sim::make_view(camera, width_px, height_px);
}

namespace {

/// Transforms scene coordinates to the space in which EyeView positions a headset's eyes.
sim::Mat4 to_room(const sim::Camera& camera) {
  return sim::look_at(camera.eye_m, {camera.target_m[0], camera.eye_m[1], camera.target_m[2]});
}

}  // namespace

sim::Gaze gaze_along(const sim::Camera& camera, const RoomRay& ray) {
  const sim::Mat4 to_scene = sim::rigid_inverse(to_room(camera));
  sim::Gaze gaze;
  for (std::size_t row = 0; row < 3; ++row) {
    gaze.origin_m[row] = static_cast<double>(to_scene[12 + row]);
    for (std::size_t k = 0; k < 3; ++k) {
      const double part = static_cast<double>(to_scene[4 * k + row]);
      gaze.origin_m[row] += part * ray.place_m[k];
      gaze.direction[row] += part * ray.direction[k];
    }
  }
  gaze.valid = true;
  return gaze;
}

sim::View eye_view(const sim::Camera& camera, const EyeView& eye) {
  const double left = std::tan(eye.left_rad), right = std::tan(eye.right_rad);
  const double up = std::tan(eye.up_rad), down = std::tan(eye.down_rad);
  if (!(right > left && up > down) || eye.width_px < 1 || eye.height_px < 1) {
    throw base::Error("headset", "an eye's field of view has no area", "restart the headset's runtime");
  }
  sim::View view;
  const sim::Mat4 to_anchor = sim::rigid_pose(eye.position_m, eye.orientation);
  view.view = sim::multiply(sim::rigid_inverse(to_anchor), to_room(camera));
  view.near_m = camera.near_m;
  view.far_m = camera.far_m;
  view.projection = sim::frustum(left, right, down, up, camera.near_m, camera.far_m);
  view.viewport = {eye.x_px, eye.y_px, eye.width_px, eye.height_px};
  return view;
}

std::vector<sim::View> views_on(const sim::Camera& camera, const Viewing& viewing, const Canvas& canvas) {
  if (canvas.eyes.empty()) return {framed_view(camera, viewing, canvas.width_px, canvas.height_px)};
  std::vector<sim::View> views;
  for (const EyeView& eye : canvas.eyes) views.push_back(eye_view(camera, eye));
  return views;
}

std::optional<std::pair<double, double>> place_in(const sim::View& view, const sim::Vec3d& point_m) {
  const sim::Mat4 m = sim::multiply(view.projection, view.view);
  std::array<double, 4> clip{};
  for (std::size_t row = 0; row < 4; ++row) {
    clip[row] = static_cast<double>(m[12 + row]);
    for (std::size_t k = 0; k < 3; ++k) clip[row] += static_cast<double>(m[4 * k + row]) * point_m[k];
  }
  if (!(clip[3] > view.near_m)) return {};  // clip[3]: depth along the view's axis, m
  return std::pair(0.5 * view.viewport.width * (clip[0] / clip[3] + 1),
                   0.5 * view.viewport.height * (clip[1] / clip[3] + 1));
}

std::array<sim::Vec3d, 8> corners_of(const sim::VisibleBox& box) {
  std::array<sim::Vec3d, 8> out;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t k = 0; k < 3; ++k) out[i][k] = (i >> k & 1) ? box.max_m[k] : box.min_m[k];
  }
  return out;
}

std::vector<std::string> cut_off(const sim::Scene& scene, const sim::View& view) {
  std::vector<std::string> out;
  for (const auto& box : scene.visible) {
    const auto corners = corners_of(box);
    // The box and the view frustum are convex, so the box is visible if all its corners are visible.
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](const auto& corner) { return sees_point(view, corner); }))
      out.push_back(box.name);
  }
  return out;
}

Rectangle fit_picture(int width, int height, int into_width, int into_height) {
  const double scale = std::min(double(into_width) / width, double(into_height) / height);
  const int w = static_cast<int>(std::lround(width * scale));
  const int h = static_cast<int>(std::lround(height * scale));
  const int x = (into_width - w) / 2, y = (into_height - h) / 2;
  return {x, y, x + w, y + h};
}

}  // namespace study
