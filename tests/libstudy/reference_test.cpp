/// docs/protocol.md against what the readers of protocols really ask for.

#include "libstudy/protocol/reference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

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

/// Scores are keys of `anchors`.
std::string without_scores(const std::string& name) {
  return std::regex_replace(name, std::regex(R"(anchors\.[0-9]+$)"), "anchors.SCORE");
}

/// Everything that reading all protocols of this tree asks for.
const std::map<std::string, std::vector<base::AskedKey>>& asked_keys() {
  static const auto asked = [] {
    std::map<std::string, std::vector<base::AskedKey>> out;
    auto files = toml_files(tests / "../protocols");
    for (const auto& file : toml_files(tests / "fuzz/corpus/protocol")) files.push_back(file);
    for (const auto& file : files) {
      try {
        const auto root = base::read_toml(file);
        study::read_protocol_table(root);
        for (const auto& [name, what] : root.asked()) out[without_scores(name)].push_back(what);
      } catch (const base::Error&) {  // the corpus also holds files that are refused
      }
    }
    return out;
  }();
  return asked;
}

std::string name_of(const study::KeyReference& key) {
  return key.table.empty() ? key.key : key.table + "." + key.key;
}

std::set<std::string> reference_names() {
  std::set<std::string> out;
  for (const auto& key : study::protocol_reference()) out.insert(name_of(key));
  return out;
}

TEST(Reference, NamesExactlyTheKeysThatReadersAskFor) {
  std::set<std::string> asked;
  for (const auto& [name, what] : asked_keys()) asked.insert(name);
  EXPECT_EQ(reference_names(), asked);
  EXPECT_EQ(reference_names().size(), study::protocol_reference().size()) << "a key stands there twice";
}

// What no file above reaches still stands in the source.
TEST(Reference, NamesEveryKeyInTheReadersSource) {
  std::set<std::string> known;
  for (const auto& key : study::protocol_reference()) known.insert(key.key);
  const std::regex ask(
      R"re((?:number|integer|boolean|string|choice|numbers|strings|table|tables|has)(?:_or)?\(\s*"([a-z0-9_]+)"|(?:text_of|id_of|read_span|read_score|distinct_words|distinct_numbers)\(\w+,\s*"([a-z0-9_]+)")re");
  int found = 0;
  for (const auto& entry : fs::directory_iterator(tests / "../libstudy/protocol")) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("read_") && name != "protocol.cpp") continue;
    const std::string source = base::read_file(entry.path(), 1 << 20);
    for (std::sregex_iterator at(source.begin(), source.end(), ask), end; at != end; ++at) {
      const std::string key = (*at)[1].matched ? (*at)[1] : (*at)[2];
      EXPECT_TRUE(known.count(key)) << name << " asks for " << key;
      ++found;
    }
  }
  EXPECT_GT(found, 60);
}

std::string in_words(const std::vector<std::string>& choices) {
  std::string out;
  for (const auto& word : choices) out += (out.empty() ? "\"" : ", \"") + word + "\"";
  return out;
}

/// Empty parts of what was asked agree with everything.
void expect_agrees(const study::KeyReference& key, const base::AskedKey& asked) {
  const std::string name = name_of(key);
  EXPECT_THAT(key.type, testing::HasSubstr(asked.type)) << name;
  EXPECT_THAT(key.values, testing::HasSubstr(in_words(asked.choices))) << name;
  EXPECT_THAT(key.fallback, testing::HasSubstr(asked.fallback)) << name;
  const bool is_range = key.values.starts_with('[') || key.values.starts_with('(');
  if (asked.range && is_range && key.values.find(" or ") == std::string::npos) {
    EXPECT_EQ(key.values, base::range_text(*asked.range)) << name;
  }
}

TEST(Reference, HasTheTypesRangesAndDefaultsOfTheReaders) {
  for (const auto& key : study::protocol_reference()) {
    const std::string name = name_of(key);
    ASSERT_TRUE(asked_keys().count(name)) << name;
    bool typed = false;
    for (const auto& asked : asked_keys().at(name)) {
      typed = typed || !asked.type.empty();
      expect_agrees(key, asked);
    }
    EXPECT_TRUE(typed) << name;
  }
}

TEST(Reference, PageIsTheOneInDocs) {
  EXPECT_EQ(base::read_file(tests / "../docs/protocol.md", 1 << 20), study::protocol_reference_page())
      << "write it anew: vip-study reference > docs/protocol.md";
}

}  // namespace
