#include "apps/study/window/page_keys.hpp"

#include <GLFW/glfw3.h>

namespace apps {

int digit_of(int key) {
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return key - GLFW_KEY_0;
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return key - GLFW_KEY_KP_0;
  return -1;
}

std::optional<PageKey> page_key(int key, bool shift) {
  switch (key) {
    case GLFW_KEY_LEFT:
      return PageKey::Left;
    case GLFW_KEY_RIGHT:
      return PageKey::Right;
    case GLFW_KEY_UP:
      return PageKey::Up;
    case GLFW_KEY_DOWN:
      return PageKey::Down;
    case GLFW_KEY_TAB:
      return shift ? PageKey::Previous : PageKey::Next;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
    case GLFW_KEY_SPACE:
      return PageKey::Enter;
    case GLFW_KEY_BACKSPACE:
      return PageKey::Erase;
    default:
      return {};
  }
}

float lines_of(int key) {
  if (key == GLFW_KEY_PAGE_DOWN || key == GLFW_KEY_DOWN) return 1;
  if (key == GLFW_KEY_PAGE_UP || key == GLFW_KEY_UP) return -1;
  return 0;
}

}  // namespace apps
