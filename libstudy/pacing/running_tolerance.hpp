#pragma once
/// tau as a solver sees it while frames are shown.

#include <cstdint>

#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace study {

/// tau = mu - a exp(b delta) over the last 30 intervals between submitted frames (Eq. 11).
class RunningTolerance {
 public:
  explicit RunningTolerance(const stats::PtpeModel& model) : model_(model) {}

  /// Takes a frame's submission, ns on the session's clock, and gives the tau that its preparation could
  /// know, frames/s: of the intervals that ended before it. 0 for the first two frames of a trial, which no
  /// interval precedes. An interval that is not positive (a display that gives two frames one instant) is
  /// left out of the window.
  double next(std::int64_t submitted_ns);

 private:
  stats::PtpeModel model_;
  stats::FpsWindow window_;
  std::int64_t last_ns_ = -1;
};

}  // namespace study
