#include "libstudy/pages/mouse_gaze.hpp"

namespace study {

namespace {
bool on_picture(const GazePoint& point) {
  return point.first >= 0 && point.first < 1 && point.second >= 0 && point.second < 1;
}
}  // namespace

void MouseGaze::start() {
  samples_.clear();
  started_ = true;
  moved(where_now_());
}

void MouseGaze::stop() {
  started_ = false;
  samples_.clear();
}

void MouseGaze::moved(const Place& place) {
  if (!started_) return;
  GazeSample sample;
  sample.sampled_ns = clock_.now_ns();
  sample.valid = place && on_picture(*place);
  if (sample.valid) sample.point = place;
  samples_.push_back(sample);
}

}  // namespace study
