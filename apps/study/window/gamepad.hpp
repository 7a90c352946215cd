#pragma once
/// What is newly pressed on any gamepad, as keys of a page.

#include <array>
#include <vector>

#include "apps/study/desk/page.hpp"

namespace apps {

class Gamepad {
 public:
  /// Pressed since the last call. The cross points, A is Enter, B goes back, the shoulders go from question
  /// to question.
  std::vector<PageKey> take();
  /// Whatever is held down now counts for nothing.
  void forget() { take(); }

 private:
  std::array<std::array<bool, 16>, 16> down_{};  ///< [joystick][button]
};

}  // namespace apps
