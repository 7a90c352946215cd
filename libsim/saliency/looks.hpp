#pragma once
/// The eyes' positions, gazes and pictures that a program gives a simulation before a frame. The types
/// contain host data and need neither a back end nor GL calls.

#include <vector>

#include "libsim/view/camera.hpp"
#include "libsim/view/gbuffer.hpp"

namespace sim {

/// A line of sight in the world. `valid` is the tracker's flag; a ray that is not finite or has no direction
/// counts as lost anyway.
struct Gaze {
  Vec3d origin_m{};
  Vec3d direction{};  ///< any length but 0
  bool valid = false;
};

/// One eye at the start of a frame.
struct EyeLook {
  Gaze gaze;
  View view;  ///< the camera of the coming frame
  /// The picture this eye saw last; its camera may be an older one. nullptr: nothing was drawn yet; then no
  /// particle has a manifold feature and none is occluded. Copied by Simulation::look.
  const GBuffer* seen = nullptr;
  /// The same picture in the renderer's buffers, for a back end on GL's device; takes precedence over `seen`.
  const GlPicture* shared = nullptr;
  int seen_frame = -1;  ///< simulation frame that the picture shows; -1: unknown
  /// Scale at which the eye sees the picture, > 0: tan of half the angle between the picture's edges at the
  /// eye, divided by tan of half the camera's field of view. It is below 1 if a distant screen shows the
  /// picture of a wide-angle camera. 1: the two angles are equal, or the angle at the eye is unknown.
  double visual_scale = 1;
};

/// Where the picture that saliency uses came from.
enum class PictureWay {
  None,    ///< no picture was given, or the method uses none
  Device,  ///< from GL's memory to the back end's, on one device
  Host     ///< read back, and uploaded if the back end is not the CPU
};

/// Where the picture used by saliency came from, and its frame, for records.
struct SeenReport {
  PictureWay way = PictureWay::None;
  int frame = -1;  ///< EyeLook::seen_frame; the smaller one of two eyes
};

/// One eye or two. Each is evaluated separately, and the larger saliency counts.
struct Looks {
  std::vector<EyeLook> eyes;
};

/// Saliency of one particle (ViP-Fluid 3.2): at the last level update (Simulation::read_saliency) or in the
/// present state (Simulation::measure_saliency). Equations are those of ViP-Fluid.
struct ParticleSaliency {
  float acuity = 0;    ///< f_a, visual acuity, Eq. 3
  float manifold = 0;  ///< f_m, curvature of the visible surface, Eq. 5
  float temporal = 0;  ///< f_T, gradients of velocity and density, Eq. 6
  float combined = 0;  ///< F, weighted sum of the three features, Eq. 1
  float s = 0;         ///< saliency, [0, 1]: F normalised, or a function of the gaze alone
  int target = 0;      ///< target level, Eq. 9
};

}  // namespace sim
