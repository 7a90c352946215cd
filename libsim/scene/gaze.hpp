#pragma once
/// The gaze from a scene's gaze keys: replaces an eye tracker in benches and pictures.

#include <cstdint>

#include "libsim/scene/scene.hpp"

namespace sim {

/// Duration of a jump from one key's point to the next, in frames.
inline constexpr int gaze_jump_frames = 2;

/// The point at which the gaze is directed in `frame`: the point of the last key at or before `frame`. In the
/// first gaze_jump_frames frames of a key the gaze moves there from the previous key's point. Before the
/// first key, the first key's point; without keys, the view's target.
Vec3d gaze_point(const Scene& scene, int frame);

/// Number of the scene's frame at the time of frame `frame` of a run whose frames last frame_dt_s. The
/// scene's keys count the scene's frames.
int scene_frame(const Scene& scene, std::int64_t frame, double frame_dt_s);

}  // namespace sim
