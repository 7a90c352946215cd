#pragma once
/// Chooses a target by looking at it for a while.

#include <cstdint>

namespace study {

class Dwell {
 public:
  static constexpr std::int64_t whole_ns = 1'000'000'000;
  /// A shorter gap (a blink) pauses the dwell; a longer one restarts it.
  static constexpr std::int64_t blink_ns = 300'000'000;

  /// target: looked at since the last call, 0 for none; seen: the eyes are tracked. True once a target was
  /// looked at for long enough; it must then be left before it can be chosen again.
  bool look(unsigned target, bool seen, std::int64_t now_ns);
  /// Progress at the current target, 0 to 1.
  float progress() const;
  void reset() { *this = {}; }

 private:
  unsigned target_ = 0;
  bool chosen_ = false;
  std::int64_t gone_ns_ = 0;  ///< time spent on the current target
  std::int64_t last_ns_ = -1, seen_ns_ = -1;
};

}  // namespace study
