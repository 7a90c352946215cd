#include "libstudy/pages/window/page_keys.hpp"

#include <GLFW/glfw3.h>

namespace study {

namespace {

/// 0 to 9 on the main row or the keypad; -1: another key.
int digit_of(int key) {
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return key - GLFW_KEY_0;
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return key - GLFW_KEY_KP_0;
  return -1;
}

/// The page key; none if the key has no meaning on a page.
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

/// Lines that a key scrolls down; 0 if none.
float lines_of(int key) {
  if (key == GLFW_KEY_PAGE_DOWN || key == GLFW_KEY_DOWN) return 1;
  if (key == GLFW_KEY_PAGE_UP || key == GLFW_KEY_UP) return -1;
  return 0;
}

}  // namespace

PageEvent event_of(int key, bool shift) {
  PageEvent event;
  event.key = page_key(key, shift);
  event.digit = digit_of(key);
  event.minus = key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT;
  event.stop = key == GLFW_KEY_ESCAPE;
  event.lines = lines_of(key);
  event.text_only = key != GLFW_KEY_PAGE_DOWN && key != GLFW_KEY_PAGE_UP;
  return event;
}

}  // namespace study
