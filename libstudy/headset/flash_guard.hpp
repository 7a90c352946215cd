#pragma once
/// Protects the participant's eyes: what a headset shows neither flashes nor stands still for long.

#include <algorithm>
#include <array>
#include <cstdint>

namespace study {

/// Light may follow black at most this often within a second: the limit for flashes of WCAG 2.2, criterion
/// 2.3.1.
inline constexpr std::size_t most_flashes = 3;

/// Keeps a headset's content from flashing, whatever makes it come and go.
class FlashGuard {
 public:
  /// Call it for each slot. lit: the slot has a picture or a page. False: the slot must be black, because
  /// light would follow black a fourth time within a second.
  bool admit(std::int64_t at_ns, bool lit) {
    constexpr std::int64_t second_ns = 1'000'000'000;
    if (lit && !lit_) {
      if (count_ >= most_flashes && at_ns - onsets_ns_[count_ % most_flashes] < second_ns) return false;
      onsets_ns_[count_++ % most_flashes] = at_ns;
    }
    lit_ = lit;
    return true;
  }

 private:
  bool lit_ = false;
  std::size_t count_ = 0;                               ///< how often light followed black
  std::array<std::int64_t, most_flashes> onsets_ns_{};  ///< the latest times of that, as a ring
};

/// Factor on the levels of a picture that has been on for held_s, [0, 1]. A picture that stays on for over
/// 2 s means that the program hangs. It then fades to black within .3 s: no person should stay in a frozen
/// world.
inline float light_of_held(double held_s) {
  constexpr double most_held_s = 2, fade_s = 0.3;
  return static_cast<float>(std::clamp(1 - (held_s - most_held_s) / fade_s, 0.0, 1.0));
}

}  // namespace study
