#include "libsim/scene/nozzle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {

namespace {

std::int64_t frames_open(const Nozzle& nozzle, std::int64_t frame) {
  const std::int64_t cycle = nozzle.on_frames + nozzle.off_frames;
  return frame / cycle * nozzle.on_frames + std::min<std::int64_t>(frame % cycle, nozzle.on_frames);
}

}  // namespace

JetLayer jet_layer(const Nozzle& nozzle, double spacing_m) {
  const double area = std::numbers::pi / 4 * nozzle.diameter_m * nozzle.diameter_m;
  JetLayer out;
  out.sites = std::max(1, static_cast<int>(std::lround(area / (spacing_m * spacing_m))));
  out.pitch_m = spacing_m * spacing_m * spacing_m * out.sites / area;
  return out;
}

LayersDue layers_due(const Nozzle& nozzle, double spacing_m, int frame, double frame_dt_s) {
  const double interval = jet_layer(nozzle, spacing_m).pitch_m / nozzle.speed_m_s;
  // Layers k with (k + 1/2) interval < t, for the open time t at a frame's start.
  const auto passed = [&](std::int64_t at) {
    const double open = static_cast<double>(frames_open(nozzle, at)) * frame_dt_s;
    return static_cast<std::int64_t>(std::ceil(open / interval - 0.5));
  };
  LayersDue out;
  out.first = passed(frame);
  out.count = static_cast<int>(passed(frame + std::int64_t{1}) - out.first);
  const double open = static_cast<double>(frames_open(nozzle, frame)) * frame_dt_s;
  out.first_time_s = (static_cast<double>(out.first) + 0.5) * interval - open;
  out.interval_s = interval;
  return out;
}

}  // namespace sim
