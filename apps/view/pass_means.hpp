#pragma once
/// What each pass of the schedule takes, as the window's panel shows it. No window, no GL.

#include <deque>
#include <string>
#include <vector>

#include "libsim/simulation.hpp"

namespace apps {

/// A row of the panel.
struct PassRow {
  std::string name, phase;
  std::string effect;  ///< its word; empty where every scene may have the pass
  double ms = 0;       ///< a frame, mean over the last second
  double share = 0;    ///< of all passes, 0 to 1; 0 where they took no time
};

/// Times of the frames of the last second.
class PassMeans {
 public:
  static constexpr double span_s = 1;

  /// Takes the last frame's times, and how long the whole frame was, s. A new schedule forgets the old one.
  void push(const std::vector<sim::StageTime>& passes, double frame_s);
  void clear() { *this = {}; }
  /// In the schedule's order; none before the first frame.
  std::vector<PassRow> rows() const;
  /// All passes of a frame together, mean over the last second.
  double total_ms() const;

 private:
  struct Frame {
    std::vector<double> ms;
    double seconds;
  };
  std::vector<sim::StageTime> passes_;
  std::deque<Frame> frames_;
  double seconds_ = 0;  ///< of all frames that are kept
};

}  // namespace apps
