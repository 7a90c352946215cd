/// vip-study check as users run it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

apps::test::Ended vip_study(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-study " + arguments);
}

TEST(VipStudyCheckE2e, ReportsThePilotOn90Hz) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto outcome = vip_study("check protocols/ptpe_pilot.toml --refresh 90 --json " + json_path.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, testing::HasSubstr("14 exact, 7 approximate, 0 unreachable of 21"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("play speed: 0.17 to 0.83 of real time"));
  const auto json = nlohmann::json::parse(base::read_file(json_path, 1 << 20));
  EXPECT_EQ(json.at("exact"), 14);
  EXPECT_EQ(json.at("settings").size(), 21u);
  EXPECT_EQ(json.at("common_refreshes").size(), 11u);
  // Five to seven minutes with the answers (the paper's protocol as we read it).
  EXPECT_GE(json.at("plan_with_answers_s").at(0), 5 * 60);
  EXPECT_LE(json.at("plan_with_answers_s").at(1), 7 * 60);
  for (const auto& setting : json.at("settings")) {
    EXPECT_LE(setting.at("longest_hold_ms"), 250);
    EXPECT_EQ(setting.at("status") == "exact", setting.at("reason") == "");
  }
}

TEST(VipStudyCheckE2e, BadInputGivesOneErrorAndNoFile) {
  const study::test::TemporaryFolder folder;
  const auto json_path = folder / "check.json";
  const auto broken = folder / "broken.toml";
  std::ofstream(broken) << "format = 1\nname = \"x\"\nversion = 3\n";
  const auto outcome = vip_study("check " + broken.string() + " --refresh 90 --json " + json_path.string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, testing::HasSubstr("broken.toml:3:11: 'version' must be text"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("mend: "));
  EXPECT_FALSE(std::filesystem::exists(json_path));
  EXPECT_EQ(vip_study("check " + broken.string()).exit_code, 2);
  EXPECT_EQ(vip_study("check " + broken.string() + " --refresh 0").exit_code, 2);
}

}  // namespace
