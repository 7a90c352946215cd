#pragma once
/// Targets that the participant looks at, to measure the quality of an eye tracker.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace study {

/// A gaze sample while a target is shown: directions of the gaze and the target in the same frame of
/// reference, x right, y up, z back.
struct TargetSample {
  bool valid = false;
  std::array<double, 3> gaze{}, target{};
};

/// Shows targets and records the gaze while they are shown. Calls come from the session's thread.
class GazeTargets {
 public:
  virtual ~GazeTargets() = default;
  /// Places the grid of targets straight ahead of the head's current pose.
  virtual void begin() = 0;
  /// Shows a target for settle_s + sample_s seconds and returns the samples of the last sample_s seconds.
  /// Angles are to the right and up from the middle of the grid. `check` is called often and may throw.
  virtual std::vector<TargetSample> look_at(double azimuth_deg, double elevation_deg, double settle_s,
                                            double sample_s, const std::function<void()>& check) = 0;
  /// Hides the targets.
  virtual void end() = 0;
};

/// Accuracy and precision at one target, degrees, as defined in eye tracking (Holmqvist et al. 2012).
struct GazeQuality {
  std::int64_t samples = 0, valid = 0;
  std::optional<double> accuracy_deg;  ///< angle from target to mean gaze; none: no valid sample
  std::optional<double> sd_deg;        ///< root mean square angle to the mean gaze; none: no valid sample
  /// Root mean square angle between successive valid samples; none: fewer than two.
  std::optional<double> rms_s2s_deg;
};

/// Computes accuracy and precision from directions relative to the target. The target may move in the
/// samples' frame, e.g. when the head moves.
GazeQuality gaze_quality(std::span<const TargetSample> samples);

}  // namespace study
