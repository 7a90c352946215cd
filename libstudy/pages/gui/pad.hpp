#pragma once
/// An on-screen keyboard (pad) for participants without a keyboard.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/pages/page.hpp"

namespace study {

/// Has digits for a question of kind Number (a typed whole number), and letters, digits and punctuation for
/// one of kind Text. Arrow keys (of a hand controller's stick or the terminal) move a marker over its keys.
class Pad {
 public:
  static constexpr const char* erase = "\u2190";

  explicit Pad(const Question& question);

  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// True if the marker is on this key.
  bool marked(std::size_t row, std::size_t column) const { return row_ == row + 1 && column_ == column; }
  /// Types a key into the focused question.
  void type(const std::string& key, PageState& state, std::int64_t now_ns) const;
  /// Arrow keys move the marker; Enter types the marked key. Returns false for a key that the pad does not
  /// use: Enter or Up without a marker, an arrow that moves the marker off the pad at its top or bottom, and
  /// any other key.
  bool press(PageKey key, PageState& state, std::int64_t now_ns);

 private:
  std::vector<std::vector<std::string>> rows_;
  std::size_t row_ = 0, column_ = 0;  ///< marker; row from 1, 0: no marker on the pad
};

}  // namespace study
