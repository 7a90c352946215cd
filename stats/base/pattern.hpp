#pragma once
/// Regular expressions of the C library. Compiling <regex> of the C++ library takes seven seconds.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace base {

/// The text of a match: the whole match first, then each group.
using Groups = std::vector<std::string>;

/// A compiled extended regular expression of POSIX, with \b and \w of the GNU C library. Of several matches
/// that begin at the same character the longest is taken.
class Pattern {
 public:
  /// Throws std::invalid_argument if the expression has an error.
  explicit Pattern(const std::string& expression);
  ~Pattern();
  Pattern(Pattern&&) noexcept;
  Pattern& operator=(Pattern&&) noexcept;

  /// The groups if the expression matches the whole text; else empty.
  std::optional<Groups> match(const std::string& text) const;
  /// The groups of each match within the text, from left to right.
  std::vector<Groups> all(const std::string& text) const;
  /// The text with each match replaced by what `write` returns for its groups.
  std::string replaced(const std::string& text, const std::function<std::string(const Groups&)>& write) const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace base
