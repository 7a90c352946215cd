#include "stats/base/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace base {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Text, PlainLinesAreUtf8WithoutControls) {
  for (const char* good : {"", "lab 1", "Z\xC3\xBCrich", "\xE6\x97\xA5\xE6\x9C\xAC", "\xF0\x9F\x8C\x8A"})
    EXPECT_TRUE(is_plain_line(good)) << good;
  const std::string_view nul("a\0b", 3);
  EXPECT_FALSE(is_plain_line(nul));
  // A lone start byte, a lone continuation byte, overlong forms, a surrogate, a code above U+10FFFF, an
  // invalid byte, control characters.
  for (const char* bad : {"\xC3", "\x80", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80",
                          "\xFF", "a\tb", "a\nb", "\x1b[31m", "\x7f", "\xC2\x85"})
    EXPECT_FALSE(is_plain_line(bad)) << bad;
}

TEST(Text, ShortValuesAreShownAsTheyAre) {
  EXPECT_EQ(shortened("Z\xC3\xBCrich"), "Z\xC3\xBCrich");
  EXPECT_EQ(shortened("a\x1b[31m\xFF"), "a?[31m?");
}

TEST(Text, LongValuesAreShownByTheirEndsInWholeCharacters) {
  const std::string shown = shortened(std::string(1'500'000, 'x') + "end");
  EXPECT_LT(shown.size(), 200u);
  EXPECT_THAT(shown, AllOf(StartsWith("xxx"), HasSubstr("(1500003 bytes)"), EndsWith("end")));
  for (std::size_t most = 2; most < 12; ++most) {
    std::string umlauts;
    for (int i = 0; i < 20; ++i) umlauts += "\xC3\xBC";
    EXPECT_TRUE(is_plain_line(shortened(umlauts, most))) << most;
    EXPECT_EQ(shortened(umlauts, most).find('?'), std::string::npos) << most;
  }
}

TEST(Text, NumbersAreTheShortestThatReadBack) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(1e-5), "1e-05");
  EXPECT_EQ(std::stod(shortest(1.0 / 3)), 1.0 / 3);
}

TEST(Text, WordsAreJoinedByCommas) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"a"}), "a");
  EXPECT_EQ(joined({"a", "", "b"}), "a, , b");
}

TEST(Text, AnEnglishListEndsWithAnd) {
  EXPECT_EQ(enumerated({}), "");
  EXPECT_EQ(enumerated({"a"}), "a");
  EXPECT_EQ(enumerated({"a", "b"}), "a and b");
  EXPECT_EQ(enumerated({"a", "b", "c"}), "a, b and c");
}

TEST(Text, BlankTextHasNoVisibleCharacter) {
  EXPECT_TRUE(is_blank(""));
  EXPECT_TRUE(is_blank(" \t\r\n"));
  EXPECT_FALSE(is_blank(" a "));
}

}  // namespace
}  // namespace base
