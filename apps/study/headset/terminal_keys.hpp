#pragma once
/// The keyboard of the terminal that started the program, as keys of a page.

#include <termios.h>

#include <string>
#include <vector>

#include "apps/study/pages/page_surface.hpp"

namespace apps {

/// What was typed, as a terminal writes it: arrows and the like come as Esc and more, Esc alone asks whether
/// to stop.
std::vector<PageEvent> page_events(const std::string& typed);

/// Reads standard input where it is a terminal, key by key; else nothing. Ctrl-C stays what it is.
class TerminalKeys {
 public:
  TerminalKeys();
  ~TerminalKeys();
  TerminalKeys(const TerminalKeys&) = delete;
  TerminalKeys& operator=(const TerminalKeys&) = delete;

  /// What was typed since the last call; waits for nothing.
  std::vector<PageEvent> take();

 private:
  bool terminal_ = false;
  termios before_{};
};

}  // namespace apps
