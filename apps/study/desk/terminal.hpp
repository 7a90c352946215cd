#pragma once
/// The console in the terminal that started the program: lines above, one line of status below, keys read as
/// they are pressed. Runs on a thread of its own, so that a slow terminal delays no frame.

#include <termios.h>

#include <atomic>
#include <thread>

#include "apps/study/desk/console.hpp"

namespace apps {

/// Reads standard input and writes to standard error. Where input is no terminal, bytes are keys all the same
/// and there is no line of status. Ctrl-C stays what it is.
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

  Console& console_;
  bool terminal_in_ = false, terminal_out_ = false;
  termios before_{};
  bool input_ended_ = false;
  std::string status_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace apps
