/// Any value of any key of a protocol is either accepted, and then the plan and its frames can be made, or
/// refused by an error with its place and a remedy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/design/plan.hpp"
#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/protocol/reference.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/hostile_values.hpp"
#include "tests/common/protocols.hpp"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The shipped protocols and the sound ones of the fuzz corpus.
std::vector<test::SoundText> sound_protocols() {
  std::vector<test::SoundText> out;
  for (const char* folder : {"../protocols", "fuzz/corpus/protocol"}) {
    std::vector<fs::path> files;
    for (const auto& file : fs::directory_iterator(fs::path(VIP_TEST_DIR) / folder))
      if (file.is_regular_file()) files.push_back(file.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      test::SoundText text{file.filename().string(), base::read_file(file, 1 << 20)};
      // Adds keys that no file uses.
      const std::string format = "format = 2\n";
      if (const auto at = text.bytes.find(format); at != std::string::npos)
        text.bytes.insert(at + format.size(),
                          "camera_angle = \"true\"\ngaze = \"fixation\"\naccept_mixed_pictures = true\n");
      const std::string timing = "[timing]\n";
      if (const auto at = text.bytes.find(timing); at != std::string::npos)
        text.bytes.insert(at + timing.size(), "overrun_s = 20\n");
      const std::string stimulus = "kind = \"stimulus\"\n";
      if (const auto at = text.bytes.find(stimulus); at != std::string::npos)
        text.bytes.insert(at + stimulus.size(), "on_interruption = \"invalidate\"\n");
      const std::string scale = "scale = [1, 7]\n";
      if (const auto at = text.bytes.find(scale); at != std::string::npos)
        text.bytes.insert(at + scale.size(), "level = 4.5\n");
      const std::string quest = "kind = \"quest_plus\"\n";
      if (const auto at = text.bytes.find(quest); at != std::string::npos)
        text.bytes.insert(at + quest.size(), "guess = 0.1\n");
      try {
        study::parse_protocol(text.bytes, text.name);
        out.push_back(text);
      } catch (const base::Error&) {
      }
    }
  }
  return out;
}

/// Does with an accepted protocol what programs do: assigns a slot, makes a plan, and schedules the frames of
/// the first and the last cell if they are fewer than 5000.
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

TEST(HostileValues, OfAnyKeyOfAProtocolAreTakenOrRefusedWithPlaceAndMend) {
  const auto names = test::try_hostile_values(
      sound_protocols(),
      [](const std::string& text) { return study::parse_protocol(text, test::hostile_name); }, use);
  // Every key of the reference must occur. Tables and lists of tables are left out, because their keys are
  // checked. SCORE, KEY and FACTOR are placeholders for any name.
  EXPECT_TRUE(names.contains("rate_per_s"));
  for (const auto& key : study::protocol_reference()) {
    const bool any_name = key.key == "SCORE" || key.key == "KEY" || key.key == "FACTOR";
    if (key.type.find("table") == std::string::npos && !any_name) {
      EXPECT_TRUE(names.contains(key.key)) << key.table << " " << key.key;
    }
  }
}

TEST(HostileValues, ASpreadTooSmallToBeToldFromNoneIsRefused) {
  const auto changed = test::with_keys(test::shipped_text("ptpe_pilot"), {{"sd_fps", "[0, 1e-308]"}});
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
