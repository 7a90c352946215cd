#pragma once
/// Converts newly pressed buttons of any gamepad to keys of a page.

#include <array>
#include <vector>

#include "libstudy/pages/page.hpp"

namespace study {

class Gamepad {
 public:
  /// Keys pressed since the last call. The cross gives arrows, A Enter, B the previous question, the
  /// shoulders move between questions.
  std::vector<PageKey> take();
  /// Ignores all that is held down now.
  void forget() { take(); }

 private:
  std::array<std::array<bool, 16>, 16> down_{};  ///< [joystick][button]
};

}  // namespace study
