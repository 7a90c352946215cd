#pragma once
/// A controller's stick and buttons as keys of a page.

#include <cstdint>
#include <vector>

#include "apps/common/headset/input.hpp"
#include "apps/study/pages/page_surface.hpp"

namespace apps {

class HandKeys {
 public:
  static constexpr std::int64_t long_press_ns = 1'000'000'000;  ///< of menu: asks whether to stop
  /// A stick that is held pushes again after the first of these, then at each of the second.
  static constexpr std::int64_t hold_ns = 500'000'000, again_ns = 150'000'000;

  /// What was newly pressed in this slot. Without the stick, long presses alone.
  std::vector<PageEvent> take(const HeadsetHands& hands, bool stick, std::int64_t now_ns);
  /// Whatever is held down now counts for nothing until it is let go.
  void forget();

 private:
  std::optional<PageKey> push(const HeadsetHands& hands, std::int64_t now_ns);

  std::optional<PageKey> pushed_;
  bool locked_ = false;        ///< the stick is to be let go first
  std::int64_t next_ns_ = 0;   ///< when a held stick pushes again
  std::int64_t menu_ns_ = -1;  ///< since when menu is pressed
  bool menu_done_ = false;
};

}  // namespace apps
