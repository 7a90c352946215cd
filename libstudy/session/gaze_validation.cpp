#include "libstudy/session/gaze_validation.hpp"

#include <array>
#include <cstdio>

#include "stats/base/error.hpp"

namespace study {

namespace {

/// Time for a saccade and for the eyes to settle, then for the samples.
constexpr double settle_s = 0.8, sample_s = 1;

/// Targets on a grid from -1 to 1, the middle first, then neighbours: jumps between corners take longer.
constexpr std::array<std::array<int, 2>, 9> grid{
    {{0, 0}, {-1, 1}, {0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}}};

class Targets {
 public:
  explicit Targets(GazeTargets& targets) : targets_(targets) { targets_.begin(); }
  ~Targets() { targets_.end(); }
  Targets(const Targets&) = delete;
  Targets& operator=(const Targets&) = delete;

 private:
  GazeTargets& targets_;
};

std::vector<ValidatedPoint> look_at_all(const Running& run, const Block& block, const Check& check) {
  const Targets shown(*run.parts.targets);
  std::vector<ValidatedPoint> points;
  for (const auto& [x, y] : grid) {
    ValidatedPoint point;
    point.azimuth_deg = x * block.extent_deg;
    point.elevation_deg = y * block.extent_deg;
    const auto samples =
        run.parts.targets->look_at(point.azimuth_deg, point.elevation_deg, settle_s, sample_s, check);
    point.clock_ns = run.now_ns() - static_cast<std::int64_t>(sample_s * 1e9);
    const GazeQuality quality = gaze_quality(samples);
    point.samples = quality.samples;
    point.valid = quality.valid;
    point.accuracy_deg = quality.accuracy_deg;
    point.sd_deg = quality.sd_deg;
    point.rms_s2s_deg = quality.rms_s2s_deg;
    points.push_back(point);
  }
  return points;
}

/// None if a target had no valid sample.
std::optional<double> mean_accuracy(const std::vector<ValidatedPoint>& points) {
  double sum = 0;
  for (const ValidatedPoint& point : points) {
    if (!point.accuracy_deg) return {};
    sum += *point.accuracy_deg;
  }
  return sum / static_cast<double>(points.size());
}

std::string in_degrees(const char* form, double value) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

}  // namespace

void validate_gaze(const Running& run, const Block& block, const Check& check) {
  Store& store = run.parts.store;
  if (!run.parts.targets || !store.allows_gaze(run.session.id)) {
    store.log(run.session.id, "gaze not validated",
              run.parts.targets ? "recording gaze is not allowed" : "no eye tracker is read", run.now_ns());
    return;
  }
  std::optional<double> mean;
  for (int tries = 0; tries < block.count; ++tries) {
    const auto points = look_at_all(run, block, check);
    mean = mean_accuracy(points);
    const bool passed = mean && (!block.max_accuracy_deg || *mean <= *block.max_accuracy_deg);
    store.add_validation(run.session.id, points, passed);
    if (passed) return;
  }
  throw base::Error("block " + block.id,
                    mean ? in_degrees("the eye tracker is off by %.2f degrees in the mean, ", *mean) +
                               in_degrees("more than the protocol's %.2f", block.max_accuracy_deg.value_or(0))
                         : "the eye tracker does not see the eyes at every target",
                    "calibrate it in the headset's software and continue with vip-study resume");
}

}  // namespace study
