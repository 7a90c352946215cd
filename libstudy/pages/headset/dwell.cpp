#include "libstudy/pages/headset/dwell.hpp"

#include <algorithm>

namespace study {

bool Dwell::look(unsigned target, bool seen, std::int64_t now_ns) {
  const std::int64_t step_ns = last_ns_ < 0 ? 0 : now_ns - last_ns_;
  last_ns_ = now_ns;
  if (!seen) {
    if (now_ns - seen_ns_ >= blink_ns) reset();
    return false;
  }
  seen_ns_ = now_ns;
  if (target != target_) {
    target_ = target;
    gone_ns_ = 0;
    chosen_ = false;
    return false;
  }
  if (target_ == 0 || chosen_) return false;
  gone_ns_ += step_ns;
  chosen_ = gone_ns_ >= whole_ns;
  return chosen_;
}

float Dwell::progress() const {
  if (chosen_ || target_ == 0) return 0;
  return std::min(1.0F, static_cast<float>(gone_ns_) / static_cast<float>(whole_ns));
}

}  // namespace study
