#pragma once
/// Fonts of the pages: a system font, and more fonts for the characters that this font lacks.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

struct ImFont;
struct ImFontAtlas;

namespace study {

/// The characters of a protocol's pages, and the protocol's language ("zh", "ja", "en"). The language selects
/// between fonts that draw a character differently.
struct PageCharacters {
  std::u32string characters;
  std::string language;
};
PageCharacters page_characters(const Protocol& protocol);

/// The file of $VIP_FONT if it is set and not empty, else the first system font of a fixed list. "" if none
/// of the list exists: Dear ImGui's default font is then used. base::Error if $VIP_FONT is not a file.
std::string find_font();

/// A font's file, and the font's index in a file with several fonts.
struct FontFile {
  std::string path;
  int number = 0;
};
/// Fonts for the needed characters: first find_font(). If there is no such font, or if a character is not a
/// usual one (see PageType), system fonts follow. fontconfig adds fonts until the added fonts have all needed
/// characters, or no other font has one that is missing. Without fontconfig, all installed fonts of a fixed
/// list follow.
std::vector<FontFile> find_fonts(const PageCharacters& needed);

/// Adds the pages' fonts to a font atlas of Dear ImGui, which the caller then builds. The fonts get glyphs
/// for the usual characters (Latin, Greek, Cyrillic, punctuation, arrows, signs) and for those of `needed`.
/// `size`: height, px from the highest ascent to the lowest descent.
class PageType {
 public:
  explicit PageType(const PageCharacters& needed);
  ImFont* add(ImFontAtlas& atlas, float size) const;
  /// The part of `characters` that no font of the pages can draw.
  std::u32string undrawn(const std::u32string& characters) const;

 private:
  std::vector<FontFile> files_;
  std::vector<unsigned short> ranges_;  ///< first and last characters; must outlive the atlas's build
};

/// base::Error unless the pages can draw all texts of a protocol. The error names the text, the character,
/// and either a package with a font or the reason why no font helps. Does nothing in a program built without
/// Dear ImGui, which has no pages.
void check_pages(const Protocol& protocol);

}  // namespace study
