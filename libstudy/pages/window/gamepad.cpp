#include "libstudy/pages/window/gamepad.hpp"

// epoxy first: GLFW then leaves GL's headers alone.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <optional>

namespace study {

namespace {

std::optional<PageKey> key_of(int button) {
  switch (button) {
    case GLFW_GAMEPAD_BUTTON_DPAD_LEFT:
      return PageKey::Left;
    case GLFW_GAMEPAD_BUTTON_DPAD_RIGHT:
      return PageKey::Right;
    case GLFW_GAMEPAD_BUTTON_DPAD_UP:
      return PageKey::Up;
    case GLFW_GAMEPAD_BUTTON_DPAD_DOWN:
      return PageKey::Down;
    case GLFW_GAMEPAD_BUTTON_A:
      return PageKey::Enter;
    case GLFW_GAMEPAD_BUTTON_B:
    case GLFW_GAMEPAD_BUTTON_LEFT_BUMPER:
      return PageKey::Previous;
    case GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER:
      return PageKey::Next;
    default:
      return {};
  }
}

}  // namespace

std::vector<PageKey> Gamepad::take() {
  std::vector<PageKey> pressed;
  for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; ++joystick) {
    GLFWgamepadstate state{};
    auto& down = down_[static_cast<std::size_t>(joystick)];
    const bool there = glfwGetGamepadState(joystick, &state) == GLFW_TRUE;
    for (int button = 0; button <= GLFW_GAMEPAD_BUTTON_LAST; ++button) {
      const bool now = there && state.buttons[button] == GLFW_PRESS;
      bool& before = down[static_cast<std::size_t>(button)];
      const auto key = key_of(button);
      if (now && !before && key) pressed.push_back(*key);
      before = now;
    }
  }
  return pressed;
}

}  // namespace study
