#pragma once
/// The fonts that pages are drawn with: one of the system, and others for characters that it lacks.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

struct ImFont;
struct ImFontAtlas;

namespace apps {

/// Characters that pages need beside the usual ones, and the protocol's language ("zh", "ja", "en"): it
/// decides between fonts that draw one character differently.
struct PageCharacters {
  std::u32string characters;
  std::string language;
};
PageCharacters page_characters(const study::Protocol& protocol);

/// A font of the system, or "" where none is found (Dear ImGui's own is then used). $VIP_FONT wins.
std::string find_font();

/// A font's file, and its number in a file that holds several.
struct FontFile {
  std::string path;
  int number = 0;
};
/// find_font() first, then fonts of the system, by fontconfig where the program was built with it, until all
/// characters are found or no font is left that has one.
std::vector<FontFile> find_fonts(const PageCharacters& needed);

/// The usual characters (Latin, Greek, Cyrillic, punctuation, arrows) and those of `needed`, `size` px high
/// from the highest ascent to the lowest descent. The atlas is to be built by the caller.
class PageType {
 public:
  explicit PageType(const PageCharacters& needed);
  ImFont* add(ImFontAtlas& atlas, float size) const;
  /// Characters that the fonts lack.
  std::u32string undrawn(const std::u32string& characters) const;

 private:
  std::vector<FontFile> files_;
  std::vector<unsigned short> ranges_;  ///< as Dear ImGui takes them; they outlive the atlas's building
};

/// base::Error where a page cannot be drawn as it is written: names the text, the character, and the package
/// with a font or the limit. Nothing is refused by a program without Dear ImGui, which draws no pages.
void check_pages(const study::Protocol& protocol);

}  // namespace apps
