/// Timing profiles: hitches, a 5 % low, recorded frame times, latency and animation error.

#include "libstudy/pacing/profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "libstudy/display/null.hpp"
#include "libstudy/pacing/capture.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/readers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/toml.hpp"
#include "stats/quantiles.hpp"
#include "tests/common/temporary_folder.hpp"

using namespace study;
using testing::HasSubstr;

namespace {

const TimingProfile hitching{
    .kind = ProfileKind::Hitches, .mean_fps = 60, .hitch_ms = 100, .period_s = 2, .jitter = 0.5};
const TimingProfile low{.kind = ProfileKind::Floor, .mean_fps = 50, .low_fps = 25};
const TimingProfile trace{.kind = ProfileKind::Trace, .frame_ms = {10, 20, 30}};

/// Times in s at which intervals longer than `longer_than_s` begin.
std::vector<double> onsets_of_long(const std::vector<double>& intervals_s, double longer_than_s) {
  std::vector<double> out;
  double time_s = 0;
  for (const double interval : intervals_s) {
    if (interval > longer_than_s) out.push_back(time_s);
    time_s += interval;
  }
  return out;
}

/// Content steps of the frames of a showing at constant intervals.
std::vector<std::int64_t> steps_shown(const TimingProfile& profile, double content_step_s) {
  const ContentRules content =
      content_of({.real_time = true, .content_step_s = content_step_s}, setting_of(profile, 1));
  VirtualClock clock;
  NullDisplay display;
  NullStimulus stimulus(content_step_s);
  const std::vector<std::int64_t> intervals(10, 20'000'000);
  std::vector<std::int64_t> out;
  for (const FrameRecord& frame : play_trial(intervals, content, stimulus, display, clock, {}, {}).frames)
    out.push_back(frame.content_step);
  return out;
}

}  // namespace

TEST(Profile, OneHitchInTheMiddlePartOfEachPeriod) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto at = onsets_of_long(pattern_intervals(hitching, 10, seed), 0.05);
    ASSERT_EQ(at.size(), 5u);
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_GE(at[i], 2 * static_cast<double>(i) + 0.5 - 1.0 / 60);
      EXPECT_LE(at[i], 2 * static_cast<double>(i) + 1.5);
    }
  }
  EXPECT_NE(pattern_intervals(hitching, 10, 1), pattern_intervals(hitching, 10, 2));
  EXPECT_EQ(pattern_intervals(hitching, 10, 1), pattern_intervals(hitching, 10, 1));
}

TEST(Profile, TheSlowestTwentiethIsTheFloor) {
  const auto intervals = pattern_intervals(low, 10, 3);
  const double sum_s = std::accumulate(intervals.begin(), intervals.end(), 0.0);
  EXPECT_NEAR(static_cast<double>(intervals.size()) / sum_s, 50, 1e-9);
  EXPECT_EQ(std::count(intervals.begin(), intervals.end(), 1.0 / 25), 25);
  EXPECT_EQ(*std::max_element(intervals.begin(), intervals.end()), 1.0 / 25);
}

TEST(Profile, ATraceRepeatsAndItsTwinIsEven) {
  EXPECT_THAT(pattern_intervals(trace, 0.1, 0), testing::ElementsAre(0.01, 0.02, 0.03, 0.01, 0.02));
  TimingProfile twin = trace;
  twin.smoothed = true;
  for (const double interval : pattern_intervals(twin, 0.1, 0)) EXPECT_NEAR(interval, 0.018, 1e-12);
  EXPECT_EQ(setting_of(twin, 0.1).sd, 0);
  EXPECT_NEAR(setting_of(twin, 0.1).mean, setting_of(trace, 0.1).mean, 1e-12);
}

TEST(Profile, ADisplayRoundsToItsPeriods) {
  const RefreshVerdict exact = quantise(setting_of(hitching, 4), {}, 60, 0);
  EXPECT_EQ(exact.feasibility, Feasibility::Exact);
  EXPECT_EQ(std::count(exact.holds.begin(), exact.holds.end(), 6), 2);
  const RefreshVerdict near = quantise(setting_of(hitching, 4), {}, 90, 0);
  EXPECT_EQ(near.feasibility, Feasibility::Approximate) << near.reason;
  EXPECT_THAT(near.reason, HasSubstr("to fit periods of 11.11 ms"));
  TimingProfile fast = hitching;
  fast.mean_fps = 120;
  const RefreshVerdict never = quantise(setting_of(fast, 4), {}, 60, 0);
  EXPECT_EQ(never.feasibility, Feasibility::Unreachable);
  EXPECT_TRUE(never.holds.empty());
  EXPECT_THAT(never.reason, HasSubstr("give a mean of"));
}

