#pragma once
/// Checks of a TOML text before it is parsed. toml++ 3.3 recurses once per level of nesting. Outside quotes
/// and comments it treats some non-ASCII characters as spaces, and others cause undefined behaviour in it.

#include <cstddef>
#include <string>
#include <string_view>

namespace base {

/// Largest text that is parsed, in bytes.
inline constexpr std::size_t most_toml_bytes = 1u << 20;
/// Deepest nesting, counting table headers, dotted keys, lists and inline tables together.
inline constexpr int most_toml_levels = 64;

/// base::Error at `name`:line:column (columns count characters) if the text is too long; is not UTF-8; holds
/// a control character; nests deeper than most_toml_levels; has a non-ASCII character outside quotes and
/// comments, or right after a line-ending backslash; has a quote, an opening bracket or a second '=' directly
/// after a value, or a quote directly after a key; or escapes a NUL. The parser checks the rest of the
/// grammar.
void check_toml_text(std::string_view text, const std::string& name);

}  // namespace base
