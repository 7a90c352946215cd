/// Whatever stands behind a key of a protocol: it is taken, and the plan and its frames can be made, or an
/// error says where it stands and what to do.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/protocol/reference.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;

/// Where a value stands in a protocol that is sound as it is.
struct Place {
  std::size_t begin, end;
};

struct Text {
  std::string name, bytes;
  std::map<std::string, std::vector<Place>> places;  ///< by "[table] key"
};

/// "key = value" anywhere, and the elements of lists; under the table header before it.
void find_places(Text& text) {
  static const std::regex entry(
      R"((?:^|\n)(\[[^\n]*\])|([a-zA-Z0-9_]+) = ("""[\s\S]*?"""|"(?:[^"\\\n]|\\.)*"|\[[^\]\[]*\]|[^\s,}\]\[{"#]+))");
  std::string header;
  for (std::sregex_iterator it(text.bytes.begin(), text.bytes.end(), entry), end; it != end; ++it) {
    if ((*it)[1].matched) {
      header = (*it)[1];
      continue;
    }
    const auto begin = static_cast<std::size_t>(it->position(3));
    const auto length = static_cast<std::size_t>(it->length(3));
    auto& places = text.places[header + " " + (*it)[2].str()];
    places.push_back({begin, begin + length});
    if (text.bytes[begin] != '[' || length < 3) continue;
    const auto stop = std::min(text.bytes.find_first_of(",]", begin), begin + length - 1);
    places.push_back({begin + 1, stop});
  }
}

/// One of each table and key, from the protocols that ship and those of the fuzz corpus that are sound.
const std::vector<Text>& sound_texts() {
  static const auto texts = [] {
    std::vector<Text> out;
    for (const fs::path& folder :
         {fs::path(VIP_TEST_DIR) / "../protocols", fs::path(VIP_TEST_DIR) / "fuzz/corpus/protocol"}) {
      std::vector<fs::path> files;
      for (const auto& file : fs::directory_iterator(folder)) files.push_back(file.path());
      std::sort(files.begin(), files.end());
      for (const auto& file : files) {
        Text text{file.filename().string(), base::read_file(file, 1 << 20), {}};
        try {
          study::parse_protocol(text.bytes, text.name);
        } catch (const base::Error&) {
          continue;
        }
        find_places(text);
        out.push_back(text);
      }
    }
    return out;
  }();
  return texts;
}

const std::vector<std::string>& hostile_values() {
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

/// What follows from a protocol that was taken.
void use(const study::Protocol& protocol) {
  study::next_slot(protocol, {});
  study::make_plan(protocol, "P01", 7, 0);
  const auto& cells = protocol.design.cells;
  for (const auto* cell : {&cells.front(), &cells.back()}) {
    if (cell->setting.mean > 0 && study::frame_count(cell->setting) < 5000) {
      study::compile_schedule(cell->setting, study::for_display(protocol.pacing, 90), 1);
    }
  }
}

void try_value(const Text& text, const std::string& key, const Place& place, const std::string& value) {
  std::string changed = text.bytes;
  changed.replace(place.begin, place.end - place.begin, value);
  SCOPED_TRACE(text.name + " " + key + " = " + value.substr(0, 40));
  study::Protocol protocol;
  try {
    protocol = study::parse_protocol(changed, "p.toml");
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), ContainsRegex("^p\\.toml:[0-9]+:[0-9]+: "));
    EXPECT_THAT(error.what(), HasSubstr("\n  mend: "));
    return;
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
    return;
  }
  try {
    use(protocol);
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("\n  mend: "));
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
}

TEST(HostileValues, OfAnyKeyAreTakenOrRefusedWithPlaceAndMend) {
  std::set<std::string> tried;
  for (const auto& text : sound_texts()) {
    for (const auto& [key, places] : text.places) {
      if (!tried.insert(key).second) continue;
      for (std::size_t i = 0; i < std::min<std::size_t>(places.size(), 2); ++i)
        for (const auto& value : hostile_values()) try_value(text, key, places[i], value);
    }
  }
  // No key of the reference is left out: tables and lists of tables are reached through what they hold.
  std::set<std::string> names;
  for (const auto& key : tried) names.insert(key.substr(key.rfind(' ') + 1));
  for (const auto& key : study::protocol_reference()) {
    if (key.type.find("table") == std::string::npos && key.key != "SCORE") {
      EXPECT_TRUE(names.contains(key.key)) << key.table << " " << key.key;
    }
  }
}

TEST(HostileValues, ASpreadTooSmallToBeToldFromNoneIsRefused) {
  const auto text = base::read_file(base::resource("protocols/ptpe_pilot.toml"), 1 << 20);
  auto changed = text;
  const std::string list = "sd_fps = [0, 5";
  changed.replace(text.find(list), list.size(), "sd_fps = [0, 1e-308");
  EXPECT_THAT([&] { study::parse_protocol(changed, "p.toml"); },
              testing::ThrowsMessage<base::Error>(testing::AllOf(
                  HasSubstr("sd_fps[1]"), HasSubstr("too small"), HasSubstr("at least 0.001"))));
  study::PacingRules rules;
  for (const double sd : {1e-308, 1e-12, 1e-6}) {
    for (const auto cap : {std::optional<double>(), std::optional<double>(90)}) {
      rules.fps_max = cap;
      try {
        study::compile_schedule({50, sd, 10}, rules, 1);
      } catch (const base::Error& error) {
        EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("setting (50"), HasSubstr("mend: ")));
      }
    }
  }
}

TEST(HostileValues, TheSmallestSpreadCanBeMade) {
  for (const double mean : {10.0, 50.0, 200.0}) {
    for (const auto cap : {std::optional<double>(), std::optional<double>(240)}) {
      study::PacingRules rules;
      rules.fps_max = cap;
      EXPECT_NO_THROW(study::compile_schedule({mean, study::least_sd_fps, 10}, rules, 1)) << mean;
    }
  }
}

}  // namespace
