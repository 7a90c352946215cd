#pragma once
/// Fonts of the pages: a system font, and others for characters that it lacks.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

struct ImFont;
struct ImFontAtlas;

namespace study {

/// Characters that pages need besides the usual ones, and the protocol's language ("zh", "ja", "en"), which
/// selects between fonts that draw a character differently.
struct PageCharacters {
  std::u32string characters;
  std::string language;
};
PageCharacters page_characters(const Protocol& protocol);

/// A system font, or "" if none is found (Dear ImGui's own is then used). $VIP_FONT overrides it.
std::string find_font();

/// A font's file and its index in a file with several fonts.
struct FontFile {
  std::string path;
  int number = 0;
};
/// find_font() first, then system fonts (by fontconfig, if built with it) until all characters are found or
/// no other font has one.
std::vector<FontFile> find_fonts(const PageCharacters& needed);

/// Adds fonts to an atlas, which the caller builds: the usual characters (Latin, Greek, Cyrillic,
/// punctuation, arrows, signs) and those of `needed`, `size` px high from the highest ascent to the lowest
/// descent.
class PageType {
 public:
  explicit PageType(const PageCharacters& needed);
  ImFont* add(ImFontAtlas& atlas, float size) const;
  /// Characters that the fonts lack.
  std::u32string undrawn(const std::u32string& characters) const;

 private:
  std::vector<FontFile> files_;
  std::vector<unsigned short> ranges_;  ///< in Dear ImGui's format; must live until the atlas is built
};

/// base::Error if a page's text cannot be drawn correctly: names the text, the character, and the package
/// with a font or the limit. A program without Dear ImGui draws no pages and refuses nothing.
void check_pages(const Protocol& protocol);

}  // namespace study
