#pragma once
/// Which part of a scene a picture shows, and how large it appears to the eye.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libsim/saliency/looks.hpp"
#include "libsim/view/camera.hpp"
#include "libstudy/display/canvas.hpp"

namespace study {

/// A ray in the space in which eye_view() places the eyes: the gaze of a person in a headset.
struct RoomRay {
  std::array<double, 3> place_m{};    ///< metres of the scene
  std::array<double, 3> direction{};  ///< any length but 0
};

/// How a fluid is watched. With empty functions, the gaze rests on the middle of the picture and the visual
/// angle of the picture is unknown.
struct Viewing {
  /// Gaze point in a picture of this width and height, px from its lower left corner; none if unknown.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  /// Gaze ray of the two eyes; none if unknown. Empty function: straight ahead of the left eye.
  std::function<std::optional<RoomRay>()> ray{};
  /// Vertical visual angle, in degrees, of a picture of this width and height in px.
  std::function<double(int, int)> visual_angle_deg;
  /// Uses that visual angle, if known, as the camera's angle instead of the scene's: the picture is then a
  /// window onto the scene.
  bool true_angle = false;
};

/// Vertical angles of a picture, degrees in (0, 180).
struct Framing {
  double camera_deg = 0;
  std::optional<double> visual_deg;  ///< none: unknown

  /// visual_deg / camera_deg; none if unknown.
  std::optional<double> ratio() const;
  /// As sim::EyeLook::visual_scale; 1 if the visual angle is unknown.
  double visual_scale() const;
};

/// Angles that differ by less are equal: bakes store angles as text, and rounding differs.
inline constexpr double same_angle_deg = 0.01;

Framing frame_picture(const sim::Camera& camera, const Viewing& viewing, int width_px, int height_px);

/// The camera's view with the angle of frame_picture().
sim::View framed_view(sim::Camera camera, const Viewing& viewing, int width_px, int height_px);

/// The view of one eye. The anchor of the headset's space is the camera's eye with the camera's heading,
/// without its pitch, so that the scene's horizon is the person's own. Angles are the headset's, not the
/// camera's. base::Error if the angles or the rectangle make no picture, or if the camera looks straight up
/// or down.
sim::View eye_view(const sim::Camera& camera, const EyeView& eye);

/// Converts a ray to the scene's coordinates.
sim::Gaze gaze_along(const sim::Camera& camera, const RoomRay& ray);

/// The views to draw on a canvas: framed_view() of the whole, or eye_view() of each eye.
std::vector<sim::View> views_on(const sim::Camera& camera, const Viewing& viewing, const Canvas& canvas);

/// Position of a point in a view's picture, px from its lower left corner; none if it is not beyond the near
/// plane.
std::optional<std::pair<double, double>> place_in(const sim::View& view, const sim::Vec3d& point_m);

/// The eight corners of a box; bit k of the index selects the far end along axis k.
std::array<sim::Vec3d, 8> corners_of(const sim::VisibleBox& box);

/// Names of the boxes that the scene declares visible and that the view cuts off, even partly.
std::vector<std::string> cut_off(const sim::Scene& scene, const sim::View& view);

/// A part of a framebuffer, px.
struct Rectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// The largest centred rectangle of a framebuffer with the picture's aspect ratio.
Rectangle fit_picture(int width, int height, int into_width, int into_height);

}  // namespace study
