#include "libstudy/pages/gui/pad.hpp"

#include <algorithm>

namespace study {

namespace {

constexpr const char* minus = "\u2212";

std::vector<std::string> letters(const std::string& row) {
  std::vector<std::string> keys;
  for (const char letter : row) {
    const bool begins =
        (static_cast<unsigned char>(letter) & 0xC0U) != 0x80U;  // first byte of a UTF-8 character
    if (begins) keys.emplace_back();
    keys.back() += letter;
  }
  return keys;
}

}  // namespace

Pad::Pad(const Question& question) {
  if (!traits_of(question.kind).scored) {
    for (const char* row : {"1234567890", "qwertyuiop", "asdfghjkl?", "zxcvbnm,. "})
      rows_.push_back(letters(row));
    if (question.language.starts_with("de")) rows_.push_back(letters("äöüß"));
  } else {
    rows_.push_back(letters("1234567890"));
    if (question.scale_min < 0) rows_.back().emplace_back(minus);
  }
  rows_.back().emplace_back(erase);
}

void Pad::type(const std::string& key, PageState& state, std::int64_t now_ns) const {
  if (key == erase) return state.press(PageKey::Erase, now_ns);
  if (key == minus) return state.minus(now_ns);
  if (state.focus() < state.size() && !traits_of(state.question(state.focus()).kind).scored)
    return state.type(key, now_ns);
  state.digit(key[0] - '0', now_ns);
}

bool Pad::press(PageKey key, PageState& state, std::int64_t now_ns) {
  if (key == PageKey::Enter) {
    if (row_ > 0) type(rows_[row_ - 1][column_], state, now_ns);
    return row_ > 0;
  }
  const bool sideways = key == PageKey::Left || key == PageKey::Right;
  if (!sideways && key != PageKey::Up && key != PageKey::Down) return false;
  if (key == PageKey::Up && row_ > 0) --row_;
  if (key == PageKey::Down) ++row_;
  if (sideways && row_ == 0) {
    row_ = 1;
    return true;
  }
  if (row_ == 0 || row_ > rows_.size()) {
    row_ = 0;
    return false;
  }
  const std::size_t last = rows_[row_ - 1].size() - 1;
  if (key == PageKey::Left && column_ > 0) --column_;
  if (key == PageKey::Right) ++column_;
  column_ = std::min(column_, last);
  return true;
}

}  // namespace study
