#pragma once
/// Choosing by looking at something for a while.

#include <cstdint>

namespace apps {

class Dwell {
 public:
  static constexpr std::int64_t whole_ns = 1'000'000'000;
  /// A blink pauses it; the eyes lost for longer begin it anew.
  static constexpr std::int64_t blink_ns = 300'000'000;

  /// What is looked at since the last call, 0 for nothing; seen: the eyes are tracked. True once a target was
  /// looked at for long enough; it must then be left before it is chosen again.
  bool look(unsigned target, bool seen, std::int64_t now_ns);
  /// Of the present target, 0 to 1.
  float progress() const;
  void reset() { *this = {}; }

 private:
  unsigned target_ = 0;
  bool chosen_ = false;
  std::int64_t gone_ns_ = 0;  ///< over of the present target's time
  std::int64_t last_ns_ = -1, seen_ns_ = -1;
};

}  // namespace apps
