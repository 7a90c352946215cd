#pragma once
/// The mouse over the picture as a gaze source. Its samples are recorded with the origin "mouse".

#include <functional>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/gaze.hpp"

namespace study {

/// start() adds a sample of the mouse's current position, and each mouse movement adds one, because the mouse
/// reports only changes. The window processes movements after each picture. Sample times are the times of
/// processing: the system's time stamps do not convert to the session's clock.
class MouseGaze final : public GazeSource {
 public:
  /// Position of the mouse in the picture; none: outside the picture.
  using Place = std::optional<GazePoint>;

  /// where_now: returns the position of the mouse; start() calls it.
  MouseGaze(std::function<Place()> where_now, const Clock& clock)
      : where_now_(std::move(where_now)), clock_(clock) {}

  GazeOrigin origin() const override { return GazeOrigin::Mouse; }
  void start() override;
  std::vector<GazeSample> take() override { return std::exchange(samples_, {}); }
  void stop() override;

  /// Call it when the mouse moved to `place`; none: the mouse left the picture.
  void moved(const Place& place);

 private:
  std::function<Place()> where_now_;
  const Clock& clock_;
  bool started_ = false;
  std::vector<GazeSample> samples_;
};

}  // namespace study
