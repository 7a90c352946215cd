#include "libsim/scene/gaze.hpp"

#include <algorithm>
#include <cmath>

namespace sim {

Vec3d gaze_point(const Scene& scene, int frame) {
  if (scene.gaze.empty()) return scene.view.target_m;
  const auto next = std::upper_bound(scene.gaze.begin(), scene.gaze.end(), frame,
                                     [](int f, const GazeKey& key) { return f < key.frame; });
  if (next == scene.gaze.begin()) return scene.gaze.front().point_m;
  const auto key = std::prev(next);
  if (key == scene.gaze.begin()) return key->point_m;
  const double t = std::min(1.0, static_cast<double>(frame - key->frame) / gaze_jump_frames);
  const Vec3d& from = std::prev(key)->point_m;
  Vec3d out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = from[k] + t * (key->point_m[k] - from[k]);
  return out;
}

int scene_frame(const Scene& scene, std::int64_t frame, double frame_dt_s) {
  return static_cast<int>(std::lround(static_cast<double>(frame) * frame_dt_s / scene.frame_dt_s));
}

}  // namespace sim
