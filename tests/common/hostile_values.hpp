#pragma once
/// Puts unreasonable values behind every key of a TOML text.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "stats/base/error.hpp"

namespace test {

/// File name of the changed texts.
inline constexpr const char* hostile_name = "hostile.toml";

/// A valid TOML text.
struct SoundText {
  std::string name, bytes;
};

/// Byte range of a value.
struct ValuePlace {
  std::size_t begin, end;
};

/// Places of the values in "key = value" and of the first elements of lists, by "[table] key" with the
/// preceding table header.
inline std::map<std::string, std::vector<ValuePlace>> value_places(const std::string& text) {
  static const std::regex entry(
      R"((?:^|\n)(\[[^\n]*\])|([a-zA-Z0-9_]+) = ("""[\s\S]*?"""|"(?:[^"\\\n]|\\.)*"|\[[^\]\[]*\]|[^\s,}\]\[{"#]+))");
  std::map<std::string, std::vector<ValuePlace>> out;
  std::string header;
  for (std::sregex_iterator it(text.begin(), text.end(), entry), end; it != end; ++it) {
    if ((*it)[1].matched) {
      header = (*it)[1];
      continue;
    }
    const auto begin = static_cast<std::size_t>(it->position(3));
    const auto length = static_cast<std::size_t>(it->length(3));
    auto& places = out[header + " " + (*it)[2].str()];
    places.push_back({begin, begin + length});
    if (text[begin] == '[' && length > 2)
      places.push_back({begin + 1, std::min(text.find_first_of(",]", begin), begin + length - 1)});
  }
  return out;
}

inline const std::vector<std::string>& hostile_values() {
  static const std::vector<std::string> values{"1e308",
                                               "-1e308",
                                               "1e-308",
                                               "-1e-308",
                                               "4.9e-324",
                                               "0",
                                               "-1",
                                               "1e-4",
                                               "0.1",
                                               "1000",
                                               "3600",
                                               "nan",
                                               "inf",
                                               "-inf",
                                               "9223372036854775807",
                                               "-9223372036854775808",
                                               "99999999999999999999",
                                               "true",
                                               "\"\"",
                                               "\" \"",
                                               "\"\\u0000\"",
                                               "\"\\u001b[31m\"",
                                               "\"" + std::string(100'000, 'x') + "\"",
                                               "'''\n\n'''",
                                               "[]",
                                               "[[]]",
                                               "[1e-308, 0]",
                                               "[\"\", \"\"]",
                                               "{}",
                                               "{a = 1}",
                                               "1979-05-27",
                                               "\xc3\xa9",
                                               ""};
  return values;
}

/// Puts each hostile value behind each key, once per table, and calls `use` with the parsed result. Errors
/// must be base::Error with a remedy; errors of `parse` must also begin with "FILE:line:column: ", where FILE
/// is hostile_name. Returns the keys that were tried.
template <class Parse, class Use>
std::set<std::string> try_hostile_values(const std::vector<SoundText>& texts, Parse parse, Use use) {
  std::set<std::string> tried, names;
  for (const auto& text : texts) {
    for (const auto& [key, places] : value_places(text.bytes)) {
      if (!tried.insert(key).second) continue;
      names.insert(key.substr(key.rfind(' ') + 1));
      for (std::size_t i = 0; i < std::min<std::size_t>(places.size(), 2); ++i) {
        for (const auto& value : hostile_values()) {
          SCOPED_TRACE(text.name + " " + key + " = " + value.substr(0, 40));
          std::string changed = text.bytes;
          changed.replace(places[i].begin, places[i].end - places[i].begin, value);
          bool parsed = false;
          try {
            const auto what = parse(changed);
            parsed = true;
            use(what);
          } catch (const base::Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("\n  mend: "));
            if (!parsed) {
              EXPECT_THAT(error.what(), testing::ContainsRegex("^hostile\\.toml:[0-9]+:[0-9]+: "));
            }
          } catch (const std::exception& error) {
            ADD_FAILURE() << error.what();
          }
        }
      }
    }
  }
  return names;
}

}  // namespace test
