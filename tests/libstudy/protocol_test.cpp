#include "libstudy/protocol/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using testing::HasSubstr;

std::string pilot_text() { return base::read_file(base::resource("protocols/ptpe_pilot.toml"), 1 << 20); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Line and column of the '|' in `marked`, a part of `text` but for that mark.
std::string place_of(const std::string& text, std::string marked) {
  const auto mark = marked.find('|');
  if (text.find(marked.erase(mark, 1)) == std::string::npos) return "(no '" + marked + "' in the text)";
  const auto at = text.find(marked) + mark;
  const auto line_start = text.rfind('\n', at - 1) + 1;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  return "p.toml:" + std::to_string(line) + ":" + std::to_string(at - line_start + 1);
}

std::string error_of(const std::string& text) {
  try {
    study::parse_protocol(text, "p.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(Protocol, PilotHasThePapers21Settings) {
  const auto protocol = study::parse_protocol(pilot_text(), "p.toml");
  std::set<std::pair<double, double>> cells;
  for (const auto& setting : protocol.settings) {
    EXPECT_EQ(setting.duration_s, 10);
    EXPECT_LT(setting.sd, setting.mean);
    cells.emplace(setting.mean, setting.sd);
  }
  EXPECT_EQ(protocol.settings.size(), 21u);
  EXPECT_EQ(cells.size(), 21u);
  for (double mean = 10; mean <= 50; mean += 10) {
    for (double sd = 0; sd <= 20 && sd < mean; sd += 5) EXPECT_TRUE(cells.count({mean, sd}));
  }
}

TEST(Protocol, PilotIsThatOfThePaper) {
  const auto protocol = study::parse_protocol(pilot_text(), "p.toml");
  EXPECT_EQ(protocol.participants, 16);
  EXPECT_EQ(protocol.gap_s, 3);
  EXPECT_EQ(protocol.stimulus.method, "HiRes");
  EXPECT_EQ(protocol.stimulus.n_star, "32k");
  EXPECT_EQ(protocol.pacing.mean, study::FpsMean::Harmonic);
  EXPECT_EQ(protocol.pacing.fps_min, 4);
  EXPECT_FALSE(protocol.pacing.fps_max);
  EXPECT_EQ(protocol.content.content_step_s, 1.0 / 60);
  EXPECT_EQ(protocol.question.scale_min, 1);
  EXPECT_EQ(protocol.question.scale_max, 7);
  ASSERT_EQ(protocol.question.anchors.size(), 3u);
  EXPECT_EQ(protocol.question.anchors[1], (std::pair<int, std::string>(4, "neutral")));
  EXPECT_FALSE(protocol.test_data);
  EXPECT_EQ(protocol.sha256, base::sha256_hex(pilot_text()));
}

TEST(Protocol, OverrideMarksTestDataAndChangesTheHash) {
  auto protocol = study::parse_protocol(pilot_text(), "p.toml");
  const std::string original = protocol.sha256;
  study::override_trial_seconds(protocol, 2);
  EXPECT_TRUE(protocol.test_data);
  EXPECT_NE(protocol.sha256, original);
  for (const auto& setting : protocol.settings) EXPECT_EQ(setting.duration_s, 2);
  auto again = study::parse_protocol(pilot_text(), "p.toml");
  study::override_trial_seconds(again, 2);
  EXPECT_EQ(again.sha256, protocol.sha256);
  study::override_trial_seconds(again, 1.5);
  EXPECT_NE(again.sha256, protocol.sha256);
  for (const double bad : {0.0, -1.0, 1e9, std::nan("")})
    EXPECT_THROW(study::override_trial_seconds(again, bad), base::Error);
}

struct Malformed {
  const char* from;
  const char* to;
  const char* place;    // part of the changed text, with '|' where the error must point
  const char* problem;  // part of the message
  const char* mend;
};

class MalformedProtocol : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedProtocol, IsRefusedWithPlaceAndMend) {
  const auto& param = GetParam();
  const std::string text = replaced(pilot_text(), param.from, param.to);
  const std::string error = error_of(text);
  EXPECT_THAT(error, HasSubstr(place_of(text, param.place) + ": "));
  EXPECT_THAT(error, HasSubstr(param.problem));
  EXPECT_THAT(error, HasSubstr("\n  mend: "));
  EXPECT_THAT(error, HasSubstr(param.mend));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, MalformedProtocol,
    testing::Values(
        Malformed{"gap_s = 3 ", "gap = 3\ngap_s = 3 ", "gap = |3", "is not a known key", "gap_s"},
        Malformed{"at_end = \"loop\"", "", "|[content]", "'content.at_end' is missing", "add 'at_end"},
        Malformed{"start_frame = 0", "", "|[content]", "'content.start_frame' is missing", "add"},
        Malformed{"duration_s = 10", "duration_s = \"10\"", "duration_s = |\"10", "must be a number",
                  "without quotes"},
        Malformed{"duration_s = 10", "duration_s = -1", "duration_s = |-1", "out of range", "use a value in"},
        Malformed{"participants = 16", "participants = 1.5", "= |1.5", "must be a whole number", "fraction"},
        Malformed{"order = \"white\"", "order = \"pink\"", "= |\"pink", "is not a known choice", "\"ar1\""},
        Malformed{"order = \"white\"", "order = \"ar1\"", "|[pacing]", "'pacing.ar1' is missing", "add"},
        Malformed{"order = \"white\"", "ar1 = 0.5", "ar1 = |0.5", "needs order", "remove ar1"},
        Malformed{"max_interval_ms = 250", "max_interval_ms = 200", "ms = |200", "contradicts fps_min = 4",
                  "raise max_interval_ms to 250 or fps_min to 5"},
        Malformed{"fps_min = 4 ", "fps_min = 10", "fps_min = |10", "leaves no room for (10, 5)",
                  "lower fps_min"},
        Malformed{"fps_max = \"none\"", "fps_max = 45.5", "= |45.5", "leaves no room for (50, 0)", "raise"},
        Malformed{"fps_max = \"none\"", "fps_max = \"high\"", "= |\"high", "is not a known choice",
                  "refresh"},
        Malformed{"mean_fps = [10, 20", "mean_fps = [20, 20", "= |[20, 20", "holds a value twice", "once"},
        Malformed{"[0, 5, 10, 15, 20]", "[60]", "= |[60]", "has no value below a mean", "smaller"},
        Malformed{"score = 7", "score = 4\n# end", "score = |4\n# end", "does not ascend", "ascending"},
        Malformed{"score = 7", "score = 77", "= |77", "out of range", "use a value in [1, 7]"},
        Malformed{"format = 1", "format = 2", "format = |2", "is not the format", "use the program"},
        Malformed{"scale_max = 7", "scale_max = 1", "scale_max = |1", "is not above scale_min", "low, high"},
        Malformed{"name = \"ptpe_pilot\"", "name = \"\"", "name = |\"\"", "is empty", "write a text"}));

TEST(Protocol, BrokenSyntaxNamesThePlace) {
  const std::string text = replaced(pilot_text(), "gap_s = 3 ", "gap_s = = 3 ");
  EXPECT_THAT(error_of(text), HasSubstr("p.toml:"));
  EXPECT_THAT(error_of(text), HasSubstr("mend: "));
}

}  // namespace
