#pragma once
/// The console in the terminal that started the program: a screen of its own (console_screen.hpp), keys read
/// as they are pressed. Runs on a thread of its own, so that a slow terminal delays no frame.

#include <termios.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "apps/study/desk/console.hpp"

namespace apps {

/// Reads standard input and writes to standard error. Where input is no terminal, bytes are keys all the
/// same; where output is none, there is no screen but a line for what happens. What was said stands below
/// what was there before once the screen is gone. Ctrl-C stays what it is.
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
  std::vector<std::string> said_;   ///< all lines so far, where there is a screen
  std::vector<std::string> drawn_;  ///< what stands on it
  int columns_ = 0, rows_ = 0;
  std::int64_t drawn_whole_ns_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace apps
