#pragma once
/// The mouse over the picture as a gaze source, recorded as a mouse.

#include <functional>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/gaze.hpp"

namespace study {

/// Gives a sample at the start of a presentation and one for each mouse movement that the window processes:
/// the mouse reports only changes, and the window polls after each picture. The system has no time stamp that
/// could be converted to the session's clock.
class MouseGaze final : public GazeSource {
 public:
  /// Position of the mouse; none: not over the picture.
  using Place = std::optional<GazePoint>;

  /// where_now: called at each start.
  MouseGaze(std::function<Place()> where_now, const Clock& clock)
      : where_now_(std::move(where_now)), clock_(clock) {}

  GazeOrigin origin() const override { return GazeOrigin::Mouse; }
  void start() override;
  std::vector<GazeSample> take() override { return std::exchange(samples_, {}); }
  void stop() override;

  /// The mouse moved to `place` or left the picture.
  void moved(const Place& place);

 private:
  std::function<Place()> where_now_;
  const Clock& clock_;
  bool started_ = false;
  std::vector<GazeSample> samples_;
};

}  // namespace study
