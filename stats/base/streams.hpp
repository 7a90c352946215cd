#pragma once
/// Standard input, output and error of a program: always open, and with write errors reported. Text from a
/// database or a protocol cannot move the terminal's cursor (base/outgoing.hpp).

#include <cstdio>
#include <string>

#include "stats/base/outgoing.hpp"

namespace base {

/// Opens /dev/null on each of the descriptors 0, 1 and 2 that is closed. Otherwise the next file opened would
/// get that number, and messages would be written into a data file. Returns false on failure.
bool open_standard_streams();

/// While an object of this class exists, everything that C functions such as std::printf print to stdout
/// passes through base::TerminalText, which replaces control characters by '?'. std::cout and
/// print_coloured() bypass this filter.
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

/// Prints text with its colour codes (ECMA-48 "ESC [ digits m"). Other control characters than tab and line
/// feed become '?'.
void print_coloured(const std::string& text);

/// Flushes stdout; base::Error if any of its output could not be written, now or earlier. Returns false,
/// without an error, if stdout is a pipe whose reader has closed it (`| head -1`).
bool finish_output();

/// Prepares a message for stderr: cuts the middle of lines longer than 1000 bytes, replaces control
/// characters by '?', and cuts the message after 200 lines.
std::string for_terminal(const std::string& message);

}  // namespace base
