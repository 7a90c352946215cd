#pragma once
/// The project's exception type: what is wrong, where, and how to fix it.

#include <stdexcept>
#include <string>

namespace base {

class Error : public std::runtime_error {
 public:
  /// place: file, file:line:column, option or device; problem: what is wrong there; mend: what the user can
  /// do.
  Error(const std::string& place, const std::string& problem, const std::string& mend)
      : std::runtime_error(place + ": " + problem + (mend.empty() ? "" : "\n  mend: " + mend)) {}
};

}  // namespace base
