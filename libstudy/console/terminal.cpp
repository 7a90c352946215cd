#include "libstudy/console/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "libstudy/console/console_text.hpp"
#include "stats/base/streams.hpp"

namespace study {

namespace {
constexpr int wait_ms = 100;
constexpr int usual_columns = 80, usual_rows = 24;  // if the terminal does not report its size
constexpr std::int64_t whole_ns = 1'000'000'000;
// Control sequences that open and close a terminal's alternate screen (xterm and compatible terminals).
constexpr const char* open_screen = "\033[?1049h";
constexpr const char* close_screen = "\033[?1049l";
}  // namespace

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
  if (terminal_out_) std::fputs(open_screen, stderr);
  while (!stopping_) {
    read_keys();
    write_lines();
  }
  write_lines();
  if (!terminal_out_) return;
  std::fputs(close_screen, stderr);
  for (const std::string& line : said_) std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
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
  // Ignores escape sequences, such as those of arrow keys, because no key of the console sends one.
  if (count > 1 && bytes[0] == 27) return;
  for (ssize_t i = 0; i < count; ++i) console_.key(bytes[i]);
}

void ConsoleTerminal::write_lines() {
  auto lines = console_.take_lines();
  for (std::string& line : lines) line = base::for_terminal(line);
  if (terminal_out_) {
    said_.insert(said_.end(), lines.begin(), lines.end());
    return draw();
  }
  for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.c_str());
  if (!lines.empty()) std::fflush(stderr);
}

/// Writes changed lines, and all lines once a second, in case another program wrote to the terminal.
void ConsoleTerminal::draw() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
    size.ws_col = usual_columns;
    size.ws_row = usual_rows;
  }
  const std::int64_t now_ns = steady_ns();
  std::string out;
  if (size.ws_col != columns_ || size.ws_row != rows_ || now_ns - drawn_whole_ns_ > whole_ns) {
    if (size.ws_col != columns_ || size.ws_row != rows_) out = "\033[2J";
    columns_ = size.ws_col;
    rows_ = size.ws_row;
    drawn_whole_ns_ = now_ns;
    drawn_.clear();
  }
  ConsoleView view = console_.view(now_ns);
  view.said = said_;
  auto lines = render_console(view, columns_, rows_);
  for (std::string& line : lines) line = base::for_terminal(line);  // replaces control characters
  drawn_.resize(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] != drawn_[i]) out += "\033[" + std::to_string(i + 1) + ";1H" + lines[i] + "\033[K";
  }
  if (out.empty()) return;
  drawn_ = std::move(lines);
  out += "\033[" + std::to_string(rows_) + ";1H" + drawn_.back();  // puts the cursor at the typed text
  std::fputs(out.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace study
