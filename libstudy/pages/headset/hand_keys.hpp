#pragma once
/// Converts a controller's stick and buttons to keys of a page.

#include <cstdint>
#include <vector>

#include "libstudy/headset/headset_session.hpp"
#include "libstudy/pages/gui/page_surface.hpp"

namespace study {

class HandKeys {
 public:
  static constexpr std::int64_t long_press_ns = 1'000'000'000;  ///< of menu: opens the stop dialog
  /// A held stick repeats after hold_ns, then every again_ns.
  static constexpr std::int64_t hold_ns = 500'000'000, again_ns = 150'000'000;

  /// Events newly pressed in this slot. Without `stick`, only long presses.
  std::vector<PageEvent> take(const HeadsetHands& hands, bool stick, std::int64_t now_ns);
  /// Ignores all that is held down now until it is released.
  void forget();

 private:
  std::optional<PageKey> push(const HeadsetHands& hands, std::int64_t now_ns);

  std::optional<PageKey> pushed_;
  bool locked_ = false;        ///< the stick must be released first
  std::int64_t next_ns_ = 0;   ///< when a held stick repeats
  std::int64_t menu_ns_ = -1;  ///< when menu was pressed; -1: it is not
  bool menu_done_ = false;
};

}  // namespace study
