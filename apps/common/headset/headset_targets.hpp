#pragma once
#include <optional>
#include <vector>
/// Targets that stand in the world of a headset, on its page, for the validation of its eye tracker.

#include "apps/common/headset/headset_display.hpp"
#include "libstudy/display/gaze_targets.hpp"

namespace apps {

/// Needs a display with a page and an eye tracker, and outlives neither.
class HeadsetTargets final : public study::GazeTargets {
 public:
  explicit HeadsetTargets(HeadsetDisplay& display) : display_(display) {}

  void begin() override;
  std::vector<study::TargetSample> look_at(double azimuth_deg, double elevation_deg, double settle_s,
                                           double sample_s, const std::function<void()>& check) override;
  void end() override { display_.hide_page(); }

 private:
  void draw();
  /// None where it was not seen all the time.
  std::optional<std::vector<study::TargetSample>> look_once(const HeadsetPage& page, double settle_s,
                                                            double sample_s,
                                                            const std::function<void()>& check);

  HeadsetDisplay& display_;
  HeadsetPose middle_;  ///< the head as it was at begin(), or when the world's origin had moved
  int world_ = 0;       ///< of it
};

/// Where a target at these angles from straight ahead of a head stands, facing it.
HeadsetPage target_page(const HeadsetPose& head, double azimuth_deg, double elevation_deg);

}  // namespace apps
