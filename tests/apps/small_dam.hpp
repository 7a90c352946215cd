#pragma once

namespace apps::test {

/// Text of a scene: a small dam that breaks at once, seen from near. Nothing settles.
inline constexpr const char* small_dam = R"(format = 1
name = "SmallDam"
gravity_m_s2 = 9.81
checkpoints = []
[tank]
size_m = [2.0, 1.0, 1.0]
[water]
min_m = [0.0, 0.0, 0.0]
max_m = [1.0, 0.8, 1.0]
gate = false
settle_frames = 0
[time]
frames_per_s = 60.0
v_ref_m_s = 4.0
min_substeps = 2
iterations = 2
[view]
eye_m = [1.0, 0.6, 2.6]
target_m = [1.0, 0.4, 0.5]
vertical_fov_deg = 60.0
near_m = 0.1
)";

}  // namespace apps::test
