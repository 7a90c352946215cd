#pragma once
/// The characters of a participant's pages: which of them the pages draw correctly, and which package has a
/// font for them.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A text of a page, and the key of the protocol that it comes from, such as "block 'a', title".
struct PlacedText {
  std::string place, text;
};
/// The titles, texts, questions and anchors of all pages, in the order of the protocol file.
std::vector<PlacedText> texts_of_pages(const Protocol& protocol);

/// Decodes UTF-8; invalid bytes give U+FFFD.
std::u32string characters_of(const std::string& text);
/// The distinct characters in ascending order, without line ends and tabs.
std::u32string characters_of(const std::vector<PlacedText>& texts);

/// The name of a character in messages: "U+4E2D (中)", or only "U+00AD" if the character is invisible or
/// combines with the character before.
std::string name_of(char32_t character);

/// Why the pages draw this character wrongly with every font, in words; empty if a font can draw it
/// correctly.
std::string script_limit(char32_t character);

/// The Debian package that is likely to have a font for the character.
std::string package_with(char32_t character);

/// True if a line may break before and after the character without a space, as in Chinese and Japanese.
bool breaks_anywhere(char32_t character);

}  // namespace study
