#pragma once
/// Runs the console in the terminal that started the program: shows the console's screen (console_screen.hpp)
/// and reads keys as they are pressed. Runs on a separate thread: a slow terminal delays no frame.

#include <termios.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "libstudy/console/console.hpp"

namespace study {

/// Reads standard input and writes to standard error. If standard input is no terminal, its bytes are still
/// read as keys. If standard error is no terminal, messages are written as lines without a screen. When the
/// screen closes, all messages are printed below the terminal's former content. Ctrl-C works as usual.
class ConsoleTerminal {
 public:
  explicit ConsoleTerminal(Console& console);
  ~ConsoleTerminal();
  ConsoleTerminal(const ConsoleTerminal&) = delete;
  ConsoleTerminal& operator=(const ConsoleTerminal&) = delete;

 private:
  void run();
  void read_keys();
  void write_lines();
  void draw();

  Console& console_;
  bool terminal_in_ = false, terminal_out_ = false;
  termios before_{};
  bool input_ended_ = false;
  std::vector<std::string> said_;   ///< all messages so far, if there is a screen
  std::vector<std::string> drawn_;  ///< current content of the screen
  int columns_ = 0, rows_ = 0;
  std::int64_t drawn_whole_ns_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace study
