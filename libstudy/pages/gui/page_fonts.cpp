#include "libstudy/pages/gui/page_fonts.hpp"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <type_traits>

#if VIP_FONTCONFIG
#include <fontconfig/fontconfig.h>
#endif

#include "libstudy/pages/page_characters.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

static_assert(std::is_same_v<ImWchar, unsigned short>, "script_limit() knows characters of 16 bits");

/// Ranges (first, last) of characters for every page: Latin with extensions, Greek, Cyrillic, punctuation,
/// arrows, signs.
constexpr std::array<ImWchar, 16> usual{0x20,   0x24F,  0x370,  0x52F,  0x1E00, 0x1EFF, 0x2010, 0x2044,
                                        0x20AC, 0x20AC, 0x2190, 0x2193, 0x2212, 0x2212, 0x2264, 0x2265};
constexpr const char* folder = "/usr/share/fonts/";

bool is_usual(char32_t c) {
  for (std::size_t i = 0; i < usual.size(); i += 2)
    if (usual[i] <= c && c <= usual[i + 1]) return true;
  return false;
}

std::vector<ImWchar> ranges_with(const std::u32string& more) {
  std::vector<ImWchar> out(usual.begin(), usual.end());
  for (const char32_t c : more) {
    if (c < 0x20 || c > 0xFFFF || is_usual(c)) continue;
    out.push_back(static_cast<ImWchar>(c));
    out.push_back(static_cast<ImWchar>(c));
  }
  out.push_back(0);
  return out;
}

#if VIP_FONTCONFIG

template <class Thing, void (*destroy)(Thing*)>
struct Destroy {
  void operator()(Thing* thing) const { destroy(thing); }
};
using CharSet = std::unique_ptr<FcCharSet, Destroy<FcCharSet, FcCharSetDestroy>>;
using Pattern = std::unique_ptr<FcPattern, Destroy<FcPattern, FcPatternDestroy>>;
using FontSet = std::unique_ptr<FcFontSet, Destroy<FcFontSet, FcFontSetDestroy>>;

/// True for single-colour outline fonts that Dear ImGui can read.
bool is_readable(FcPattern* font) {
  FcChar8* format = nullptr;
  FcBool scalable = FcFalse, variable = FcFalse, colour = FcFalse;
  FcPatternGetBool(font, FC_SCALABLE, 0, &scalable);
  FcPatternGetBool(font, FC_VARIABLE, 0, &variable);
  FcPatternGetBool(font, FC_COLOR, 0, &colour);
  if (FcPatternGetString(font, FC_FONTFORMAT, 0, &format) != FcResultMatch) return false;
  const std::string name = reinterpret_cast<const char*>(format);
  return scalable && !variable && !colour && (name == "TrueType" || name == "CFF");
}

/// System fonts that together have the characters, in fontconfig's order of preference for the language.
std::vector<FontFile> system_fonts(const std::u32string& characters, const std::string& language) {
  if (!FcInit()) return {};
  CharSet missing(FcCharSetCreate());
  for (const char32_t c : characters) FcCharSetAddChar(missing.get(), c);
  const Pattern request(FcPatternCreate());
  FcPatternAddString(request.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>("sans-serif"));
  FcPatternAddString(request.get(), FC_LANG, reinterpret_cast<const FcChar8*>(language.c_str()));
  FcPatternAddCharSet(request.get(), FC_CHARSET, missing.get());
  FcConfigSubstitute(nullptr, request.get(), FcMatchPattern);
  FcDefaultSubstitute(request.get());
  FcResult result = FcResultNoMatch;
  const FontSet sorted(FcFontSort(nullptr, request.get(), FcFalse, nullptr, &result));
  std::vector<FontFile> out;
  for (int i = 0; sorted && i < sorted->nfont && FcCharSetCount(missing.get()) > 0; ++i) {
    FcPattern* const font = sorted->fonts[i];
    FcChar8* file = nullptr;
    FcCharSet* has = nullptr;
    int number = 0;
    if (!is_readable(font) || FcPatternGetString(font, FC_FILE, 0, &file) != FcResultMatch ||
        FcPatternGetCharSet(font, FC_CHARSET, 0, &has) != FcResultMatch ||
        FcCharSetIntersectCount(has, missing.get()) == 0)
      continue;
    FcPatternGetInteger(font, FC_INDEX, 0, &number);
    out.push_back({reinterpret_cast<const char*>(file), number & 0xFFFF});
    missing.reset(FcCharSetSubtract(missing.get(), has));
  }
  return out;
}

