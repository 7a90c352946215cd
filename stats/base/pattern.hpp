#pragma once
/// Regular expressions. Outside the tests only pattern.cpp includes <regex>, because that header compiles
/// slowly.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace base {

/// The text of a match: the whole match first, then each group.
using Groups = std::vector<std::string>;

/// A compiled regular expression, in the grammar of ECMAScript (JavaScript).
class Pattern {
 public:
  /// Throws std::regex_error if the expression has an error.
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