TEST(Profile, LatencyDelaysTheContentAndNothingElse) {
  TimingProfile late{.mean_fps = 50, .latency_ms = 60};
  EXPECT_THAT(steps_shown(late, 0.02), testing::ElementsAre(0, 0, 0, 0, 1, 2, 3, 4, 5, 6));
  late.latency_ms = 0;
  EXPECT_THAT(steps_shown(late, 0.02), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(Profile, AnimationErrorAlternatesAndNeverRunsBackwards) {
  TimingProfile uneven{.mean_fps = 50, .animation_error_ms = 10};
  EXPECT_THAT(steps_shown(uneven, 0.01), testing::ElementsAre(0, 3, 4, 7, 8, 11, 12, 15, 16, 19));
  uneven.animation_error_ms = 30;  // longer than a frame
  const auto steps = steps_shown(uneven, 0.01);
  EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end()));
}

TEST(Profile, RefusesNumbersThatContradictEachOther) {
  const auto error_of = [](TimingProfile profile, auto change) {
    change(profile);
    try {
      setting_of(profile, 4);
    } catch (const base::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_of(hitching, [](auto& p) { p.hitch_ms = 10; }), HasSubstr("is shorter than the"));
  EXPECT_THAT(error_of(hitching, [](auto& p) { p.hitch_ms = 1990; }), HasSubstr("do not fit into a period"));
  EXPECT_THAT(error_of(low, [](auto& p) { p.low_fps = 60; }), HasSubstr("cannot have a 5 % low of 60"));
  EXPECT_THAT(error_of(low, [](auto& p) { p.low_fps = 2; }), HasSubstr("cannot have a 5 % low of 2"));
  EXPECT_THAT(error_of(trace, [](auto& p) { p.frame_ms.clear(); }), HasSubstr("holds no frame"));
}

TEST(Profile, TheVerdictCountsHitches) {
  const auto intervals = pattern_intervals(hitching, 10, 0);
  PlayedTrial played;
  std::int64_t now_ns = 0;
  for (const double interval : intervals) {
    FrameRecord frame;
    frame.scheduled_ns = frame.times.submitted_ns = now_ns;
    frame.times.gpu_done_ns = now_ns;
    played.frames.push_back(frame);
    now_ns += std::llround(1e9 * interval);
  }
  played.end_ns = now_ns;
  const TimingVerdict verdict = judge_trial(setting_of(hitching, 10), {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.hitches, 5);
  EXPECT_NEAR(verdict.longest_ms, 100, 1e-6);
  EXPECT_NEAR(verdict.p95_ms, 1000.0 / 60, 1e-3);
}

namespace {

/// Reads a capture with this text.
FrameCapture captured(const std::string& text, const std::string& column = "",
                      std::optional<double> seconds = {}) {
  const ::test::TemporaryFolder folder;
  base::write_file_atomically(folder / "game.csv", text);
  return read_capture(folder / "game.csv", column, seconds);
}

const std::string presentmon =
    "//GameName=Some Game\r\n"
    "Application,ProcessID,MsBetweenPresents,msBetweenDisplayChange\r\n"
    "\"A, B.exe\",12,0,16.6\r\n\"A, B.exe\",12,16.66671,16.7\r\n\"A, B.exe\",12,17.25,0\r\n"
    "\"A, B.exe\",12,33.4,33.3\r\n";

}  // namespace

TEST(Capture, ReadsColumnsOfPresentMonAndOneColumnOfNumbers) {
  using testing::ElementsAre;
  const FrameCapture presents = captured(presentmon);
  EXPECT_EQ(presents.column, "MsBetweenPresents");
  EXPECT_THAT(presents.frame_ms, ElementsAre(16.667, 17.25, 33.4)) << "the first row has no frame before it";
  EXPECT_EQ(presents.left_out, 1);
  const FrameCapture displayed = captured(presentmon, "MSBETWEENDISPLAYCHANGE");
  EXPECT_THAT(displayed.frame_ms, ElementsAre(16.6, 16.7, 33.3)) << "0: never shown";
  EXPECT_THAT(captured("16.7\n17\n\n").frame_ms, ElementsAre(16.7, 17));
  EXPECT_THAT(captured("\xEF\xBB\xBFt;frame ms\n1;16,7\n2;17,5\n", "frame ms").frame_ms,
              ElementsAre(16.7, 17.5));
  EXPECT_THAT(captured("10\n20\n30\n40\n", "", 0.03).frame_ms, ElementsAre(10, 20));
}

TEST(Capture, ReadsOcatWhoseFirstRowDescribesTheComputer) {
  const std::string ocat = "MsBetweenPresents,Motherboard,OS\n10,\"A, B\",x\n20\n";
  EXPECT_THAT(captured(ocat).frame_ms, testing::ElementsAre(10, 20));
  EXPECT_THROW(captured(ocat + "30,x\n"), base::Error);
}

TEST(Capture, ReadsEveryFormatThatCertificatesRead) {
  using testing::ElementsAre;
  const FrameCapture fraps = captured("Frame; Time (ms)\n1;0\n2;16,5\n3;33\n");
  EXPECT_THAT(fraps.frame_ms, ElementsAre(16.5, 16.5));
  EXPECT_EQ(fraps.left_out, 1);
  EXPECT_THAT(captured("os,cpu,gpu\nx,y,z\nfps,frametime\n50,20000\n50,21000\n").frame_ms,
              ElementsAre(20, 21))
      << "microseconds of an older MangoHud";
  EXPECT_THAT(captured("a,DisplayedTime\n1,16\n2,NA\n3,17\n").frame_ms, ElementsAre(16, 17));
  const std::string json =
      R"({"Info": {"ProcessName": "g.exe"}, "Runs": [{"CaptureData": {"TimeInSeconds": [0, 0.017],)"
      R"( "MsBetweenPresents": [16.6666, 17], "MsBetweenDisplayChange": ["NaN", 16]}}]})";
  EXPECT_THAT(captured(json).frame_ms, ElementsAre(16.667, 17));
}

TEST(Capture, LeavesOutALastNumberThatMayBeCut) {
  const FrameCapture cut = captured("FrameTime\n16\n17\n1");
  EXPECT_THAT(cut.frame_ms, testing::ElementsAre(16, 17));
  EXPECT_THAT(cut.remarks, testing::Contains(HasSubstr("the last line of the file does not end")));
  EXPECT_THAT(captured("FrameTime\n16\n17\n").remarks,
              testing::Not(testing::Contains(HasSubstr("the last line of the file"))));
}

TEST(Capture, ItsLineIsTheTimingOfALevel) {
  const FrameCapture capture = captured("10\n20\n30\n");
  const auto root = base::parse_toml(timing_line(capture), "level.toml");
  EXPECT_EQ(read_profile(root.table("timing")), trace);
  EXPECT_EQ(describe_capture(capture), "3 frames in 0.060 s, mean 50.00, SD 28.33, 5 % low 33.33 frames/s");
}

TEST(Capture, RefusesJunkWithItsLine) {
  const auto error_of = [](const std::string& text, const std::string& column = "", double seconds = 0) {
    try {
      captured(text, column, seconds > 0 ? std::optional(seconds) : std::nullopt);
    } catch (const base::Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("mend: "));
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of("16.7\n17\nfast\n"), HasSubstr("game.csv:3: \"fast\" is no frame time"));
  EXPECT_THAT(error_of("16.7\n0\n"), HasSubstr("game.csv:2: \"0\""));
  EXPECT_THAT(error_of("16.7\nnan\n"), HasSubstr("game.csv:2: \"nan\""));
  EXPECT_THAT(error_of("16.7\n1e9\n"), HasSubstr("game.csv:2: \"1e9\""));
  EXPECT_THAT(error_of(presentmon + "C,12,16\n"), HasSubstr("game.csv:7: has 3 fields where 4 belong"));
  EXPECT_THAT(error_of(presentmon + "C,13,16,16\nC,13,16,16\n"),
              HasSubstr("several windows or programs: A, B.exe, process 12; C, process 13"));
  EXPECT_THAT(error_of(presentmon, "ms"), HasSubstr("game.csv:2: has no column ms"));
  EXPECT_THAT(error_of("time,frame\n1,16\n"), HasSubstr("game.csv:1: has no column of frame times"));
  EXPECT_THAT(error_of("1,16\n2,17\n"), HasSubstr("game.csv:1: holds numbers where"));
  EXPECT_THAT(error_of("\x7F"
                       "ELF\n1\n"),
              HasSubstr("game.csv:1: is no text"));
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("16.7\n"), HasSubstr("fewer than two frame times"));
  EXPECT_THAT(error_of("16.7\n\n17\n"), HasSubstr("game.csv:2: is blank inside the table"));
  EXPECT_THAT(error_of("TimeInSeconds,FrameTime\n0,16\n1,16\n2,16\n"),
              HasSubstr("does not hold every frame"));
  const auto run = [](const std::string& data) { return R"({"Runs": [{"CaptureData": {)" + data + "}}]}"; };
  EXPECT_THAT(error_of(R"({"Runs": [{"Capt)"),
              HasSubstr("game.csv: is no whole JSON text: it ends too early, at line 1"));
  EXPECT_THAT(error_of("{}"), HasSubstr("game.csv: is JSON without the list Runs"));
  EXPECT_THAT(error_of(run(R"("MsBetweenPresents": [16, 17], "Dropped": [true])")),
              HasSubstr("game.csv: run 1: has 2 values of MsBetweenPresents and 1 of Dropped"));
  EXPECT_THAT(error_of(run(R"("MsBetweenPresents": [16, "x"])")),
              HasSubstr("run 1, frame 2, MsBetweenPresents"));
  EXPECT_THAT(error_of(run(R"("MsBetweenPresents": [16, 17, 99999])")),
              HasSubstr("game.csv: run 1, frame 3: \"99999\""));
  EXPECT_THAT(error_of("16.7\n17\n", "", 5), HasSubstr("lasts 0.034 s"));
}
