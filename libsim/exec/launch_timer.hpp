#pragma once
/// Timer around each launch; off unless a bench switches it on. Included by space.hpp.

#include "libsim/exec/launch_time.hpp"

namespace sim::SIM_BACKEND {

/// Switches the profile of this back end on (discarding earlier measurements) or off.
void profile_launches(bool on);
/// One entry per label, longest first; waits for all launched work.
std::vector<LaunchTime> launch_times();

class LaunchTimer {
 public:
  explicit LaunchTimer(const char* label) {
    if (on) begin(label);
  }
  ~LaunchTimer() {
    if (on) end();
  }
  LaunchTimer(const LaunchTimer&) = delete;
  LaunchTimer& operator=(const LaunchTimer&) = delete;

 private:
  friend void profile_launches(bool);
  static void begin(const char* label);
  static void end();
  static bool on;
};

}  // namespace sim::SIM_BACKEND
