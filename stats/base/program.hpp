#pragma once
/// Identity of the running program. Files of results contain it, so that results of different builds can be
/// told apart.

#include <string>

namespace base {

/// SHA-256 of the running program's own file; it differs between builds.
const std::string& program_digest();

/// The project's version and the first 16 digits of program_digest().
std::string program_words();

}  // namespace base
