#include "libstudy/pages/window/participant_window.hpp"

// epoxy must come before GLFW: GLFW then does not include OpenGL's headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>

#include <optional>

#include "libsim/gl/gl_context.hpp"
#include "libstudy/pages/gui/page_surface.hpp"
#include "libstudy/session/session.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// The digit of a key on the main row or the keypad; -1 for any other key.
int digit_of(int key) {
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return key - GLFW_KEY_0;
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return key - GLFW_KEY_KP_0;
  return -1;
}

std::optional<PageKey> page_key(int key, bool shift) {
  switch (key) {
    case GLFW_KEY_LEFT:
      return shift ? PageKey::FarLeft : PageKey::Left;
    case GLFW_KEY_RIGHT:
      return shift ? PageKey::FarRight : PageKey::Right;
    case GLFW_KEY_PAGE_DOWN:
      return PageKey::FarLeft;
    case GLFW_KEY_PAGE_UP:
      return PageKey::FarRight;
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

/// Number of lines that a key scrolls down; 0 if it does not scroll.
float lines_of(int key) {
  if (key == GLFW_KEY_PAGE_DOWN || key == GLFW_KEY_DOWN) return 1;
  if (key == GLFW_KEY_PAGE_UP || key == GLFW_KEY_UP) return -1;
  return 0;
}

/// The letter of a key in the keyboard's layout, lower case; "" for any other key.
std::string letter_of(int key) {
  const char* name = glfwGetKeyName(key, 0);
  return name && name[0] >= 'a' && name[0] <= 'z' && name[1] == '\0' ? name : "";
}

PageEvent event_of(int key, bool shift) {
  PageEvent event;
  event.letters = letter_of(key);
  event.key = page_key(key, shift);
  event.digit = digit_of(key);
  event.minus = key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT;
  event.stop = key == GLFW_KEY_ESCAPE;
  event.pressed = !event.stop;
  event.lines = lines_of(key);
  event.text_only = key != GLFW_KEY_PAGE_DOWN && key != GLFW_KEY_PAGE_UP;
  return event;
}

WindowChoice as_window(const ParticipantWindowOptions& options) {
  return {"vip-study", options.width_px, options.height_px, options.monitor,
          "use --display headless or none on a machine without a screen"};
}

bool moves(std::optional<PageKey> key) {
  return key == PageKey::Left || key == PageKey::Right || key == PageKey::Up || key == PageKey::Down ||
         key == PageKey::FarLeft || key == PageKey::FarRight;
}

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

ParticipantWindow::Backend::Backend(GLFWwindow* window) { ImGui_ImplGlfw_InitForOpenGL(window, true); }
ParticipantWindow::Backend::~Backend() { ImGui_ImplGlfw_Shutdown(); }

ParticipantWindow::ParticipantWindow(const ParticipantWindowOptions& options)
    : window_(as_window(options)),
      size_(window_.size()),
      gui_(type_for_screen(size_.height), {ImGui_ImplGlfw_NewFrame, [] { return 0U; }}, options.characters),
      backend_(window_.get()) {
  sim::require_gl45();
  show_black();
}

void ParticipantWindow::poll(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  if (GlfwWindow::display_is_gone()) {
    throw base::Error("the participant's window",
                      "the connection to the X server is lost; all answers given are kept",
                      "restart the X server (the desktop) and continue with vip-study resume");
  }
  if (window_.asked_to_close()) {
    if (over_) throw Stopped();
    throw base::Error("the participant's window", "was closed; all answers given are kept",
                      "continue with vip-study resume");
  }
}

void ParticipantWindow::show_cursor(bool shown) {
  glfwSetInputMode(window_.get(), GLFW_CURSOR, shown ? GLFW_CURSOR_NORMAL : GLFW_CURSOR_HIDDEN);
}

void ParticipantWindow::forget_input() {
  glfwPollEvents();
  take_events();
  window_.take_minimised();
}

void ParticipantWindow::show_black() {
  show_cursor(false);
  gui_.begin(colour::black);
  gui_.end();
  glfwSwapBuffers(window_.get());
  if (mirror_) mirror_->take_black();
}

void ParticipantWindow::show() {
  if (mirror_) mirror_->take(0);
  glfwSwapBuffers(window_.get());
}

void ParticipantWindow::open_mirror(bool reveal) {
  mirror_ = std::make_unique<MirrorWindow>(window_, reveal);
  mirror_reveals_ = reveal;
}

void ParticipantWindow::mirror(unsigned framebuffer) {
  if (mirror_ && mirror_reveals_) mirror_->take_some(framebuffer);
}

std::vector<PageEvent> ParticipantWindow::take_events() {
  std::vector<PageEvent> events;
  const bool shift = glfwGetKey(window_.get(), GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
                     glfwGetKey(window_.get(), GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
  for (const int key : window_.take_keys()) events.push_back(event_of(key, shift));
  for (const int key : window_.take_repeats())
    if (const auto moved = page_key(key, shift); moves(moved))
      events.push_back({.key = moved, .lines = lines_of(key), .text_only = lines_of(key) != 0});
  unsigned down = 0;
  for (int button = 0; button <= GLFW_MOUSE_BUTTON_LAST; ++button)
    if (glfwGetMouseButton(window_.get(), button) == GLFW_PRESS) down |= 1U << static_cast<unsigned>(button);
  if (down & ~std::exchange(buttons_, down)) events.push_back({.pressed = true, .input = AnswerInput::Mouse});
  const auto by_gamepad = gamepad_.take();
  events.insert(events.end(), by_gamepad.begin(), by_gamepad.end());
  return events;
}

std::optional<std::pair<double, double>> ParticipantWindow::mouse() const {
  double x = 0, y = 0;
  if (!window_.mouse(x, y)) return {};
  return std::pair{x, y};
}

std::vector<PageEvent> Gamepad::take() {
  constexpr std::int64_t hold_ns = 400'000'000, again_ns = 60'000'000;
  const auto now_ns = static_cast<std::int64_t>(1e9 * glfwGetTime());
  std::vector<PageEvent> events;
  for (int joystick = GLFW_JOYSTICK_1; joystick <= GLFW_JOYSTICK_LAST; ++joystick) {
    GLFWgamepadstate state{};
    auto& down = down_[static_cast<std::size_t>(joystick)];
    const bool there = glfwGetGamepadState(joystick, &state) == GLFW_TRUE;
    for (std::size_t button = 0; button < buttons; ++button) {
      const std::size_t trigger = button - (GLFW_GAMEPAD_BUTTON_LAST + 1);
      const bool is_button = button <= GLFW_GAMEPAD_BUTTON_LAST;
      const bool now = there && (is_button ? state.buttons[button] == GLFW_PRESS
                                           : state.axes[GLFW_GAMEPAD_AXIS_LEFT_TRIGGER + trigger] > 0.5F);
      const auto key = key_of(static_cast<int>(button));
      const bool began = !std::exchange(down[button], now) && now;
      const bool repeats = now && !began && moves(key) && now_ns >= repeat_ns_;
      if (began || repeats) repeat_ns_ = now_ns + (began ? hold_ns : again_ns);
      if (began || repeats) events.push_back({.key = key, .pressed = began, .input = AnswerInput::Gamepad});
    }
  }
  return events;
}

}  // namespace study
