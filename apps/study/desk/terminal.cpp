#include "apps/study/desk/terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace apps {

namespace {
constexpr int wait_ms = 100;
}

ConsoleTerminal::ConsoleTerminal(Console& console)
    : console_(console), terminal_in_(isatty(STDIN_FILENO) == 1), terminal_out_(isatty(STDERR_FILENO) == 1) {
  if (terminal_in_ && tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  } else {
    terminal_in_ = false;
  }
  thread_ = std::thread([this] { run(); });
}

ConsoleTerminal::~ConsoleTerminal() {
  stopping_ = true;
  thread_.join();
  if (terminal_in_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void ConsoleTerminal::run() {
  while (!stopping_) {
    read_keys();
    write_lines();
  }
  write_lines();
  if (terminal_out_ && !status_.empty()) std::fputc('\n', stderr);
}

void ConsoleTerminal::read_keys() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (input_ended_ || poll(&input, 1, wait_ms) <= 0) {
    if (input_ended_) std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    return;
  }
  char bytes[64];
  const ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
  if (count <= 0) input_ended_ = true;
  // Arrows and the like come as Esc and more: no key of the console.
  if (count > 1 && bytes[0] == 27) return;
  for (ssize_t i = 0; i < count; ++i) console_.key(bytes[i]);
}

void ConsoleTerminal::write_lines() {
  const auto lines = console_.take_lines();
  const std::string status = terminal_out_ ? console_.status() : std::string();
  if (lines.empty() && status == status_) return;
  const char* clear = terminal_out_ ? "\r\033[K" : "";
  for (const std::string& line : lines) {
    std::fprintf(stderr, "%s%s\n", clear, line.c_str());
    clear = "";
  }
  if (terminal_out_) std::fprintf(stderr, "\r\033[K%s", status.c_str());
  std::fflush(stderr);
  status_ = status;
}

}  // namespace apps
