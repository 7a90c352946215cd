#pragma once
/// Which program runs: results of two programs that differ are not put together.

#include <string>

namespace base {

/// SHA-256 of the running program's own bytes: another build has another.
const std::string& program_digest();

/// The project's version and the first 16 digits of program_digest().
std::string program_words();

}  // namespace base
