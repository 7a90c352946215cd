#include "libstudy/pages/headset/hand_keys.hpp"

#include <cmath>

namespace study {

namespace {

constexpr float pushed_at = 0.6F, let_go_at = 0.3F;

PageKey key_of(float right, float up) {
  if (std::abs(right) >= std::abs(up)) return right > 0 ? PageKey::Right : PageKey::Left;
  return up > 0 ? PageKey::Up : PageKey::Down;
}

}  // namespace

std::optional<PageKey> HandKeys::push(const HeadsetHands& hands, std::int64_t now_ns) {
  const auto [right, up] = hands.stick;
  const float far = std::max(std::abs(right), std::abs(up));
  if (far < let_go_at) {
    pushed_.reset();
    locked_ = false;
  }
  if (locked_ || far < pushed_at) return {};
  if (pushed_ && now_ns < next_ns_) return {};
  next_ns_ = now_ns + (pushed_ ? again_ns : hold_ns);
  if (!pushed_) pushed_ = key_of(right, up);
  return pushed_;
}

std::vector<PageEvent> HandKeys::take(const HeadsetHands& hands, bool stick, std::int64_t now_ns) {
  std::vector<PageEvent> events;
  if (const auto key = push(hands, now_ns); key && stick) {
    const float lines = key == PageKey::Down ? 1.0F : key == PageKey::Up ? -1.0F : 0.0F;
    events.push_back({.key = key, .lines = lines, .text_only = true, .input = AnswerInput::Stick});
  }
  if (!hands.menu) {
    menu_ns_ = -1;
    menu_done_ = false;
  } else if (menu_ns_ < 0) {
    menu_ns_ = now_ns;
  } else if (!menu_done_ && now_ns - menu_ns_ >= long_press_ns) {
    menu_done_ = true;
    events.push_back({.stop = true});
  }
  return events;
}

void HandKeys::forget() {
  pushed_.reset();
  locked_ = true;
  menu_done_ = menu_ns_ >= 0;
}

}  // namespace study
