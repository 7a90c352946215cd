#pragma once
/// Standard input, output and error of a program: always open, and with write errors reported. Text from a
/// database or a protocol cannot move the terminal's cursor (base/outgoing.hpp).

#include <cstdio>
#include <string>

#include "stats/base/outgoing.hpp"

namespace base {

/// Opens /dev/null on each of the descriptors 0, 1 and 2 that is closed; otherwise a data file could get that
/// number and messages would be written into it. Returns false on failure.
bool open_standard_streams();

/// While it lives, everything printed to stdout passes through base::TerminalText, which lets no control
/// characters through. Use print_coloured() for coloured text.
class PlainOutput {
 public:
  PlainOutput();
  ~PlainOutput();
  PlainOutput(const PlainOutput&) = delete;
  PlainOutput& operator=(const PlainOutput&) = delete;

 private:
  TerminalText text_;
  std::FILE *before_, *plain_ = nullptr;
};

/// Prints text with its colours (ECMA-48 "ESC [ digits m") and no other control characters.
void print_coloured(const std::string& text);

/// Flushes stdout; base::Error if any of its output could not be written, now or earlier. Returns false,
/// without an error, if the reader of a pipe has left (`| head -1`).
bool finish_output();

/// Prepares a message for stderr: cuts the middle of long lines, removes control characters, and limits the
/// length to a screen or two.
std::string for_terminal(const std::string& message);

}  // namespace base
