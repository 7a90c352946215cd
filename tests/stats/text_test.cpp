#include "stats/base/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/pattern.hpp"

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

TEST(Pattern, FindsMatchesAndTheirGroups) {
  const Pattern number("([0-9]+)/([0-9]+)");
  ASSERT_TRUE(number.match("2/15"));
  EXPECT_EQ(number.match("2/15")->at(2), "15");
  EXPECT_FALSE(number.match("2/15 ")) << "the whole text must match";
  EXPECT_FALSE(number.match("x2/15"));
  const auto all = number.all("1/2, then 34/56");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1], (Groups{"34/56", "34", "56"}));
  EXPECT_EQ(number.replaced("a 1/2 b 3/4", [](const Groups& g) { return g[2] + ":" + g[1]; }), "a 2:1 b 4:3");
  EXPECT_EQ(Pattern("\\bmu\\b").replaced("mu mum emu mu.", [](const auto&) { return "x"; }), "x mum emu x.");
  EXPECT_EQ(Pattern("x*").replaced("axb", [](const auto&) { return "-"; }), "-a--b-");
  const std::string with_nul("a\0b1/2", 6);
  EXPECT_EQ(number.all(with_nul).size(), 1u);
  EXPECT_EQ(Pattern("(a)?b").match("b")->at(1), "") << "a group without a match is empty";
  EXPECT_THROW(Pattern("("), std::invalid_argument);
}

}  // namespace
}  // namespace base
