#pragma once
/// Standard input, output and error of a program: there from the start, and heard when they fail. What others
/// wrote, in a database or a protocol, moves no cursor there (base/outgoing.hpp).

#include <cstdio>
#include <string>

#include "stats/base/outgoing.hpp"

namespace apps {

/// Gives /dev/null to each of the descriptors 0, 1 and 2 that is closed, so that no data file gets its number
/// and is written to by a message. False when that fails.
bool open_standard_streams();

/// While it lives, all that is printed to stdout passes base::TerminalText: no control character comes
/// through, whatever text it was in. What is to be coloured goes by print_coloured().
class PlainOutput {
 public:
  PlainOutput();
  ~PlainOutput();
  PlainOutput(const PlainOutput&) = delete;
  PlainOutput& operator=(const PlainOutput&) = delete;

 private:
  base::TerminalText text_;
  std::FILE *before_, *plain_ = nullptr;
};

/// Prints text with its colours (ECMA-48 "ESC [ digits m"), and no other control character.
void print_coloured(const std::string& text);

/// Writes out what is printed so far; base::Error when not all of it could be written, now or earlier.
/// Returns false when that is because the reader of a pipe has left (`| head -1`), which needs no word.
bool finish_output();

/// A message as stderr gets it: long lines without their middle, no control characters, no more than a
/// screen or two.
std::string for_terminal(const std::string& message);

}  // namespace apps
