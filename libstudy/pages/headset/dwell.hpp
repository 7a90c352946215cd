#pragma once
/// Lets a participant choose a target (button) by looking at it for a second.

#include <cstdint>

namespace study {

class Dwell {
 public:
  static constexpr std::int64_t whole_ns = 1'000'000'000;
  /// Shortest gap in the tracking of the eyes that restarts the dwell. A shorter gap, such as a blink, only
  /// pauses the dwell.
  static constexpr std::int64_t blink_ns = 300'000'000;

  /// target: the target looked at since the last call, 0 for none. seen: true if the direction of the gaze is
  /// known. Returns true once the target was looked at for whole_ns. To choose the same target again, the
  /// gaze must first leave the target.
  bool look(unsigned target, bool seen, std::int64_t now_ns);
  /// Fraction of whole_ns spent on the current target, 0 to 1; 0 once it was chosen.
  float progress() const;
  void reset() { *this = {}; }

 private:
  unsigned target_ = 0;
  bool chosen_ = false;
  std::int64_t gone_ns_ = 0;  ///< time spent on the current target
  std::int64_t last_ns_ = -1, seen_ns_ = -1;
};

}  // namespace study
