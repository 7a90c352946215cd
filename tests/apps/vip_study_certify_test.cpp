/// vip-study certify as a user runs it, on public logs of other programs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/process.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

apps::test::Ended vip_study(const std::string& arguments) {
  return apps::test::run_shell(VIP_BIN_DIR "/vip-study " + arguments);
}

const std::string logs = VIP_TEST_DIR "/libstudy/fixtures/frame_logs/";

/// The words of the certificate's line that has all of these texts.
std::vector<std::string> words_of(const std::string& out, const std::vector<std::string>& texts) {
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    bool all = line.find(" frames in ") == std::string::npos;
    for (const std::string& text : texts) all = all && line.find(text) != std::string::npos;
    std::istringstream words(line);
    if (all) return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

/// Compares a line of the certificate with moments.awk.
void expect_moments(const std::string& file, const std::string& column, const std::string& program = "",
                    const std::string& awk = "-F ,") {
  SCOPED_TRACE(file + " " + column);
  const auto certificate = vip_study("certify " + logs + file);
  EXPECT_EQ(certificate.exit_code, 0) << certificate.out;
  const auto words = words_of(certificate.out, {column, program});
  ASSERT_GE(words.size(), 15u) << certificate.out;
  const auto from_end = [&](std::size_t i) { return words[words.size() - i]; };
  const auto script = apps::test::run_shell("awk " + awk + " -v column='" + column + "'" +
                                            (program.empty() ? "" : " -v program=" + program) + " -f " +
                                            logs + "moments.awk " + logs + file);
  ASSERT_EQ(script.exit_code, 0) << script.out;
  std::istringstream expected(script.out);
  std::string mean, sd, p99, longest, hitches, p95, frames;
  expected >> mean >> sd >> p99 >> longest >> hitches >> p95 >> frames;
  EXPECT_EQ(from_end(14), mean);
  EXPECT_EQ(from_end(12), sd);
  EXPECT_EQ(from_end(10), p99);
  EXPECT_EQ(from_end(9), longest);
  EXPECT_EQ(from_end(8), hitches);
  EXPECT_THAT(certificate.out, testing::HasSubstr(": " + frames + " frames in "));
  EXPECT_THAT(certificate.out, testing::HasSubstr("95 % of the intervals up to " + p95 + " ms"));
}

}  // namespace

TEST(VipStudyCertifyE2e, EqualsAScriptOnPublicLogs) {
  for (const char* program : {"dwm.exe", "Presenter.exe"}) {
    expect_moments("presentmon1.csv", "msBetweenPresents", program);
    expect_moments("presentmon1.csv", "msBetweenDisplayChange", program);
    expect_moments("presentmon2.csv", "FrameTime", program);
    expect_moments("presentmon2.csv", "DisplayedTime", program);
  }
  for (const char* file : {"presentmon_app.csv", "capframex.csv", "ocat.csv", "frameview.csv"}) {
    expect_moments(file, "MsBetweenPresents");
    expect_moments(file, "MsBetweenDisplayChange");
  }
  expect_moments("fraps.csv", "Time (ms)", "", "-F ';' -v cumulative=1 -v comma=1");
}

TEST(VipStudyCertifyE2e, RefusesLogsThatDoNotHoldEveryFrame) {
  const auto sampled = vip_study("certify " + logs + "mangohud.csv");
  EXPECT_EQ(sampled.exit_code, 1);
  EXPECT_THAT(sampled.out, testing::HasSubstr("does not hold every frame"));
  EXPECT_THAT(sampled.out, testing::HasSubstr("log_interval=0"));
  const auto rates = vip_study("certify " + logs + "ovr_metrics.csv");
  EXPECT_EQ(rates.exit_code, 1);
  EXPECT_THAT(rates.out, testing::HasSubstr("ovr_metrics.csv:1: has no column of frame times"));
}

TEST(VipStudyCertifyE2e, JudgesASettingAndNamesTheLineOfAnError) {
  const study::test::TemporaryFolder folder;
  const auto file = folder / "game.csv";
  std::ofstream(file) << "FrameTime\n20\n20\n20\n";
  EXPECT_THAT(vip_study("certify " + file.string()).out, testing::Not(testing::HasSubstr("pass\n")));
  const auto passed = vip_study("certify " + file.string() + " --mean 50");
  EXPECT_THAT(passed.out, testing::HasSubstr("1 of 1 trials pass"));
  const auto failed = vip_study("certify " + file.string() + " --mean 60 --sd 5");
  EXPECT_THAT(failed.out, testing::HasSubstr("0 of 1 trials pass, 1 FAIL"));
  EXPECT_THAT(failed.out, testing::HasSubstr("mean 50 frames/s is off by 17 %"));
  EXPECT_NE(vip_study("certify " + file.string() + " --sd 5").exit_code, 0);
  std::ofstream(file, std::ios::app) << "x\n";
  const auto refused = vip_study("certify " + file.string());
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, testing::HasSubstr("game.csv:5: \"x\" is no frame time"));
  std::ofstream(file) << "FrameTime\n20\n";
  EXPECT_THAT(vip_study("certify " + file.string()).out, testing::HasSubstr("fewer than two frame times"));
  std::ofstream(file) << "FrameTime\n";
  EXPECT_EQ(vip_study("certify " + file.string()).exit_code, 1);
}

TEST(VipStudyCertifyE2e, ReadsUnrealAndOlderMangoHud) {
  const study::test::TemporaryFolder folder;
  const auto unreal = folder / "unreal.csv";
  std::ofstream(unreal) << "EVENTS,FrameTime\n,16\n,17\nEVENTS,FrameTime\n[HasHeaderRowAtEnd],1,[os],x\n";
  EXPECT_THAT(vip_study("certify " + unreal.string()).out, testing::HasSubstr("2 frames in 0.033000 s"));
  const auto mangohud = folder / "mangohud.csv";
  std::ofstream(mangohud) << "os,cpu,gpu\nx,y,z\nfps,frametime,elapsed\n50,20000,0\n50,20000,20000000\n";
  EXPECT_THAT(vip_study("certify " + mangohud.string()).out, testing::HasSubstr("2 frames in 0.040000 s"));
}
