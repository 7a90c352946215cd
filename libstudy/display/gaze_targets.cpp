#include "libstudy/display/gaze_targets.hpp"

#include <cmath>
#include <numbers>

namespace study {

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector& v) {
  const double size = std::sqrt(dot(v, v));
  return size > 0 ? Vector{v[0] / size, v[1] / size, v[2] / size} : v;
}

/// The angle between two vectors, degrees; atan2 keeps small angles accurate.
double degrees_between(const Vector& a, const Vector& b) {
  const Vector across = cross(a, b);
  return std::atan2(std::sqrt(dot(across, across)), dot(a, b)) * 180 / std::numbers::pi;
}

/// The gaze direction in the target's frame: -z points to the target, and x stays horizontal.
Vector from_target(const TargetSample& sample) {
  const Vector ahead = unit(sample.target);
  const Vector right = unit(cross(ahead, {0, 1, 0}));
  const Vector up = cross(right, ahead);
  const Vector gaze = unit(sample.gaze);
  return {dot(right, gaze), dot(up, gaze), -dot(ahead, gaze)};
}

double root_mean(double sum, std::size_t count) { return std::sqrt(sum / static_cast<double>(count)); }

}  // namespace

GazeQuality gaze_quality(std::span<const TargetSample> samples) {
  std::vector<Vector> seen;
  for (const TargetSample& sample : samples) {
    if (sample.valid) seen.push_back(from_target(sample));
  }
  GazeQuality out;
  out.samples = static_cast<std::int64_t>(samples.size());
  out.valid = static_cast<std::int64_t>(seen.size());
  if (seen.empty()) return out;
  Vector mean{};
  for (const Vector& one : seen) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] += one[k];
  }
  mean = unit(mean);
  double from_mean = 0, steps = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    from_mean += std::pow(degrees_between(seen[i], mean), 2);
    if (i > 0) steps += std::pow(degrees_between(seen[i], seen[i - 1]), 2);
  }
  out.accuracy_deg = degrees_between(mean, {0, 0, -1});
  out.sd_deg = root_mean(from_mean, seen.size());
  if (seen.size() > 1) out.rms_s2s_deg = root_mean(steps, seen.size() - 1);
  return out;
}

}  // namespace study
