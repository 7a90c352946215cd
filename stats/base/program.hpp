#pragma once
/// Identity of the running program. Results of two different programs are not combined.

#include <string>

namespace base {

/// SHA-256 of the running program's own file; it differs between builds.
const std::string& program_digest();

/// The project's version and the first 16 digits of program_digest().
std::string program_words();

}  // namespace base
