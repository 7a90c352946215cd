#pragma once
/// Keys drawn on a page, for those who have no keyboard at hand.

#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/desk/page.hpp"

namespace apps {

/// Digits for a Number; letters, digits and signs for a Text. Arrows go from key to key.
class Pad {
 public:
  static constexpr const char* erase = "\u2190";

  explicit Pad(const study::Question& question);

  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// Whether the arrows are on this key.
  bool marked(std::size_t row, std::size_t column) const { return row_ == row + 1 && column_ == column; }
  /// Types a key into the question that has the focus.
  void type(const std::string& key, PageState& state, std::int64_t now_ns) const;
  /// Moves the arrows, or types the key that they are on. False where the key is not the pad's: Enter before
  /// any arrow, and arrows that leave the pad at its top or bottom.
  bool press(PageKey key, PageState& state, std::int64_t now_ns);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t row_ = 0, column_ = 0;  ///< row from 1; 0: the arrows were not used
};

}  // namespace apps
