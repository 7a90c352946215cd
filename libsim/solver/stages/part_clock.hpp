#pragma once
/// Timers for the parts of a frame, and for its passes.

#include <array>
#include <chrono>
#include <vector>

#include "libsim/exec/space.hpp"

namespace sim::SIM_BACKEND {

/// The parts of the paper's Table 2 to which stages are assigned.
enum class Part { Saliency, Levels, Activation, Solve, count };

/// Off until switched on. Waits for the device between parts.
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

  /// In the last frame.
  double milliseconds(Part part) const { return 1e3 * seconds_[static_cast<std::size_t>(part)]; }

 private:
  bool on_ = false;
  Part running_ = Part::count;
  std::chrono::steady_clock::time_point since_;
  std::array<double, static_cast<std::size_t>(Part::count)> seconds_{};
};

/// The same for each pass of a schedule, by its index.
class PassClock {
 public:
  /// Discards earlier measurements. 0 passes: off.
  void measure(std::size_t passes) {
    seconds_.assign(passes, 0);
    running_ = passes;
  }
  void start_frame() { seconds_.assign(seconds_.size(), 0); }
  void enter(std::size_t pass) {
    if (seconds_.empty()) return;
    synchronize();
    const auto now = std::chrono::steady_clock::now();
    if (running_ < seconds_.size()) seconds_[running_] += std::chrono::duration<double>(now - since_).count();
    running_ = pass;
    since_ = now;
  }
  void end_frame() { enter(seconds_.size()); }

  /// In the last frame; 0 while off.
  double milliseconds(std::size_t pass) const { return seconds_.empty() ? 0 : 1e3 * seconds_[pass]; }

 private:
  std::size_t running_ = 0;
  std::chrono::steady_clock::time_point since_;
  std::vector<double> seconds_;
};

}  // namespace sim::SIM_BACKEND
