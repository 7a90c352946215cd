#pragma once
/// How long the parts of a frame take.

#include <array>
#include <chrono>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// What a stage is counted as in the paper's Table 2.
enum class Part { Saliency, Levels, Activation, Solve, count };

/// Off until it is switched on: it waits for the device wherever one part ends and another begins.
class PartClock {
 public:
  void switch_on() { on_ = true; }
  void start_frame() { seconds_.fill(0); }
  void enter(Part part) {
    if (!on_ || part == running_) return;
    synchronize();
    const auto now = std::chrono::steady_clock::now();
    if (running_ != Part::count) {
      seconds_[static_cast<std::size_t>(running_)] += std::chrono::duration<double>(now - since_).count();
    }
    running_ = part;
    since_ = now;
  }
  void end_frame() { enter(Part::count); }

  /// Of the last frame.
  double milliseconds(Part part) const { return 1e3 * seconds_[static_cast<std::size_t>(part)]; }

 private:
  bool on_ = false;
  Part running_ = Part::count;
  std::chrono::steady_clock::time_point since_;
  std::array<double, static_cast<std::size_t>(Part::count)> seconds_{};
};

}  // namespace sim::SIM_BACKEND
