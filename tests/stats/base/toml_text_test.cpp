/// Texts that check_toml_text refuses, the places in its errors, and its agreement with toml++ on all other
/// texts.

#include "stats/base/toml_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/toml.hpp"
#include "stats/base/toml_parser.hpp"

namespace base {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string refusal(const std::string& text) {
  return error_of([&] { check_toml_text(text, "t.toml"); });
}

/// The verdict of toml++ alone.
bool parses(const std::string& text) {
  try {
    static_cast<void>(toml::parse(text));
    return true;
  } catch (const toml::parse_error&) {
    return false;
  }
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

struct Refused {
  std::string text, place, problem;
};

testing::Matcher<std::string> is_refusal_of(const Refused& refused) {
  return AllOf(StartsWith("t.toml:" + refused.place + ": "), HasSubstr(refused.problem),
               HasSubstr("\n  mend: "));
}

class TomlText : public testing::TestWithParam<Refused> {};

TEST_P(TomlText, IsRefusedAtItsPlaceWithAMend) {
  EXPECT_THAT(refusal(GetParam().text), is_refusal_of(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(
    Bytes, TomlText,
    testing::Values(Refused{"a = 1\nb = \"\xff\"\n", "2:6", "is not UTF-8"},
                    Refused{"a = \"\xc0\xaf\"", "1:6", "is not UTF-8"},         // overlong
                    Refused{"# \xed\xa0\x80", "1:3", "is not UTF-8"},           // surrogate
                    Refused{"# \xf4\x90\x80\x80", "1:3", "is not UTF-8"},       // above U+10FFFF
                    Refused{"# \xe2\x82", "1:3", "is not UTF-8"},               // cut short
                    Refused{"# \xc3\xa9\xc3\xa9 \xff", "1:6", "is not UTF-8"},  // columns are characters
                    Refused{std::string("a = \"x\0y\"", 9), "1:7", "control character"},
                    Refused{"a = \"\x1b[31m\"", "1:6", "control character"},
                    Refused{"a = 1\rb = 2\n", "1:6", "control character"},
                    Refused{"# \x7f", "1:3", "control character"}));

INSTANTIATE_TEST_SUITE_P(
    Letters, TomlText,
    testing::Values(Refused{"\xc3\xa9 = 1", "1:1", "outside ASCII"},
                    Refused{"a = \xc3\xa9", "1:5", "outside ASCII"},
                    Refused{"a =\xc2\xa0"
                            "1",
                            "1:4", "outside ASCII"},  // a no-break space
                    Refused{"[\xce\xb1]", "1:2", "outside ASCII"},
                    Refused{"a = \"\"\"x\"\"\"\xc3\xa9", "1:12", "outside ASCII"},
                    Refused{"a = '''x'''''\xc3\xa9", "1:14", "outside ASCII"},
                    Refused{"a = \"\\\\\"\xc3\xa9", "1:9", "outside ASCII"},
                    Refused{"a = '\\'\xc3\xa9", "1:8", "outside ASCII"},
                    Refused{"a = \"\"\"x \\\n  \xc3\xa9\"\"\"", "2:3", "right after a backslash"},
                    Refused{"a = \"\"\"x\\\xc3\xa9\"\"\"", "1:10", "right after a backslash"}));

INSTANTIATE_TEST_SUITE_P(Quotes, TomlText,
                         testing::Values(Refused{"a = 1.5\"\xc3\xa9\"", "1:8", "behind a value"},
                                         Refused{"a = 5.\"\xc3\xa9\"", "1:7", "behind a value"},
                                         Refused{"a = 1='\xc3\xa9'", "1:6", "is a = behind a value"},
                                         Refused{"a = 1['\xc3\xa9']", "1:6", "behind a value"},
                                         Refused{"a = 1979-05-27 '\xc3\xa9'", "1:16", "behind a value"},
                                         Refused{"a = [1 '\xc3\xa9']", "1:8", "behind a value"},
                                         Refused{"[a] '\xc3\xa9'", "1:5", "behind a value"},
                                         Refused{"a\"b\" = 1", "1:2", "behind a key"},
                                         Refused{"a = ['b''c']", "1:9", "behind a value"}));

INSTANTIATE_TEST_SUITE_P(Nuls, TomlText,
                         testing::Values(Refused{"a = \"x\\u0000\"", "1:7", "NUL"},
                                         Refused{"a = \"\\U00000000\"", "1:6", "NUL"},
                                         Refused{"a = \"\"\"\n\\\\\\u0000\"\"\"", "2:3", "NUL"},
                                         Refused{"\"\\u0000\" = 1", "1:2", "NUL"}));

/// The texts are long, so they are made here and not as parameters of a test, which are made at every start
/// of the program.
TEST(TomlTextDepth, IsBoundedInKeysHeadersListsAndTables) {
  const std::vector<Refused> texts{
      {"a" + repeated(".a", 300000) + " = 1", "1:130", "nested more than 64 levels"},
      {"[a" + repeated(".a", 300000) + "]", "1:129", "nested"},
      {"[[a" + repeated(".a", 300000) + "]]", "1:130", "nested"},
      {"a = " + repeated("[", 30000), "1:69", "nested"},
      {"a = " + repeated("{a=", 30000), "1:197", "nested"},
      {"[a" + repeated(".a", 40) + "]\nb" + repeated(".b", 40) + " = 1", "2:48", "nested"},
      {repeated("a.", 40) + "a = " + repeated("[", 40), "1:109", "nested"},
      {"a = [1, {b.c" + repeated(".c", 70) + " = 1}]", "1:135", "nested"}};
  for (const Refused& each : texts)
    EXPECT_THAT(refusal(each.text), is_refusal_of(each)) << each.text.substr(0, 20);
}

TEST(TomlTextSize, IsBounded) {
  EXPECT_EQ(refusal("#" + std::string(most_toml_bytes - 1, ' ')), "");
  EXPECT_THAT(refusal("#" + std::string(most_toml_bytes, ' ')),
              AllOf(StartsWith("t.toml: holds 1048577 bytes"), HasSubstr("\n  mend: ")));
}

TEST(TomlTextAccepted, WhatLooksDeepOrForeignOnlyInTextsAndComments) {
  const std::string brackets = repeated("[{", 200), dots = repeated("a.", 200) + "a";
  const std::vector<std::string> texts{
      "",
      "\xEF\xBB\xBF"
      "a = 1",
      "# " + brackets + dots + " \xc3\xa9\n",
      "a = \"" + brackets + "\\\"" + dots + " \xc3\xa9\\\\\" # \"\"\"\n",
      "a = '" + brackets + "\\' # '''\n",
      "a = \"\"\"\"\"" + brackets + " \"\" \xe2\x82\xac\r\n\\\"\"\"\\\n \\\r\n\t x\"\"\"\"\"\nb = 1\n",
      "a = '''''" + brackets + "'' \\\n'''''\nb = 2",
      "\"" + dots + "\" = 1\n['" + dots + ".'.b]\n",
      "[a.b]\nx.y = [[1.5, 2.5], [3.25]]\n[a.c]\nx.y = {z.w = 1.5}\n",
      "a = [" + repeated("[1.5], ", 500) + "]",
      "a = [ # ]]]] \"\n 1, # [\n 2 ]\n",
      "a = \"\\u00e9\\u001b\\U0001F600\"",
      "d = 1979-05-27 07:32:00.5Z\nf = -1.5e-3\n"};
  for (const auto& text : texts) {
    EXPECT_EQ(refusal(text), "") << text;
    EXPECT_TRUE(parses(text)) << text;
  }
}

/// Headers, dotted keys, lists and tables nested in a random order, `depth` in all.
std::string nested(int depth, std::mt19937& random) {
  const auto part = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
  int left = depth;
  std::string out, tail;
  if (const int header = part(left - 1); header > 0) {
    out += "[h" + repeated(" . h", header - 1) + "]\n";
    left -= header;
  }
  const int dots = part(left);
  out += "k" + repeated(".'k'", dots) + " = ";
  for (left -= dots; left > 0; --left) {
    if (random() % 2) {
      out += "[ \"]\", # [\n";
      tail = "]" + tail;
    } else {
      out += "{ a = 1.5, \"b\" = ";
      tail = "}" + tail;
    }
  }
  return out + "'''[[{'''" + tail + "\nz = 1\n";
}

TEST(TomlTextDepth, IsCountedOverHeadersKeysListsAndTables) {
  std::mt19937 random(1);
  for (int depth = 1; depth <= 2 * most_toml_levels; ++depth) {
    for (int i = 0; i < 20; ++i) {
      const std::string text = nested(depth, random);
      EXPECT_EQ(refusal(text).empty(), depth <= most_toml_levels) << depth << "\n" << text;
      EXPECT_TRUE(parses(text)) << text;
    }
  }
}

TEST(TomlTextAgrees, WithTheParserOnEveryFileThatShips) {
  int files = 0;
  for (const char* folder : {"protocols", "data"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(resource(folder))) {
      if (entry.path().extension() != ".toml") continue;
      const auto text = read_file(entry.path(), most_toml_bytes);
      EXPECT_EQ(refusal(text), "") << entry.path();
      EXPECT_TRUE(parses(text)) << entry.path();
      ++files;
    }
  }
  EXPECT_GE(files, 10);
}

/// Sound documents with random pieces of grammar inserted: texts that toml++ accepts are not refused, and
/// toml++ gives a verdict on all others that pass (under the sanitizers: without undefined behaviour).
TEST(TomlTextAgrees, WithTheParserOnBrokenDocuments) {
  const std::vector<std::string> sound{
      "[a.b]\nc.d = [1.5, {e = \"f\"}]\n[[g]]\nh = '''i\nj'''\n",
      "a = \"\"\"b \\\n  c\"\"\" # d\n'e'.\"f\" = { g.h = [ '#', \"]\" ] }\r\n",
      "x = 1\ny = [\n 1, # two\n 2\n]\n[z]\nt = true\n"};
  const std::vector<std::string> pieces{"\"",
                                        "'",
                                        "\"\"\"",
                                        "'''",
                                        "\\",
                                        "[",
                                        "]",
                                        "{",
                                        "}",
                                        ".",
                                        "=",
                                        ",",
                                        "\n",
                                        " ",
                                        "\r\n",
                                        "#",
                                        "\\\n",
                                        "\\\"",
                                        "a",
                                        "1",
                                        "1.5",
                                        "[[",
                                        "]]",
                                        "\\u00e9",
                                        "\xc3\xa9",
                                        "\xe2\x80\x83",
                                        "5.",
                                        "1979-05-27 ",
                                        "\"\xc3\xa9\"",
                                        "'\xc3\xa9'"};
  std::mt19937 random(2);
  int taken = 0, refused = 0;
  for (int i = 0; i < 30000; ++i) {
    std::string text = sound[random() % sound.size()];
    for (auto edits = 1 + random() % 3; edits > 0; --edits) {
      // Inserts between characters, so that the text stays UTF-8.
      std::size_t at = random() % (text.size() + 1);
      while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
      text.insert(at, pieces[random() % pieces.size()]);
    }
    const std::string error = refusal(text);
    if (error.empty()) {
      taken += parses(text);
      continue;
    }
    ++refused;
    const auto foreign = [](char c) { return static_cast<unsigned char>(c) >= 0x80; };
    if (error.find("outside ASCII") != std::string::npos) continue;
    // The insertion parted a carriage return from its line feed, or put a quote, bracket or = directly behind
    // a value or a key.
    EXPECT_THAT(error, AnyOf(HasSubstr("control character"), HasSubstr(" behind a "))) << text;
    if (std::none_of(text.begin(), text.end(), foreign)) {
      EXPECT_FALSE(parses(text)) << text;
    }
  }
  EXPECT_GT(taken, 3000);
  EXPECT_GT(refused, 500);
}

TEST(TomlTextReader, HostileTextsEndInAnError) {
  for (const auto& text : {"a" + repeated(".a", 300000) + " = 1", "a = " + repeated("[", 20000),
                           "a = " + repeated("{a=", 20000), "[" + repeated("a.", 300000) + "a]"}) {
    EXPECT_THAT(error_of([&] { parse_toml(text, "t.toml"); }), HasSubstr("nested")) << text.substr(0, 20);
  }
}

}  // namespace
}  // namespace base
