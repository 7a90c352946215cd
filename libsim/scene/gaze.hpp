#pragma once
/// Where a scene's gaze keys say that one looks: the stand-in for an eye tracker in benches and pictures.

#include <cstdint>

#include "libsim/scene/scene.hpp"

namespace sim {

/// Frames that a jump from one key's point to the next takes.
inline constexpr int gaze_jump_frames = 2;

/// The point of the last key at or before `frame`, reached in gaze_jump_frames from the point before; the
/// first key's point before it. Without keys, the view's target.
Vec3d gaze_point(const Scene& scene, int frame);

/// The scene's own frame, in which its keys count, at the time of a run's frame.
int scene_frame(const Scene& scene, std::int64_t frame, double frame_dt_s);

}  // namespace sim
