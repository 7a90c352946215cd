#pragma once
/// Untrusted text: UTF-8 checks and display in messages.

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace base {

/// Number of bytes of the first character of `text`, or 0 if the character is not UTF-8 (RFC 3629: no
/// overlong forms, no surrogates, nothing above U+10FFFF) or `text` is empty.
std::size_t utf8_length(std::string_view text);

/// True if all of the text is UTF-8 without control characters (U+0000 to U+001F, U+007F to U+009F).
bool is_plain_line(std::string_view text);

/// A user's value for display in a message: control characters and bytes that are not UTF-8 become '?'. If
/// the value is longer than `most_bytes`, its middle is replaced by the value's length in bytes.
std::string shortened(std::string_view value, std::size_t most_bytes = 120);

/// The words, separated by ", ".
std::string joined(const std::vector<std::string>& words);

/// The words as an English list: "A, B and C".
std::string enumerated(const std::vector<std::string>& words);

/// True if the text is empty or consists of spaces, tabs and line ends.
bool is_blank(std::string_view text);

/// The parts of a line between separators, such as the cells of CSV without quotes. An empty last part is
/// left out.
std::vector<std::string> split(const std::string& line, char separator = ',');

/// Parses all of `text` as a number. Empty if `text` is not a number or the number is beyond the type's
/// range.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return {};
  return value;
}

/// The shortest text that reads back to the same double: "0.1", "1e-05".
std::string shortest(double value);

}  // namespace base
