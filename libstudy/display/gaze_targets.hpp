#pragma once
/// Targets that somebody is asked to look at, so that it is known how well an eye tracker does.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace study {

/// A sample of the eyes while a target is shown: unit vectors in one frame, x right, y up, z back.
struct TargetSample {
  bool valid = false;
  std::array<double, 3> gaze{}, target{};
};

/// Shows targets and reads the eyes meanwhile. Calls come from the session's thread.
class GazeTargets {
 public:
  virtual ~GazeTargets() = default;
  /// The grid of targets stands straight ahead of how the head is now.
  virtual void begin() = 0;
  /// Shows a target at these angles from the middle of the grid, to the right and up, and gives the samples
  /// of the last sample_s of settle_s + sample_s. `check` is called often, and may throw.
  virtual std::vector<TargetSample> look_at(double azimuth_deg, double elevation_deg, double settle_s,
                                            double sample_s, const std::function<void()>& check) = 0;
  /// No target is shown any more.
  virtual void end() = 0;
};

/// Accuracy and precision at one target, degrees, as eye tracking has them (Holmqvist et al. 2012).
struct GazeQuality {
  std::int64_t samples = 0, valid = 0;
  std::optional<double> accuracy_deg;  ///< of the mean direction of the valid samples; none: no valid sample
  std::optional<double> sd_deg;        ///< root mean square of the angles to that mean; none: likewise
  std::optional<double>
      rms_s2s_deg;  ///< of the angles between successive valid samples; none: fewer than two
};

/// The target may move in the samples' frame, as where the head moves: directions are taken from it.
GazeQuality gaze_quality(std::span<const TargetSample> samples);

}  // namespace study
