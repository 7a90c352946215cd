#include "libstudy/pages/headset/terminal_keys.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace study {

namespace {

/// Escape sequences of terminals, without the leading Esc, and their events.
const std::pair<const char*, PageEvent> sequences[] = {
    {"[A", {.key = PageKey::Up, .lines = -1, .text_only = true}},
    {"[B", {.key = PageKey::Down, .lines = 1, .text_only = true}},
    {"[C", {.key = PageKey::Right}},
    {"[D", {.key = PageKey::Left}},
    {"[Z", {.key = PageKey::Previous}},
    {"[5~", {.key = PageKey::FarRight, .lines = -1}},
    {"[6~", {.key = PageKey::FarLeft, .lines = 1}},
    {"[1;2C", {.key = PageKey::FarRight}},
    {"[1;2D", {.key = PageKey::FarLeft}},
};

/// Length of the escape sequence at `at`, without the leading Esc; 0 if Esc was pressed alone.
std::size_t length_of(const std::string& typed, std::size_t at) {
  if (at >= typed.size() || (typed[at] != '[' && typed[at] != 'O')) return 0;
  std::size_t end = at + 1;
  while (end < typed.size() && (typed[end] < '@' || typed[end] > '~')) ++end;
  return std::min(end + 1, typed.size()) - at;
}

PageEvent event_of(char byte) {
  PageEvent event;
  const auto code = static_cast<unsigned char>(byte);
  if (byte == '\r' || byte == '\n' || byte == ' ') event.key = PageKey::Enter;
  if (byte == '\t') event.key = PageKey::Next;
  if (code == 8 || code == 127) event.key = PageKey::Erase;
  if (byte >= '0' && byte <= '9') event.digit = byte - '0';
  event.minus = byte == '-';
  if (code >= 32 && code != 127) event.letters = byte;
  return event;
}

}  // namespace

std::vector<PageEvent> page_events(const std::string& typed) {
  std::vector<PageEvent> events;
  for (std::size_t at = 0; at < typed.size(); ++at) {
    PageEvent event;
    if (typed[at] == 27) {
      std::string sequence = typed.substr(at + 1, length_of(typed, at + 1));
      event.stop = sequence.empty();
      at += sequence.size();
      if (!sequence.empty() && sequence[0] == 'O')
        sequence[0] = '[';  // some terminals send "O" for "[" with arrows
      for (const auto& [known, meant] : sequences) {
        if (sequence == known) event = meant;
      }
    } else {
      event = event_of(typed[at]);
    }
    event.pressed = !event.stop;
    events.push_back(event);
  }
  return events;
}

TerminalKeys::TerminalKeys() : terminal_(isatty(STDIN_FILENO) == 1) {
  if (!terminal_ || tcgetattr(STDIN_FILENO, &before_) != 0) {
    terminal_ = false;
    return;
  }
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

TerminalKeys::~TerminalKeys() {
  if (terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::vector<PageEvent> TerminalKeys::take() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (!terminal_ || poll(&input, 1, 0) <= 0) return {};
  std::array<char, 64> bytes{};
  const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) {
    terminal_ = false;
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    return {};
  }
  return page_events({bytes.data(), static_cast<std::size_t>(count)});
}

}  // namespace study