#else

/// Existing font files of Debian packages. Without fontconfig, their characters are not checked.
std::vector<FontFile> system_fonts(const std::u32string&, const std::string&) {
  std::vector<FontFile> out;
  for (const char* name : {"truetype/dejavu/DejaVuSans.ttf", "opentype/noto/NotoSansCJK-Regular.ttc",
                           "truetype/wqy/wqy-zenhei.ttc", "truetype/noto/NotoSans-Regular.ttf"}) {
    if (fs::exists(std::string(folder) + name)) out.push_back({std::string(folder) + name, 0});
  }
  return out;
}

#endif

}  // namespace

PageCharacters page_characters(const Protocol& protocol) {
  return {characters_of(texts_of_pages(protocol)), protocol.language};
}

std::string find_font() {
  if (const char* chosen = std::getenv("VIP_FONT"); chosen && *chosen) {
    std::error_code ignored;
    if (fs::is_regular_file(chosen, ignored)) return chosen;
    throw base::Error(std::string("environment variable VIP_FONT = ") + chosen, "is not a file",
                      "name a font's file, or unset VIP_FONT for a font of the system");
  }
  for (const char* name :
       {"dejavu/DejaVuSans.ttf", "liberation/LiberationSans-Regular.ttf",
        "liberation2/LiberationSans-Regular.ttf", "noto/NotoSans-Regular.ttf", "freefont/FreeSans.ttf"}) {
    const std::string path = std::string(folder) + "truetype/" + name;
    if (fs::exists(path)) return path;
  }
  return {};
}

std::vector<FontFile> find_fonts(const PageCharacters& needed) {
  std::vector<FontFile> out;
  if (const std::string first = find_font(); !first.empty()) out.push_back({first, 0});
  const bool beyond = std::any_of(needed.characters.begin(), needed.characters.end(),
                                  [](char32_t c) { return !is_usual(c); });
  if (!beyond && !out.empty()) return out;
  for (const FontFile& one : system_fonts(needed.characters, needed.language)) {
    if (out.empty() || one.path != out.front().path) out.push_back(one);
  }
  return out;
}

PageType::PageType(const PageCharacters& needed)
    : files_(find_fonts(needed)), ranges_(ranges_with(needed.characters)) {}

ImFont* PageType::add(ImFontAtlas& atlas, float size) const {
  ImFontConfig config;
  config.OversampleH = 1;
  config.OversampleV = 1;
  ImFont* font = nullptr;
  for (const FontFile& one : files_) {
    config.FontNo = one.number;
    config.MergeMode = font != nullptr;
    if (ImFont* const added = atlas.AddFontFromFileTTF(one.path.c_str(), size, &config, ranges_.data()))
      font = added;
  }
  if (font) return font;
  config.SizePixels = size;
  return atlas.AddFontDefault(&config);
}

std::u32string PageType::undrawn(const std::u32string& characters) const {
  ImFontAtlas atlas;
  const ImFont* const font = add(atlas, 16);
  atlas.Build();
  std::u32string out;
  for (const char32_t c : characters) {
    if (c > 0xFFFF || !font->FindGlyphNoFallback(static_cast<ImWchar>(c))) out += c;
  }
  return out;
}

void check_pages(const Protocol& protocol) {
  const std::string place = protocol.place.empty() ? "protocol " + protocol.name : protocol.place;
  const auto texts = texts_of_pages(protocol);
  for (const PlacedText& one : texts) {
    for (const char32_t c : characters_of(one.text)) {
      if (const std::string limit = script_limit(c); !limit.empty())
        throw base::Error(place + ": " + one.place, "the character " + name_of(c) + " " + limit,
                          "write this text in other characters; docs/limits.md names the scripts");
    }
  }
  const PageCharacters needed = page_characters(protocol);
  const std::u32string undrawn = PageType(needed).undrawn(needed.characters);
  for (const PlacedText& one : texts) {
    const std::u32string all = characters_of(one.text);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](char32_t c) { return undrawn.find(c) != undrawn.npos; });
    if (found == all.end()) continue;
    throw base::Error(
        place + ": " + one.place,
        "no font of this computer draws the character " + name_of(*found) +
            (undrawn.size() > 1 ? ", nor " + std::to_string(undrawn.size() - 1) + " others" : ""),
        "install one (apt-get install " + package_with(*found) +
            "), or name a font's file in the environment variable VIP_FONT");
  }
}

}  // namespace study
