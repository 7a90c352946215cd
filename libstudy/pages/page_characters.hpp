#pragma once
/// The characters of a participant's pages: which scripts are drawn correctly, and which fonts they need.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A text of a page and its place in the protocol.
struct PlacedText {
  std::string place, text;
};
/// Titles, texts, questions and the words of their answers, in the order of the file.
std::vector<PlacedText> texts_of_pages(const Protocol& protocol);

/// Decodes UTF-8; invalid bytes give U+FFFD.
std::u32string characters_of(const std::string& text);
/// The distinct characters in ascending order, without line ends and tabs.
std::u32string characters_of(const std::vector<PlacedText>& texts);

/// For messages: "U+4E2D (中)".
std::string name_of(char32_t character);

/// Why the pages draw a character wrongly with any font; empty if they draw it correctly.
std::string script_limit(char32_t character);

/// The Debian package with a font for the character.
std::string package_with(char32_t character);

/// True if a line may break before and after it without a space: Chinese and Japanese characters.
bool breaks_anywhere(char32_t character);

}  // namespace study
