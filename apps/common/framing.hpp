#pragma once
/// Which part of a scene a picture shows, and how large the eye sees it.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libsim/saliency/looks.hpp"
#include "libsim/view/camera.hpp"
#include "libstudy/display/canvas.hpp"

namespace apps {

/// A ray in the space that eye_view() places eyes in: where somebody in a headset looks.
struct RoomRay {
  std::array<double, 3> place_m{};    ///< metres of the scene
  std::array<double, 3> direction{};  ///< of any length but 0
};

/// How a fluid is watched. Empty functions: the gaze rests on the middle of the picture, and the angle that
/// it fills of the eye's view is not known.
struct Viewing {
  /// Where one looks in a picture of this width and height, px from its lower left corner; none: not known.
  std::function<std::optional<std::pair<double, double>>(int, int)> gaze;
  /// Where two eyes look; none: not known. Empty: straight ahead of the left one.
  std::function<std::optional<RoomRay>()> ray{};
  /// Vertical angle that a picture of this width and height, px, fills of the eye's view, degrees.
  std::function<double(int, int)> visual_angle_deg;
  /// The camera takes that angle, where it is known, instead of the scene's: the picture is a window onto the
  /// scene.
  bool true_angle = false;
};

/// Vertical angles of a picture, degrees in (0, 180).
struct Framing {
  double camera_deg = 0;
  std::optional<double> visual_deg;  ///< none: not known

  /// visual_deg / camera_deg; none: not known.
  std::optional<double> ratio() const;
  /// sim::EyeLook::visual_scale; 1 where the visual angle is not known.
  double visual_scale() const;
};

/// Bakes keep angles as text: what differs by less was written otherwise, or computed from other roundings.
inline constexpr double same_angle_deg = 0.01;

Framing frame_picture(const sim::Camera& camera, const Viewing& viewing, int width_px, int height_px);

/// The view of that camera with the angle of frame_picture().
sim::View framed_view(sim::Camera camera, const Viewing& viewing, int width_px, int height_px);

/// The view of one eye. Its anchor stands at the camera's eye and has its heading, never its pitch: the
/// horizon is where the person's own is. Angles are the headset's, not the camera's. base::Error for angles
/// or a rectangle that make no picture, and a camera that looks straight up or down.
sim::View eye_view(const sim::Camera& camera, const study::EyeView& eye);

/// The same ray in the scene.
sim::Gaze gaze_along(const sim::Camera& camera, const RoomRay& ray);

/// What is drawn on a canvas: framed_view() of the whole, or eye_view() of each eye.
std::vector<sim::View> views_on(const sim::Camera& camera, const Viewing& viewing,
                                const study::Canvas& canvas);

/// Where a point lies in a view's picture, px from its lower left corner; none: not before the near plane.
std::optional<std::pair<double, double>> place_in(const sim::View& view, const sim::Vec3d& point_m);

/// The eight corners of a box; bit k of the index: at its far end along axis k.
std::array<sim::Vec3d, 8> corners_of(const sim::VisibleBox& box);

/// Names of what a scene declares visible and a view cuts, were it only in part.
std::vector<std::string> cut_off(const sim::Scene& scene, const sim::View& view);

/// A part of a framebuffer, px.
struct Rectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// The largest rectangle of a picture's shape in the middle of a framebuffer.
Rectangle fit_picture(int width, int height, int into_width, int into_height);

}  // namespace apps
