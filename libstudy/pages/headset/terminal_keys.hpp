#pragma once
/// Converts keys of the terminal that started the program to events of a page.

#include <termios.h>

#include <string>
#include <vector>

#include "libstudy/pages/gui/page_surface.hpp"

namespace study {

/// Parses the bytes that a terminal sends. Arrows and similar keys are escape sequences; Esc alone opens the
/// stop dialog.
std::vector<PageEvent> page_events(const std::string& typed);

/// Reads standard input key by key if it is a terminal; otherwise reads nothing. Ctrl-C works as usual.
class TerminalKeys {
 public:
  TerminalKeys();
  ~TerminalKeys();
  TerminalKeys(const TerminalKeys&) = delete;
  TerminalKeys& operator=(const TerminalKeys&) = delete;

  /// The keys typed since the last call; does not wait.
  std::vector<PageEvent> take();

 private:
  bool terminal_ = false;
  termios before_{};
};

}  // namespace study
