#pragma once
/// Compares the documented keys of a file format with the keys that its reader looks up.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "stats/base/key_reference.hpp"
#include "stats/base/toml.hpp"

namespace test {

/// How the reader looked up each key (type, range, choices, default), by the key's dotted name.
using AskedKeys = std::map<std::string, std::vector<base::AskedKey>>;

inline std::string name_of(const base::KeyReference& key) {
  return key.table.empty() ? key.key : key.table + "." + key.key;
}

inline std::set<std::string> names_of(const std::vector<base::KeyReference>& keys) {
  std::set<std::string> out;
  for (const auto& key : keys) out.insert(name_of(key));
  return out;
}

inline void expect_names_exactly(const std::vector<base::KeyReference>& keys, const AskedKeys& asked) {
  std::set<std::string> names;
  for (const auto& [name, what] : asked) names.insert(name);
  EXPECT_EQ(names_of(keys), names);
  EXPECT_EQ(names_of(keys).size(), keys.size()) << "a key stands there twice";
}

inline std::string in_words(const std::vector<std::string>& choices) {
  std::string out;
  for (const auto& word : choices) out += (out.empty() ? "\"" : ", \"") + word + "\"";
  return out;
}

/// Empty fields of `asked` agree with everything.
inline void expect_agrees(const base::KeyReference& key, const base::AskedKey& asked) {
  const std::string name = name_of(key);
  EXPECT_THAT(key.type, testing::HasSubstr(asked.type)) << name;
  EXPECT_THAT(key.values, testing::HasSubstr(in_words(asked.choices))) << name;
  EXPECT_THAT(key.fallback, testing::HasSubstr(asked.fallback)) << name;
  const bool is_range = key.values.starts_with('[') || key.values.starts_with('(');
  if (asked.range && is_range && key.values.find(" or ") == std::string::npos) {
    EXPECT_EQ(key.values.substr(0, key.values.find(']') + 1), base::range_text(*asked.range)) << name;
  }
}

inline void expect_types_ranges_and_defaults(const std::vector<base::KeyReference>& keys,
                                             const AskedKeys& asked) {
  for (const auto& key : keys) {
    ASSERT_TRUE(asked.count(name_of(key))) << name_of(key);
    bool typed = false;
    for (const auto& how : asked.at(name_of(key))) {
      typed = typed || !how.type.empty();
      expect_agrees(key, how);
    }
    EXPECT_TRUE(typed) << name_of(key);
  }
}

}  // namespace test
