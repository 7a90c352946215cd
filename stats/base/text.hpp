#pragma once
/// Texts that come from outside: whether they are UTF-8, and how they stand in a message.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace base {

/// Bytes of the character that begins `text`, or 0 when that is not UTF-8 (RFC 3629: no overlong forms, no
/// surrogates, nothing above U+10FFFF) or `text` is empty.
std::size_t utf8_length(std::string_view text);

/// Whether all of it is UTF-8 without control characters (U+0000 to U+001F, U+007F to U+009F): a line that
/// every file and terminal takes as it is.
bool is_plain_line(std::string_view text);

/// A user's value as a message shows it: what is no character of a plain line is '?', and where it has more
/// than `most_bytes`, its middle gives way to the number of its bytes.
std::string shortened(std::string_view value, std::size_t most_bytes = 120);

/// The words one after another, with ", " between them.
std::string joined(const std::vector<std::string>& words);

/// The shortest text that reads back to the same double: "0.1", "1e-05".
std::string shortest(double value);

}  // namespace base
