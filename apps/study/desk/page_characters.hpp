#pragma once
/// The characters of a participant's pages: which scripts are drawn right, and which fonts they need.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// A text of a page and where it stands in the protocol.
struct PlacedText {
  std::string place, text;
};
/// Titles, texts, questions and the words of their answers, in the order of the file.
std::vector<PlacedText> texts_of_pages(const study::Protocol& protocol);

/// UTF-8 as characters; what is no UTF-8 is U+FFFD.
std::u32string characters_of(const std::string& text);
/// Each of them once, in ascending order, without line ends and tabs.
std::u32string characters_of(const std::vector<PlacedText>& texts);

/// For messages: "U+4E2D (中)".
std::string name_of(char32_t character);

/// Why the pages draw a character wrongly, whatever the font; empty: they draw it right.
std::string script_limit(char32_t character);

/// The Debian package whose fonts draw it.
std::string package_with(char32_t character);

/// Whether a line may end before and after it without a space: Chinese and Japanese characters.
bool breaks_anywhere(char32_t character);

}  // namespace apps
