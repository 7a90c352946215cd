#pragma once
/// What a TOML text must be before the parser may see it. toml++ 3.3 recurses once a level and takes letters
/// outside ASCII for spaces or undefined behaviour where no text in quotes and no comment stands.

#include <cstddef>
#include <string>
#include <string_view>

namespace base {

/// Largest text that is parsed, in bytes: a hundred times the longest protocol.
inline constexpr std::size_t most_toml_bytes = 1u << 20;
/// Table headers, dotted keys, lists and tables on one line within each other, in all.
inline constexpr int most_toml_levels = 64;

/// base::Error at `name`:line:column, columns counted in characters, when the text is too long; is not UTF-8;
/// holds a control character; nests deeper than most_toml_levels; has a character outside ASCII elsewhere
/// than in quotes or a comment, or right after a line-ending backslash; opens a quote right behind a key or
/// value; or escapes a NUL. All else is left to the parser.
void check_toml_text(std::string_view text, const std::string& name);

}  // namespace base
