#pragma once
/// Mean times of the schedule's passes for the window's panel. No window, no GL.

#include <deque>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace apps {

/// A row of the panel.
struct PassRow {
  std::string name, phase;
  std::string effect;  ///< word of the effect that the pass belongs to; empty if it belongs to none
  double ms = 0;       ///< per frame, mean over the last second
  double share = 0;    ///< of all passes, 0 to 1; 0 if they took no time
};

/// Times of the frames of the last second.
class PassMeans {
 public:
  static constexpr double span_s = 1;

  /// Adds the last frame's pass times and its total duration, s. A new schedule discards the old times.
  void push(const std::vector<sim::StageTime>& passes, double frame_s);
  void clear() { *this = {}; }
  /// In the schedule's order; none before the first frame.
  std::vector<PassRow> rows() const;
  /// Sum over all passes of a frame, mean over the last second.
  double total_ms() const;

 private:
  struct Frame {
    std::vector<double> ms;
    double seconds;
  };
  std::vector<sim::StageTime> passes_;
  std::deque<Frame> frames_;
  double seconds_ = 0;  ///< of all stored frames
};

}  // namespace apps
