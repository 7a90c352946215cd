#pragma once
/// Reading and writing JSON that outsiders made. Nesting is limited before a text is parsed: printing or
/// comparing a tree is recursive, and a deep tree overflows the stack.

#include <cstddef>
#include <string>
#include <string_view>

namespace base {

/// True where brackets and braces outside of strings are nested deeper than `levels`. The text may be no
/// JSON.
inline bool nested_deeper_than(int levels, std::string_view json) {
  int depth = 0;
  bool text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (text) {
      if (c == '\\') ++i;
      if (c == '"') text = false;
    } else if (c == '"') {
      text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > levels) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// Levels that no file of this program reaches.
inline constexpr int most_json_levels = 32;

/// `Json::parse` without exceptions: discarded for what is no JSON or nested deeper than `levels`.
template <class Json>
Json parse_json(std::string_view text, int levels = most_json_levels) {
  if (nested_deeper_than(levels, text)) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

/// A value as text, on one line where `indent` is negative. A database may hold any bytes: those that are not
/// UTF-8 become U+FFFD.
template <class Json>
std::string json_text(const Json& value, int indent = -1) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace base
