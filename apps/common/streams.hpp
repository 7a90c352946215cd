#pragma once
/// Standard input, output and error of a program: there from the start, and heard when they fail.

#include <string>

namespace apps {

/// Gives /dev/null to each of the descriptors 0, 1 and 2 that is closed, so that no data file gets its number
/// and is written to by a message. False when that fails.
bool open_standard_streams();

/// Writes out what is printed so far; base::Error when not all of it could be written, now or earlier.
/// Returns false when that is because the reader of a pipe has left (`| head -1`), which needs no word.
bool finish_output();

/// A message as stderr gets it: long lines without their middle, no control characters, no more than a
/// screen or two.
std::string for_terminal(const std::string& message);

}  // namespace apps
