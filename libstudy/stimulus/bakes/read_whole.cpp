#include "libstudy/stimulus/bakes/read_whole.hpp"
#include "stats/base/progress.hpp"

#include <algorithm>
#include <chrono>

namespace study {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Calls read(frame) for all frames; returns frames per second.
template <typename Read>
double read_all(const char* label, std::int64_t frames, const std::function<void()>& stop, Read read) {
  base::Progress progress(label, static_cast<std::size_t>(frames));
  const double start_s = seconds_now();
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    stop();
    read(frame);
    progress.update(static_cast<std::size_t>(frame + 1));
  }
  return static_cast<double>(frames) / std::max(1e-9, seconds_now() - start_s);
}

}  // namespace

ReadingSpeed read_whole(const sim::BakeReader& bake, const std::function<void()>& stop) {
  const std::int64_t frames = bake.header().frame_count;
  sim::BakeFrame frame;
  ReadingSpeed speed;
  speed.particles = read_all("particles", frames, stop, [&](auto i) {
    bake.read_frame(i, frame);
    speed.temperature_error_k = std::max(speed.temperature_error_k, frame.temperature_error_k);
  });
  if (!bake.header().has_pictures()) return speed;
  sim::PictureReader reader(bake);
  speed.pictures = read_all("pictures", frames, stop, [&](auto i) { reader.read(i); });
  return speed;
}

}  // namespace study
