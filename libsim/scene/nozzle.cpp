#include "libsim/scene/nozzle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {

namespace {

/// Speed times the time for which the nozzle was open before `frame`: the length of its jet, m.
double length_before(const Nozzle& nozzle, std::int64_t frame, double frame_dt_s) {
  const std::int64_t cycle = nozzle.on_frames + nozzle.off_frames;
  const std::int64_t open =
      frame / cycle * nozzle.on_frames + std::min<std::int64_t>(frame % cycle, nozzle.on_frames);
  return static_cast<double>(open) * frame_dt_s * nozzle.speed_m_s;
}

/// Number of layers k = 0, 1, ... with (k + 1/2) pitch < length.
std::int64_t layers_within(double length, double pitch) {
  return static_cast<std::int64_t>(std::max(0.0, std::ceil(length / pitch - 0.5)));
}

}  // namespace

bool pours_into_another(const Nozzle& nozzle, const std::vector<Nozzle>& others, double frame_dt_s) {
  return std::any_of(others.begin(), others.end(), [&](const Nozzle& other) {
    const double apart =
        std::hypot(nozzle.position_m[0] - other.position_m[0], nozzle.position_m[2] - other.position_m[2]);
    const double above = nozzle.position_m[1] - other.position_m[1];
    return apart < (nozzle.diameter_m + other.diameter_m) / 2 &&
           std::abs(above) <= (above > 0 ? nozzle : other).speed_m_s * frame_dt_s;
  });
}

JetLayer jet_layer(const Nozzle& nozzle, double spacing_m) {
  const double area = std::numbers::pi / 4 * nozzle.diameter_m * nozzle.diameter_m;
  JetLayer out;
  out.sites = std::max(1, static_cast<int>(std::lround(area / (spacing_m * spacing_m))));
  out.pitch_m = spacing_m * spacing_m * spacing_m * out.sites / area;
  return out;
}

Poured poured_before(const Nozzle& nozzle, double spacing_m, int frame, double frame_dt_s) {
  const double pitch = jet_layer(nozzle, spacing_m).pitch_m;
  const std::int64_t layers = layers_within(length_before(nozzle, frame, frame_dt_s), pitch);
  return {static_cast<double>(layers) * pitch, layers};
}

LayersDue layers_due(const Nozzle& nozzle, double spacing_m, const Poured& before, int frame,
                     double frame_dt_s) {
  const double pitch = jet_layer(nozzle, spacing_m).pitch_m;
  const double begin = length_before(nozzle, frame, frame_dt_s);
  const double end = length_before(nozzle, frame + std::int64_t{1}, frame_dt_s);
  LayersDue out;
  out.interval_s = pitch / nozzle.speed_m_s;
  if (end > begin) out.count = static_cast<int>(layers_within(end - before.length_m, pitch));
  out.first_time_s = (before.length_m + pitch / 2 - begin) / nozzle.speed_m_s;
  return out;
}

}  // namespace sim
