#include "libsim/ptpe/ptpe_file.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stats/base/error.hpp"

namespace {

sim::PtpeFile example() {
  sim::PtpeFile file;
  file.model = {23.68, 0.1 + 0.2 - 0.28, stats::FpsMean::Arithmetic};  // not a short decimal
  file.level = 4;
  file.a_ci = {1.0 / 3, 25};
  file.b_ci = {-1e-17, 0.03};
  file.band = {{0, {1.0 / 3, 25}, true}, {10, {20, 40.5}, true}, {20, {25, 50}, false}};
  file.n_participants = 16;
  file.n_simulated = 3;
  file.test_data = true;
  file.protocol_sha256 = std::string(64, 'a');
  file.date_utc = "2026-01-31T12:00:00Z";
  return file;
}

std::string with(const std::string& from, const std::string& to) {
  auto text = sim::format_ptpe_file(example());
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    sim::parse_ptpe_file(text, "fitted.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

TEST(PtpeFile, ReadsBackEveryBitOfWhatItWrites) {
  const auto file = example();
  const auto back = sim::parse_ptpe_file(sim::format_ptpe_file(file), "x");
  EXPECT_EQ(back.model.a, file.model.a);
  EXPECT_EQ(back.model.b, file.model.b);
  EXPECT_EQ(back.level, file.level);
  EXPECT_EQ(back.a_ci, file.a_ci);
  EXPECT_EQ(back.b_ci, file.b_ci);
  ASSERT_EQ(back.band.size(), file.band.size());
  for (std::size_t i = 0; i < file.band.size(); ++i) {
    EXPECT_EQ(back.band[i].delta, file.band[i].delta);
    EXPECT_EQ(back.band[i].mu, file.band[i].mu);
    EXPECT_EQ(back.band[i].in_reach, file.band[i].in_reach);
  }
  EXPECT_EQ(back.n_participants, file.n_participants);
  EXPECT_EQ(back.n_simulated, file.n_simulated);
  EXPECT_EQ(back.test_data, file.test_data);
  EXPECT_EQ(back.model.mean, file.model.mean);
  EXPECT_EQ(back.protocol_sha256, file.protocol_sha256);
  EXPECT_EQ(back.date_utc, file.date_utc);
}

TEST(PtpeFile, RefusesEachMalformedFileAtItsPlace) {
  const std::vector<std::pair<std::string, std::string>> changes{
      {"a_fps = 23.68", "a_fps = 0.0"},
      {"n_simulated = 3", "n_simulated = 17"},
      {"test_data = true", "test_data = 1"},
      {"a_fps = 23.68", "a_fps = \"23\""},
      {"a_fps = 23.68", "a_fps = nan"},
      {"a_fps = 23.68", "a = 23.68"},
      {"a_fps = 23.68", "a_fps = 25.5"},
      {"b_ci95_s = [-1e-17, 0.03]", "b_ci95_s = [-1e-17, -1e-18]"},
      {"level = 4.0", "level = 8.0"},
      {"level = 4.0", "level = 4.0\nlevel = 4.0"},
      {"level = 4.0", "level = 4.0\nsize = 1"},
      {"b_s", "b_ms"},
      {"b_ci95_s = [-1e-17", "b_ci95_s = [1.0"},
      {"band_delta_fps = [0.0, 10.0, 20.0]", "band_delta_fps = [0.0, 20.0, 10.0]"},
      {"band_delta_fps = [0.0, 10.0, 20.0]", "band_delta_fps = [0.0, 10.0]"},
      {"band_delta_fps = [0.0, 10.0, 20.0]", "band_delta_fps = []"},
      {"band_low95_fps = [0.3333333333333333, 20.0", "band_low95_fps = [0.3333333333333333, 40.0"},
      {"band_low95_fps = [0.3333333333333333", "band_low95_fps = [-1.0"},
      {"band_high95_fps = [25.0", "band_high95_fps = [20.0"},
      {"band_high95_fps", "band_high"},
      {"band_out_of_reach_fps = [20.0]", "band_out_of_reach_fps = [15.0]"},
      {"band_out_of_reach_fps = [20.0]", "band_out_of_reach_fps = [20.0, 20.0]"},
      {"n_participants = 16", "n_participants = 0"},
      {"n_participants = 16", "n_participants = 16.5"},
      {"arithmetic", "geometric"},
      {"aaaa", "AAAA"},
      {"2026-01-31T12:00:00Z", "yesterday"},
      {"[ptpe]", "[ptpe"},
      {"a_ci95_fps = [0.3333333333333333, 25.0]", "a_ci95_fps = [0.3333333333333333, 25.0, 26.0]"}};
  for (const auto& [from, to] : changes) {
    const auto words = error_of(with(from, to));
    EXPECT_TRUE(words.starts_with("fitted.toml:")) << from << " -> " << to << ": " << words;
    EXPECT_NE(words.find("mend"), std::string::npos) << words;
  }
  EXPECT_NE(error_of(""), "");
}

TEST(PtpeFile, SaysHowFarItLeavesMuOpen) {
  const auto words = sim::describe(example());
  EXPECT_NE(words.find("mu uncertain by up to +-52 % at delta 0 to 20"), std::string::npos) << words;
}

TEST(PtpeFile, WithoutABandIsOfTheFirstFormat) {
  auto file = example();
  file.band.clear();
  const auto text = sim::format_ptpe_file(file);
  EXPECT_NE(text.find("format = 1\n"), std::string::npos) << text;
  const auto back = sim::parse_ptpe_file(text, "x");
  EXPECT_TRUE(back.band.empty());
  EXPECT_EQ(sim::describe(back).find("open"), std::string::npos);
  EXPECT_NE(error_of(with("format = 2", "format = 1")), "");
}

TEST(PtpeFile, OfSimulatedPeopleOrTestDataSaysSo) {
  auto file = example();
  EXPECT_NE(sim::describe(file).find("16 participants, 3 of them SIMULATED, TEST DATA"), std::string::npos)
      << sim::describe(file);
  file.n_simulated = 0;
  file.test_data = false;
  file.band.clear();
  EXPECT_NE(sim::describe(file).find("arithmetic mean, 16 participants)"), std::string::npos);
}

TEST(PtpeFile, NamesTheLineOfTheFault) {
  // Comment, format, blank, [ptpe], a, b, level.
  EXPECT_TRUE(error_of(with("level = 4.0", "level = 8.0")).starts_with("fitted.toml:7:"));
}

TEST(PtpeFile, RefusesANewerFormat) {
  const auto words = error_of(with("format = 2", "format = 3"));
  EXPECT_NE(words.find("format"), std::string::npos) << words;
}

TEST(PtpeFile, IsRefusedAtEveryTruncation) {
  const auto text = sim::format_ptpe_file(example());
  // Without its last line feed the file is still whole.
  for (std::size_t size = 0; size + 1 < text.size(); ++size)
    EXPECT_NE(error_of(text.substr(0, size)), "") << size;
}

TEST(PtpeFile, IsNamedWhenItIsMissing) {
  try {
    sim::read_ptpe_file("no/such/fitted.toml");
    FAIL() << "read a file that is not there";
  } catch (const base::Error& error) {
    EXPECT_NE(std::string(error.what()).find("no/such/fitted.toml"), std::string::npos);
  }
}

TEST(PtpeFile, IsNeverWrittenWithANumberThatIsNone) {
  auto file = example();
  file.model.b = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sim::format_ptpe_file(file), std::invalid_argument);
}

}  // namespace
