#include "libstudy/pages/page_characters.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <set>

#include "stats/base/text.hpp"

namespace study {

namespace {

struct Range {
  char32_t first, last;
};

template <std::size_t n>
bool is_in(const std::array<Range, n>& ranges, char32_t c) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [c](const Range& one) { return one.first <= c && c <= one.last; });
}

// Ranges of code points, after the Unicode Standard, version 15.
constexpr std::array right_to_left{
    Range{0x0590, 0x08FF},  // Hebrew, Arabic, Syriac, Thaana, N'Ko, Samaritan, Mandaic
    Range{0x200F, 0x200F},  // right-to-left mark
    Range{0x202A, 0x202E},  // embedding and override
    Range{0x2066, 0x2069},  // isolates
    Range{0xFB1D, 0xFDFF},  // Hebrew and Arabic presentation forms
    Range{0xFE70, 0xFEFE},  // Arabic presentation forms B
    Range{0x10800, 0x10FFF}, Range{0x1E800, 0x1EFFF}};
constexpr std::array shaped{
    Range{0x0900, 0x109F},  // Devanagari to Myanmar: Indic scripts, Sinhala, Thai, Lao, Tibetan
    Range{0x1100, 0x11FF},  // Hangul jamo
    Range{0x1700, 0x18AF},  // scripts of the Philippines, Khmer, Mongolian
    Range{0x1900, 0x1AAF},  // Limbu, Tai, Buginese
    Range{0x1B00, 0x1C4F},  // Balinese, Sundanese, Batak, Lepcha
    Range{0x1CD0, 0x1CFF}, Range{0xA800, 0xA82F}, Range{0xA840, 0xA95F}, Range{0xA960, 0xA97F},
    Range{0xA980, 0xAAFF}, Range{0xABC0, 0xABFF}, Range{0xD7B0, 0xD7FF}};
constexpr std::array combining{Range{0x0300, 0x036F}, Range{0x0483, 0x0489}, Range{0x1AB0, 0x1AFF},
                               Range{0x1DC0, 0x1DFF}, Range{0x20D0, 0x20FF}, Range{0x302A, 0x302F},
                               Range{0x3099, 0x309A}, Range{0xFE20, 0xFE2F}};
constexpr std::array invisible{Range{0x00AD, 0x00AD}, Range{0x034F, 0x034F}, Range{0x180B, 0x180F},
                               Range{0x200B, 0x200E}, Range{0x2060, 0x2064}, Range{0xFE00, 0xFE0F},
                               Range{0xFEFF, 0xFEFF}, Range{0xFFF9, 0xFFFB}};
constexpr std::array east_asian{Range{0x2E80, 0x30FF},  // radicals, punctuation, kana
                                Range{0x3100, 0x9FFF},  // Bopomofo, signs, unified ideographs
                                Range{0xF900, 0xFAFF}, Range{0xFE30, 0xFE4F}, Range{0xFF00, 0xFFEF}};
constexpr std::array hangul{Range{0x3130, 0x318F}, Range{0xAC00, 0xD7A3}};

}  // namespace

std::vector<PlacedText> texts_of_pages(const Protocol& protocol) {
  std::vector<PlacedText> out;
  const auto add = [&](const std::string& place, const std::string& text) {
    if (!text.empty()) out.push_back({place, text});
  };
  for (const Block& block : protocol.blocks) {
    const std::string place = "block '" + block.id + "', ";
    add(place + "title", block.title);
    add(place + "text", block.text);
    for (const Question& question : block.questions) {
      const std::string asked = place + "question '" + question.id + "', ";
      add(asked + "text", question.text);
      for (const auto& [score, words] : question.anchors) add(asked + "anchors", words);
    }
  }
  return out;
}

std::u32string characters_of(const std::string& text) {
  std::u32string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = base::utf8_length(std::string_view(text).substr(at));
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
    char32_t character = length == 0 ? U'\uFFFD' : length == 1 ? byte(0) : byte(0) & (0xFFU >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) character = character << 6 | (byte(i) & 0x3FU);
    out += character;
    at += std::max<std::size_t>(length, 1);
  }
  return out;
}

std::u32string characters_of(const std::vector<PlacedText>& texts) {
  std::set<char32_t> found;
  for (const PlacedText& one : texts) {
    for (const char32_t c : characters_of(one.text))
      if (c != U'\n' && c != U'\r' && c != U'\t') found.insert(c);
  }
  return {found.begin(), found.end()};
}

std::string name_of(char32_t c) {
  const std::string code = fmt::format("U+{:04X}", static_cast<unsigned>(c));
  if (c <= 0x20 || is_in(invisible, c) || is_in(combining, c)) return code;
  const auto part = [c](int shift) { return static_cast<char>(0x80 | ((c >> shift) & 0x3F)); };
  std::string bytes;
  if (c < 0x80)
    bytes = {static_cast<char>(c)};
  else if (c < 0x800)
    bytes = {static_cast<char>(0xC0 | (c >> 6)), part(0)};
  else if (c < 0x10000)
    bytes = {static_cast<char>(0xE0 | (c >> 12)), part(6), part(0)};
  else
    bytes = {static_cast<char>(0xF0 | (c >> 18)), part(12), part(6), part(0)};
  return code + " (" + bytes + ")";
}

std::string script_limit(char32_t c) {
  if (is_in(right_to_left, c))
    return "is written from right to left, and the pages draw from left to right only";
  if (is_in(shaped, c))
    return "is of a script whose letters change with their neighbours, and the pages draw letter by letter";
  if (is_in(combining, c)) return "is drawn beside the letter that it belongs to, and not on it";
  if (is_in(invisible, c)) return "cannot be seen, and the pages may draw something for it";
  if (c > 0xFFFF) return "is beyond U+FFFF, such as emoji and rare characters, which the pages do not draw";
  return {};
}

std::string package_with(char32_t c) {
  if (is_in(east_asian, c) || is_in(hangul, c)) return "fonts-noto-cjk";
  const bool usual = c < 0x0530 || (c >= 0x1E00 && c < 0x2600);
  return usual ? "fonts-dejavu-core" : "fonts-noto-core";
}

bool breaks_anywhere(char32_t c) { return is_in(east_asian, c); }

}  // namespace study
