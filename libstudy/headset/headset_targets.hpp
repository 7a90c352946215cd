#pragma once
/// Targets for the validation of a headset's eye tracker, shown as a page at fixed positions of the world.

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libstudy/display/gaze_targets.hpp"
#include "libstudy/headset/headset_display.hpp"
#include "libstudy/headset/outside_eyes.hpp"

namespace study {

/// Shows targets in a headset. Needs a display with a page, and an eye tracker: the runtime's, or one outside
/// OpenXR. The display must outlive this object.
class HeadsetTargets final : public GazeTargets {
 public:
  /// outside: an eye tracker outside OpenXR; null: the runtime's.
  explicit HeadsetTargets(HeadsetDisplay& display, std::shared_ptr<EyeTracker> outside = nullptr)
      : display_(display), outside_(std::move(outside)) {}

  void begin() override;
  std::vector<TargetSample> look_at(double azimuth_deg, double elevation_deg, double settle_s,
                                    double sample_s, const std::function<void()>& check) override;
  void end() override;

 private:
  void draw();
  /// Shows the target once and returns the samples; none if the target was not visible all the time.
  std::optional<std::vector<TargetSample>> look_once(const HeadsetPage& page, double settle_s,
                                                     double sample_s, const std::function<void()>& check);

  /// The records of the last slots; with a tracker outside OpenXR, a record for each of its samples.
  std::vector<HeadsetRecord> take_records();

  HeadsetDisplay& display_;
  std::shared_ptr<EyeTracker> outside_;
  OutsideEyes eyes_;
  HeadsetPose middle_;  ///< the head's pose at begin(), or after the world's origin moved
  int world_ = 0;       ///< HeadsetRecord::world at middle_; changes when the world's origin may have moved
};

/// The page of a target that faces the head, at angles to the right and up from straight ahead of the head.
HeadsetPage target_page(const HeadsetPose& head, double azimuth_deg, double elevation_deg);

}  // namespace study
