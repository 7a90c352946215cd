/// The reader of data/truth: it reads every file there, and reports errors in malformed ones.

#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

constexpr const char* good =
    "# quantity: dam_front\n# scene: dam.toml\n# x: T = t sqrt(2 g / length)\n# y: H = h / (2 length)\n"
    "# length_m: 0.5\n# gate: 0.05\n# gate_ours: 0.1\n# source: a book\n# A remark: with a "
    "colon.\nT,H\n0,1\n1,0.5\n";

std::string with(const std::string& from, const std::string& to) {
  std::string out = good;
  return out.replace(out.find(from), from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    const auto file = parse_truth("f.csv", text);
    file.time();
    file.length();
    file.gate("gate", true);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

TEST(TruthFiles, AreWellFormed) {
  for (const auto& path : truth_paths()) EXPECT_NO_THROW(read_truth(path)) << path;
}

TEST(TruthFiles, NameScalesAndGates) {
  const auto file = parse_truth("f.csv", good);
  EXPECT_EQ(file.time().column, "T");
  EXPECT_DOUBLE_EQ(file.time().factor, std::sqrt(2.0));
  EXPECT_EQ(file.length().column, "H");
  EXPECT_DOUBLE_EQ(file.length().factor, 0.5);
  EXPECT_EQ(file.gate().value(), 0.05);
  EXPECT_EQ(file.gate("gate", true).value(), 0.1);
  EXPECT_EQ(file.column("H"), (std::vector<double>{1, 0.5}));
  EXPECT_FALSE(parse_truth("f.csv", with("gate: 0.05", "gate: none")).gate());
  // Values are in seconds and metres; the experiment's length scales them.
  EXPECT_DOUBLE_EQ(parse_truth("f.csv", with(" sqrt(2 g / length)", "")).time().factor,
                   std::sqrt(0.5 / gravity));
  EXPECT_DOUBLE_EQ(parse_truth("f.csv", with(" / (2 length)", "")).length().factor, 0.5);
  EXPECT_DOUBLE_EQ(parse_truth("f.csv", with("(2 length)", "length")).length().factor, 1);
}

TEST(TruthFiles, WhatIsWrongIsSaidWithItsLine) {
  using testing::HasSubstr;
  EXPECT_EQ(error_of(good), "");
  EXPECT_THAT(error_of(with("dam_front", "dam_frnt")), HasSubstr("f.csv:1: no test measures 'dam_frnt'"));
  EXPECT_THAT(error_of(with("# quantity: dam_front\n", "")), HasSubstr("lacks 'quantity'"));
  EXPECT_THAT(error_of(with("# source: a book\n", "")), HasSubstr("lacks 'source'"));
  EXPECT_THAT(error_of(with("# gate: 0.05\n", "")), HasSubstr("lacks 'gate'"));
  EXPECT_THAT(error_of(with("gate: 0.05", "gate: high")), HasSubstr("f.csv:6: gate is 'high'"));
  EXPECT_THAT(error_of(with("gate: 0.05", "gate: -1")), HasSubstr("f.csv:6: gate is '-1'"));
  EXPECT_THAT(error_of(with("gate_ours", "gate_theirs")), HasSubstr("f.csv:7: 'gate_theirs' is no key"));
  EXPECT_THAT(error_of(with("gate_ours", "gate")), HasSubstr("f.csv:7: 'gate' comes twice"));
  EXPECT_THAT(error_of(with("t sqrt(2 g / length)", "2 t")), HasSubstr("f.csv:3: x is 'T = 2 t'"));
  EXPECT_THAT(error_of(with("h / (2 length)", "h / 2")), HasSubstr("f.csv:4: y is 'H = h / 2'"));
  EXPECT_THAT(error_of(with("y: H", "y: Z")), HasSubstr("f.csv:10: there is no column 'Z'"));
  EXPECT_THAT(error_of(with("1,0.5", "1,half")), HasSubstr("f.csv:12: 'half' in column H is not a number"));
  EXPECT_THAT(error_of(with("1,0.5", "1,nan")), HasSubstr("f.csv:12: 'nan'"));
  EXPECT_THAT(error_of(with("1,0.5", "1")), HasSubstr("f.csv:12: 1 cells where the header has 2"));
  EXPECT_THAT(error_of(with("0,1\n1,0.5\n", "")), HasSubstr("f.csv:10: there are no rows"));
  EXPECT_THAT(error_of(with("dam_front", "wall_pressure")),
              HasSubstr("f.csv:1: the header lacks 'sensor_height_m'"));
  for (const std::string key : {"sensor_height_m", "sensor_across_m", "sensor_size_m"})
    EXPECT_THAT(error_of(with("# length_m: 0.5\n", "# length_m: 0.5\n# " + key + ": low\n")),
                HasSubstr("f.csv:6: " + key + " is 'low', not a number above 0"));
  EXPECT_THAT(error_of(with("gate_ours", "sensor_height")), HasSubstr("f.csv:7: 'sensor_height' is no key"));
}

TEST(TruthFiles, AnotherFolderIsRead) {
  const auto folder = std::filesystem::temp_directory_path() / ("truth_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "good.csv") << good;
  std::ofstream(folder / "wrong.csv") << with("1,0.5", "1");
  std::ofstream(folder / "note.txt") << "no file of numbers";
  setenv("VIP_TRUTH_DIR", folder.c_str(), 1);
  EXPECT_EQ(truth_paths().size(), 2u);
  ASSERT_EQ(truth_of("dam_front").size(), 1u);
  EXPECT_EQ(truth_of("dam_front")[0].name(), "good.csv");
  EXPECT_TRUE(truth_of("free_fall").empty());
  std::filesystem::remove_all(folder);
  EXPECT_THROW(truth_paths(), base::Error);
  unsetenv("VIP_TRUTH_DIR");
}

}  // namespace
