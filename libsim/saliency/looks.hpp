#pragma once
/// Who looks at the fluid, from where and whereto: what a program gives a simulation before a frame. Plain
/// host data, no back end, no GL calls.

#include <vector>

#include "libsim/view/camera.hpp"
#include "libsim/view/gbuffer.hpp"

namespace sim {

/// A ray of sight in the world. `valid` is the tracker's own word; a ray that is not finite or has no
/// direction counts as lost whatever it says.
struct Gaze {
  Vec3d origin_m{};
  Vec3d direction{};  ///< of any length but 0
  bool valid = false;
};

/// One eye at the start of a frame.
struct EyeLook {
  Gaze gaze;
  View view;  ///< the camera of the coming frame
  /// What this eye saw last; its own camera may be an older one. nullptr: nothing was drawn yet, then no
  /// particle has a manifold feature and none is hidden. Copied by Simulation::look.
  const GBuffer* seen = nullptr;
  /// The same where the renderer left it, for a back end on GL's device; goes before `seen`.
  const GlPicture* shared = nullptr;
  int seen_frame = -1;  ///< of the simulation that the picture shows; -1: not known
  /// How the picture is seen: tan of half the angle that it fills of the eye's view, by tan of half the
  /// camera's angle, > 0. A screen seen from far shows a wide camera's picture small. 1: the camera's angles
  /// are the eye's, or nothing is known.
  double visual_scale = 1;
};

/// How the last picture reached saliency.
enum class PictureWay {
  None,    ///< no picture was given, or the method looks at none
  Device,  ///< from GL's memory to the back end's on one device
  Host     ///< read back, and uploaded where the back end is not the CPU
};

/// What saliency saw, for the record.
struct SeenReport {
  PictureWay way = PictureWay::None;
  int frame = -1;  ///< EyeLook::seen_frame; the older one of two eyes
};

/// One eye or two. Each is evaluated for itself and the larger saliency counts.
struct Looks {
  std::vector<EyeLook> eyes;
};

/// Saliency of one particle as it was evaluated when levels were chosen last (paper 3.2).
struct ParticleSaliency {
  float acuity = 0;    ///< f_a, Eq. 3
  float manifold = 0;  ///< f_m, Eq. 5
  float temporal = 0;  ///< f_T, Eq. 6
  float combined = 0;  ///< F, Eq. 1
  float s = 0;         ///< normalised, [0, 1]
  int target = 0;      ///< level, Eq. 9
};

}  // namespace sim
