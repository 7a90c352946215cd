#pragma once
/// Mean times of the passes of the schedule (the solver's steps in a frame, in order) for the window's panel.
/// The code needs no window and no GL.

#include <deque>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace apps {

/// A row of the panel: one pass of the schedule.
struct PassRow {
  std::string name, phase;
  std::string effect;  ///< name of the effect that the pass computes; empty for a pass of the solver itself
  double ms = 0;       ///< time per frame, mean over the last second
  double share = 0;    ///< part of the time of all passes, 0 to 1; 0 if they took no time
};

/// Pass times of the frames of the last second.
class PassMeans {
 public:
  static constexpr double span_s = 1;

  /// Adds the last frame's pass times and its total duration, s. A new schedule discards the old times.
  void push(const std::vector<sim::StageTime>& passes, double frame_s);
  void clear() { *this = {}; }
  /// The passes in the schedule's order, with their mean times; empty before the first frame.
  std::vector<PassRow> rows() const;
  /// Time of all passes together, per frame, mean over the last second.
  double total_ms() const;

 private:
  struct Frame {
    std::vector<double> ms;
    double seconds;
  };
  std::vector<sim::StageTime> passes_;
  std::deque<Frame> frames_;
  double seconds_ = 0;
};

}  // namespace apps
