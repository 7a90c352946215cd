#pragma once
/// Converts the stick and the menu button of hand controllers to events of a page.

#include <cstdint>
#include <vector>

#include "libstudy/headset/headset_session.hpp"
#include "libstudy/pages/gui/page_surface.hpp"

namespace study {

class HandKeys {
 public:
  static constexpr std::int64_t long_press_ns =
      1'000'000'000;  ///< a menu button held this long opens the stop dialog
  /// A stick that stays pushed repeats its key after hold_ns, then every again_ns.
  static constexpr std::int64_t hold_ns = 500'000'000, again_ns = 150'000'000;

  /// Returns the events that begin in this slot (frame of the headset), whose time is now_ns. stick = false:
  /// only the event that opens the stop dialog.
  std::vector<PageEvent> take(const HeadsetHands& hands, bool stick, std::int64_t now_ns);
  /// Ignores the stick and the menu button until they are released.
  void forget();

 private:
  std::optional<PageKey> push(const HeadsetHands& hands, std::int64_t now_ns);

  std::optional<PageKey> pushed_;
  bool locked_ = false;        ///< the stick must be released first
  std::int64_t next_ns_ = 0;   ///< time at which a pushed stick repeats its key
  std::int64_t menu_ns_ = -1;  ///< time at which the menu button was pressed; -1: not pressed
  bool menu_done_ = false;
};

}  // namespace study
