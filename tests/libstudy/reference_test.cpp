/// docs/protocol.md against the keys that the readers of protocols look up.

#include "libstudy/protocol/reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/toml_text.hpp"
#include "tests/common/asked_keys.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path tests = VIP_TEST_DIR;

std::vector<fs::path> toml_files(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") out.push_back(entry.path());
  }
  return out;
}

/// Replaces scores in `anchors`, keys of an effect and names of factors by the reference's placeholders. Keys
/// of a level become keys of stimulus, where the reference lists them.
std::string without_scores(const std::string& name) {
  static const std::regex effect(R"((effect_set\.effect)\.(?!kind$)\w+$)"), score(R"(anchors\.[0-9]+$)"),
      level(R"(^factor\.level\.(?!name$))"), factor(R"(^(combination|design\.standard)\.\w+$)");
  std::string out = std::regex_replace(name, effect, "$1.KEY");
  out = std::regex_replace(out, score, "anchors.SCORE");
  out = std::regex_replace(out, level, "stimulus.");
  return std::regex_replace(out, factor, "$1.FACTOR");
}

/// All keys that the readers look up in all protocols of the source tree.
const test::AskedKeys& asked_keys() {
  static const auto asked = [] {
    test::AskedKeys out;
    auto files = toml_files(tests / "../protocols");
    for (const auto& file : toml_files(tests / "fuzz/corpus/protocol")) files.push_back(file);
    for (const auto& file : files) {
      try {
        const auto root = base::parse_toml(base::read_file(file, base::most_toml_bytes), file.string());
        study::read_protocol_table(root);
        for (const auto& [name, what] : root.asked()) out[without_scores(name)].push_back(what);
      } catch (const base::Error&) {  // the corpus also holds files that are refused
      }
    }
    return out;
  }();
  return asked;
}

TEST(Reference, NamesExactlyTheKeysThatReadersAskFor) {
  test::expect_names_exactly(study::protocol_reference(), asked_keys());
}

std::vector<std::string> choices_of(const std::string& name) {
  for (const auto& asked : asked_keys().at(name)) {
    if (!asked.choices.empty()) return asked.choices;
  }
  return {};
}

/// The protocol with this key set to `word` in each table that may have it.
std::string with(const std::string& protocol, const study::KeyReference& key, const std::string& word) {
  const std::string set = key.key + " = \"" + word + "\"\n";
  bool inside = key.table.empty();
  std::string out = inside ? set : "";
  std::istringstream lines(protocol);
  for (std::string line; std::getline(lines, line);) {
    const bool header = line.starts_with('[');
    if (header) inside = line.starts_with("[" + key.table + "]") || line.starts_with("[[" + key.table + "]]");
    if (inside && line.starts_with(key.key + " =")) continue;
    out += line + "\n" + (header && inside ? set : "");
  }
  return out;
}

// Sets each choice to each of its words, because the files use only some words, and a word may bring further
// keys. The reference must name every key that the reader looks up.
TEST(Reference, NamesWhatEachWordOfAChoiceBrings) {
  const auto known = test::names_of(study::protocol_reference());
  int words = 0, keys = 0;
  for (const auto& file : toml_files(tests / "../protocols")) {
    const std::string text = base::read_file(file, 1 << 20);
    for (const auto& key : study::protocol_reference()) {
      for (const std::string& word : choices_of(test::name_of(key))) {
        const auto root = base::parse_toml(with(text, key, word), file.filename());
        try {
          study::read_protocol_table(root);
        } catch (const base::Error&) {  // the keys looked up until the error count
        }
        for (const auto& [name, what] : root.asked()) {
          EXPECT_TRUE(known.contains(without_scores(name))) << name << " with " << key.key << " = " << word;
          ++keys;
        }
        ++words;
      }
    }
  }
  EXPECT_GT(words, 200);
  EXPECT_GT(keys, 50 * words) << "they are refused early";
}

TEST(Reference, HasTheTypesRangesAndDefaultsOfTheReaders) {
  test::expect_types_ranges_and_defaults(study::protocol_reference(), asked_keys());
}

TEST(Reference, PageIsTheOneInDocs) {
  EXPECT_EQ(base::read_file(tests / "../docs/protocol.md", 1 << 20), study::protocol_reference_page())
      << "write it anew: vip-study reference > docs/protocol.md";
}

}  // namespace
