#pragma once
/// An on-screen keyboard for participants without a keyboard.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/pages/page.hpp"

namespace study {

/// Digits for a Number; letters, digits and signs for a Text. Arrows move between keys.
class Pad {
 public:
  static constexpr const char* erase = "\u2190";

  explicit Pad(const Question& question);

  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// True if the arrows are on this key.
  bool marked(std::size_t row, std::size_t column) const { return row_ == row + 1 && column_ == column; }
  /// Types a key into the focused question.
  void type(const std::string& key, PageState& state, std::int64_t now_ns) const;
  /// Moves the arrows, or types the key under them. False if the pad does not use the key: Enter before any
  /// arrow, and arrows that leave the pad at its top or bottom.
  bool press(PageKey key, PageState& state, std::int64_t now_ns);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t row_ = 0, column_ = 0;  ///< row from 1; 0: the arrows are not on the pad
};

}  // namespace study
