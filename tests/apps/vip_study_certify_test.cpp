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

/// Splits the certificate's line that contains all of `texts` into words; empty if there is no such line.
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

/// Expects the numbers that moments.awk computes in the certificate's line of this column and program.
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
  for (const char* program : {"dwm.exe", "GRB.exe"}) {
    expect_moments("presentmon_2019.csv", "MsBetweenPresents", program);
    expect_moments("presentmon_2019.csv", "MsBetweenDisplayChange", program);
  }
  for (const char* file : {"capframex.csv", "ocat.csv", "frameview.csv"}) {
    expect_moments(file, "MsBetweenPresents");
    expect_moments(file, "MsBetweenDisplayChange");
  }
  // The rows of capframex.csv, in the layout of CapFrameX' JSON files.
  const auto json = vip_study("certify " + logs + "capframex.json");
  const auto rows = vip_study("certify " + logs + "capframex.csv");
  for (const char* column : {"MsBetweenPresents", "MsBetweenDisplayChange"}) {
    auto of_json = words_of(json.out, {column}), of_rows = words_of(rows.out, {column});
    ASSERT_GE(of_json.size(), 15u) << json.out;
    of_json.erase(of_json.begin(), of_json.end() - 15);
    of_rows.erase(of_rows.begin(), of_rows.end() - 15);
    EXPECT_EQ(of_json, of_rows);
  }
  expect_moments("fraps.csv", "Time (ms)", "", "-F ';' -v cumulative=1 -v comma=1");
}

TEST(VipStudyCertifyE2e, RefusesLogsThatDoNotHoldEveryFrame) {
  const auto sampled = vip_study("certify " + logs + "mangohud.csv");
  EXPECT_EQ(sampled.exit_code, 1);
  EXPECT_THAT(sampled.out, testing::HasSubstr("so the log does not hold every frame"));
  // PresentMon's application writes a display interval for frames that were never shown, too.
  const auto counted = vip_study("certify " + logs + "presentmon_app.csv");
  EXPECT_EQ(counted.exit_code, 1);
  EXPECT_THAT(counted.out, testing::HasSubstr("for a frame that was never shown"));
  EXPECT_EQ(vip_study("certify " + logs + "presentmon_app.csv --column MsBetweenPresents").exit_code, 0);
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
  EXPECT_THAT(passed.out, testing::HasSubstr("1 of 1 lines pass"));
  const auto failed = vip_study("certify " + file.string() + " --mean 60 --sd 5");
  EXPECT_THAT(failed.out, testing::HasSubstr("0 of 1 lines pass"));
  EXPECT_THAT(failed.out, testing::HasSubstr("mean 50 frames/s is off by 17 %"));
  EXPECT_NE(vip_study("certify " + file.string() + " --sd 5").exit_code, 0);
  std::ofstream(file, std::ios::app) << "x\n";
  const auto refused = vip_study("certify " + file.string());
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, testing::HasSubstr("game.csv:5: \"x\" is no frame time"));
  std::ofstream(file) << "TimeInSeconds,FrameTime\n0,4000\n0.004,4000\n0.008,4000\n";
  EXPECT_THAT(vip_study("certify " + file.string()).out,
              testing::HasSubstr("so it does not hold frame times in ms"));
  std::ofstream(file) << "FrameTime\n20\n";
  EXPECT_THAT(vip_study("certify " + file.string()).out, testing::HasSubstr("fewer than two frame times"));
  std::ofstream(file) << "FrameTime\n";
  EXPECT_EQ(vip_study("certify " + file.string()).exit_code, 1);
}

TEST(VipStudyCertifyE2e, SaysNothingThatALogDoesNotHold) {
  const study::test::TemporaryFolder folder;
  const auto certified = [&](const std::string& text, const std::string& options = "") {
    std::ofstream(folder / "log.csv") << text;
    return vip_study("certify " + (folder / "log.csv").string() + options);
  };
  using testing::HasSubstr;
  EXPECT_THAT(certified("fps\n60\n60\n").out, HasSubstr("holds rates, not frame times"));
  EXPECT_THAT(certified("fps,frametime\n290,3.4\n290,120\n290,3.4\n").out, HasSubstr("120.000"));
  EXPECT_THAT(certified("\"a;b\",FrameTime\n1,16\n2,16\n").out, HasSubstr("62.500"));
  EXPECT_THAT(certified("FrameTime\n16\n16\nFrameTime\n99\n").out,
              HasSubstr("log.csv:4: names the columns again"));
  EXPECT_THAT(certified("a,DisplayLatency\n1,16\n1,16\n", " --column DisplayLatency").out,
              HasSubstr("taken for frame times, as --column asks"));
  EXPECT_THAT(certified("Frame,Time (ms)\n1,0\n2,16\n3,10\n").out,
              HasSubstr("the time goes from 16 to 10 ms"));
  EXPECT_THAT(certified("TimeInSeconds,MsBetweenPresents\n0,16\n0.016,16\n0.01,16\n").out,
              HasSubstr("TimeInSeconds goes back"));
  EXPECT_THAT(certified("TimeInSeconds,MsBetweenDisplayChange\n0,16\n100,16\n200,16\n").out,
              HasSubstr("does not hold every frame"));
  EXPECT_THAT(certified("Application,FrameTime\na,16\na,16\nb,16\n").out,
              HasSubstr("FrameTime of b has fewer than two intervals in 1 rows and is left out"));
  const auto cut = certified("FrameTime\n16\n16\n1");
  EXPECT_THAT(cut.out, HasSubstr("2 frames in 0.032000 s"));
  EXPECT_THAT(cut.out,
              HasSubstr("the last line of the file does not end, so its row may be cut and is left out"));
  EXPECT_THAT(certified("FrameTime\n16\n\n16\n").out, HasSubstr("log.csv:3: is blank inside the table"));
  EXPECT_THAT(certified("FrameTime\n16\n16\n").out, HasSubstr("whether rows are missing is not known"));
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

TEST(VipStudyCertifyE2e, AnExportForPresentMonHasTheCertificateOfEachShowing) {
  const study::test::TemporaryFolder folder;
  const std::string database = (folder / "s.db").string(), csv = (folder / "csv").string();
  ASSERT_EQ(
      vip_study("run ptpe_pilot --db " + database + " --participants 1 --observer constant:4").exit_code, 0);
  const auto exported = vip_study("export --db " + database + " --csv " + csv + " --presentmon");
  ASSERT_EQ(exported.exit_code, 0) << exported.out;
  EXPECT_THAT(exported.out, testing::HasSubstr(" showings, 0 left out)"));
  const auto awk = apps::test::run_shell(
      "awk -F , 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i } "
      "NR > 1 { print $at[\"presentation_id\"], $at[\"mean_fps\"], $at[\"sd_fps\"] }' " +
      csv + "/presentations.csv");
  const auto certificate = vip_study("certify " + csv + "/presentmon/*.csv");
  ASSERT_EQ(certificate.exit_code, 0) << certificate.out;
  std::istringstream showings(awk.out);
  int count = 0;
  double expected_mean = 0, expected_sd = 0;
  for (int id = 0; showings >> id >> expected_mean >> expected_sd; ++count) {
    const auto words = words_of(certificate.out, {"showing_" + std::to_string(id) + ".csv "});
    ASSERT_GE(words.size(), 15u) << certificate.out;
    EXPECT_NEAR(std::stod(words[words.size() - 14]), expected_mean, 5.1e-4) << id;
    EXPECT_NEAR(std::stod(words[words.size() - 12]), expected_sd, 5.1e-4) << id;
  }
  EXPECT_EQ(count, 21) << awk.out;
}
