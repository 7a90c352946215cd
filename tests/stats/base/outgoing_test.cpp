#include "stats/base/outgoing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "stats/base/error.hpp"

namespace base {
namespace {

TEST(Outgoing, NamesOfFilesLeadNowhereElse) {
  for (const char* good : {"ratings.csv", "sub-P01/ses-a_v1/beh/x.tsv.gz", "a", "protocol_0123456789ab.toml"})
    EXPECT_NO_THROW(check_file_name(good, "out")) << good;
  for (const std::string bad :
       {"", "/etc/passwd", "../x", "a/../b", "protocol_/../../PWN.toml", "a//b", "a/", ".hidden", "a/.b",
        "-rf", "a b", "a\nb", "a\x1b[2Jb", "a\\b", "C:x", "\xC3\xBC", "a\x80"}) {
    EXPECT_THROW(check_file_name(bad, "out"), Error) << bad;
  }
  EXPECT_THROW(check_file_name(std::string("a\0b", 3), "out"), Error);
  EXPECT_NO_THROW(check_file_name(std::string(200, 'a'), "out"));
  EXPECT_THROW(check_file_name(std::string(201, 'a'), "out"), Error);
}

TEST(Outgoing, TextForATerminalKeepsWordsAndLosesControl) {
  TerminalText text;
  EXPECT_EQ(text.next("a\tb\nZürich 漢字\n"), "a\tb\nZürich 漢字\n");
  EXPECT_EQ(text.next("\x1b[2J\r\b\x07\x7f\xC2\x9B"
                      "31m\xFFz"),
            "?[2J?????31m?z");
  EXPECT_EQ(text.rest(), "");
}

TEST(Outgoing, TextForATerminalIsTheSameInAnyParts) {
  const std::string all = "Zürich \xF0\x9F\x98\x80 \xE6\xBC \xC2\x9B \xC2 \xF0\x9F x\xE6\xBC\xA2";
  TerminalText whole;
  const std::string wanted = whole.next(all) + whole.rest();
  std::mt19937 random(3);
  for (int times = 0; times < 500; ++times) {
    TerminalText parts;
    std::string out;
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t size = 1 + random() % 4;
      out += parts.next(all.substr(at, size));
      at += size;
    }
    ASSERT_EQ(out + parts.rest(), wanted);
  }
}

TEST(Outgoing, ACharacterThatIsCutAtTheEndIsSaid) {
  TerminalText text;
  EXPECT_EQ(text.next("a\xE6\xBC"), "a");
  EXPECT_EQ(text.rest(), "?");
  EXPECT_EQ(text.rest(), "");
}

}  // namespace
}  // namespace base
