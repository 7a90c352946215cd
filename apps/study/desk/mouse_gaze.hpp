#pragma once
/// The mouse over the picture as a source of gaze, marked as what it is.

#include <functional>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/gaze.hpp"

namespace apps {

/// A sample when a presentation starts, and one whenever the window takes in that the mouse moved: the mouse
/// tells changes alone, and the window hears of them after each picture. The system gives no time stamp of
/// its own that could be told on the session's clock.
class MouseGaze final : public study::GazeSource {
 public:
  /// Where the mouse is; none: not over the picture.
  using Place = std::optional<study::GazePoint>;

  /// where_now: asked at each start.
  MouseGaze(std::function<Place()> where_now, const study::Clock& clock)
      : where_now_(std::move(where_now)), clock_(clock) {}

  study::GazeOrigin origin() const override { return study::GazeOrigin::Mouse; }
  void start() override;
  std::vector<study::GazeSample> take() override { return std::exchange(samples_, {}); }
  void stop() override;

  /// It moved to a place, or away from the picture.
  void moved(const Place& place);

 private:
  std::function<Place()> where_now_;
  const study::Clock& clock_;
  bool started_ = false;
  std::vector<study::GazeSample> samples_;
};

}  // namespace apps
