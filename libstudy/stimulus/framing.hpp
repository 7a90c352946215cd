#pragma once
/// Framing: which part of a scene a picture shows, and which visual angle the picture has.

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

/// The gaze of a person in a headset, as a ray in the headset's space, whose origin is the eye of the scene's
/// camera; see eye_view().
struct RoomRay {
  std::array<double, 3> place_m{};    ///< start of the ray, metres of the scene
  std::array<double, 3> direction{};  ///< direction of the ray, of any length except 0
};

/// Gaze and visual angle of the viewer of a fluid. With empty functions the visual angle is unknown, and the
/// gaze is at the middle of the picture; in a headset it is straight ahead of the left eye.
struct Viewing {
  /// Gaze point in a picture of this width and height, px from its lower left corner; none if unknown.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  /// Gaze ray of a person in a headset; none if unknown. Empty function: the gaze is straight ahead of the
  /// left eye.
  std::function<std::optional<RoomRay>()> ray{};
  /// Vertical visual angle, in degrees, of a picture of this width and height in px.
  std::function<double(int, int)> visual_angle_deg;
  /// True: the camera uses the visual angle, if known, instead of the scene's angle. The picture then looks
  /// like a window onto the scene.
  bool true_angle = false;
};

/// Vertical angles of view of a picture, degrees in (0, 180).
struct Framing {
  double camera_deg = 0;
  std::optional<double> visual_deg;  ///< visual angle of the picture; none: unknown

  /// visual_deg / camera_deg; none if visual_deg is unknown.
  std::optional<double> ratio() const;
  /// Value for sim::EyeLook::visual_scale: tan(visual_deg / 2) / tan(camera_deg / 2); 1 if visual_deg is
  /// unknown.
  double visual_scale() const;
};

/// Angles that differ by at most this count as equal, degrees: bakes store angles as text, which is rounded.
inline constexpr double same_angle_deg = 0.01;

Framing frame_picture(const sim::Camera& camera, const Viewing& viewing, int width_px, int height_px);

/// The camera's view with the camera angle of frame_picture().
sim::View framed_view(sim::Camera camera, const Viewing& viewing, int width_px, int height_px);

/// The view of one eye in a headset. The origin of the headset's space is the camera's eye, turned by the
/// camera's heading but not by its pitch, so that the scene's horizon is level for the person. The angles of
/// the view are the headset's, not the camera's. base::Error if the angles or the rectangle make no picture,
/// or if the camera looks straight up or down.
sim::View eye_view(const sim::Camera& camera, const EyeView& eye);

/// Converts a gaze ray from the headset's space to the scene's coordinates.
sim::Gaze gaze_along(const sim::Camera& camera, const RoomRay& ray);

/// The views to draw on a canvas: one framed_view(), or in a headset the eye_view() of each eye.
std::vector<sim::View> views_on(const sim::Camera& camera, const Viewing& viewing, const Canvas& canvas);

/// Position of a point in a view's picture, px from its lower left corner; none if the point is not beyond
/// the near plane.
std::optional<std::pair<double, double>> place_in(const sim::View& view, const sim::Vec3d& point_m);

/// The eight corners of a box; bit k of the index selects the far end along axis k.
std::array<sim::Vec3d, 8> corners_of(const sim::VisibleBox& box);

/// Names of the boxes in Scene::visible that the view cuts off, even partly.
std::vector<std::string> cut_off(const sim::Scene& scene, const sim::View& view);

/// A rectangle of pixels in a framebuffer.
struct Rectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// The largest centred rectangle with the picture's aspect ratio in a framebuffer of into_width x into_height
/// px.
Rectangle fit_picture(int width, int height, int into_width, int into_height);

}  // namespace study
