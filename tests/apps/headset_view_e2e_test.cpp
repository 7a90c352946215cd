/// vip-view --display openxr on the simulated headset.
#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

#include "tests/apps/headset_runs.hpp"
#include "tests/apps/small_dam.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HeadsetViewE2e : public test::HeadsetRuns {
 protected:
  /// A small dam that breaks at once, seen from close by.
  void SetUp() override { base::write_file_atomically(folder_ / "dam.toml", test::small_dam); }

  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all{bin + "/vip-view", folder_ / "dam.toml", "--display",
                                 "openxr",          "--backend",          "cpu"};
    all.insert(all.end(), more.begin(), more.end());
    if (std::find(all.begin(), all.end(), "--n-star") == all.end()) all.insert(all.end(), {"--n-star", "64"});
    return all;
  }
  test::Ended view(const std::string& profile, const std::vector<std::string>& more) {
    std::filesystem::remove(log());
    test::Ended ended = run_program_in_headset(arguments(more), "size=64x64;" + profile);
    EXPECT_THAT(calls(), Not(HasSubstr("BREACH")));
    return ended;
  }
  /// The text that matches `what` in the left eye's part of each frame's log line.
  std::vector<std::string> logged(const std::string& what) const {
    std::vector<std::string> found;
    std::istringstream lines(calls());
    const std::regex pattern("projection space.* left .*?(" + what + ")");
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (std::regex_search(line, match, pattern)) found.push_back(match[1]);
    }
    return found;
  }
};

TEST_F(HeadsetViewE2e, AFluidRunsAtItsOwnSpeedAndIsDrawnAnewInEverySlot) {
  std::string all = "0";
  for (int i = 1; i < 200; ++i) all += "," + std::to_string(i);
  const auto ended = view("head=walk;rates=120;rate=120;dump=" + all,
                          {"--method", "LoRes", "--clock", "virtual", "--frames", "12"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("shown in    Simulated headset, 64 x 64 px an eye"));
  EXPECT_THAT(ended.out, HasSubstr("levels      follow the eye tracker\n"));
  EXPECT_THAT(ended.out, HasSubstr("frames      12, of the last 11 mean 60.0, SD 0.0 frames/s\n"));
  EXPECT_THAT(ended.out, HasSubstr("ended       after its frames\n"));
  // 60 frames a second at 120 Hz take two slots each. The pose must differ from slot to slot.
  const auto poses = logged("at [-.0-9]+ [-.0-9]+ [-.0-9]+ turned [-.0-9]+ [-.0-9]+ [-.0-9]+ [-.0-9]+");
  EXPECT_GE(poses.size(), 23u);
  EXPECT_EQ(std::set<std::string>(poses.begin(), poses.end()).size(), poses.size());
  const std::regex number(R"(\nframe (\d+) .*projection space)");
  std::smatch first;
  const std::string text = calls();
  ASSERT_TRUE(std::regex_search(text, first, number));
  const long shown = std::stol(first[1]);
  EXPECT_NE(picture(shown, "left").rgba, picture(shown, "right").rgba);
  EXPECT_NE(picture(shown, "left").rgba, picture(shown + 20, "left").rgba);
}

TEST_F(HeadsetViewE2e, LevelsFollowTheEyesOrElseTheHead) {
  const auto last_picture = [&](const std::string& profile, const std::string& says) {
    const auto ended = view("hash=1;" + profile,
                            {"--method", "Ours", "--clock", "virtual", "--frames", "8", "--n-star", "512"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("levels      follow " + says));
    const auto hashes = logged("shows left [0-9a-f]+");
    return hashes.empty() ? "" : hashes.back();
  };
  const std::string left = last_picture("look_yaw=30", "the eye tracker");
  EXPECT_NE(left, "");
  EXPECT_EQ(last_picture("look_yaw=30", "the eye tracker"), left);
  EXPECT_NE(last_picture("look_yaw=-30", "the eye tracker"), left);
  const std::string ahead = last_picture("look_yaw=0", "the eye tracker");
  EXPECT_EQ(last_picture("look_yaw=30;gaze=0", "the head's direction"), ahead);
}

TEST_F(HeadsetViewE2e, ItGoesOnUntilTheHeadsetIsLeftAndWaitsWhileItIsOff) {
  const auto ended = view("clock=real;rates=20;rate=20;at=60:off/1,120:exit", {"--method", "LoRes"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("ended       the headset's software asked to leave\n"));
  EXPECT_THAT(calls(), HasSubstr("xrDestroySession"));
}

TEST_F(HeadsetViewE2e, ASessionThatIsLostIsMadeAnewAndARuntimeThatEndsIsAnError) {
  const auto goes_on = view("clock=real;rates=20;rate=20;at=60:lost,160:exit", {"--method", "LoRes"});
  ASSERT_EQ(goes_on.exit_code, 0) << goes_on.err;
  EXPECT_THAT(goes_on.out, HasSubstr("ended       the headset's software asked to leave\n"));
  const std::string text = calls();
  EXPECT_NE(text.find("xrCreateSession"), text.rfind("xrCreateSession"));
  const auto ends = view("clock=real;rates=20;rate=20;at=60:instance_lost", {"--method", "LoRes"});
  EXPECT_EQ(ends.exit_code, 1);
  EXPECT_THAT(ends.err, ::testing::ContainsRegex("^vip-view: error: [^\n]+\n  mend: [^\n]+\n$"));
}

TEST_F(HeadsetViewE2e, WithoutAHeadsetItFallsBackToTheDesktopAndSaysWhy) {
  const auto falls_back = [&](const Environment& environment, const std::string& why) {
    const auto ended = run_any(arguments({"--method", "LoRes"}), environment);
    EXPECT_EQ(ended.exit_code, 1);  // the test machine has no desktop either
    EXPECT_THAT(ended.err,
                ::testing::ContainsRegex("^no headset: [^\n]*" + why + "[^\n]*; shown on the desktop\n"));
    EXPECT_THAT(ended.err,
                HasSubstr(VIP_WINDOW ? "window: no display" : "window: this build has no windows"));
  };
  falls_back({{"VIP_OPENXR_LOADER", "/nowhere.so"}}, "nowhere.so");
  falls_back({{"XR_RUNTIME_JSON", "/nowhere.json"}}, "OpenXR");
  falls_back(simulated("headset=unavailable"), "no headset is connected");
  falls_back(simulated("without=XR_KHR_opengl_enable"), "XR_KHR_opengl_enable");
}

TEST_F(HeadsetViewE2e, WhatMakesNoSenseIsRefused) {
  const auto refused = [&](const std::vector<std::string>& more, const std::string& why, int status = 1) {
    const auto ended = view("", more);
    EXPECT_EQ(ended.exit_code, status);
    EXPECT_THAT(ended.err, HasSubstr(why));
  };
  refused({"--overlay", "level"}, "--overlay level: is not painted in a headset");
  refused({"--headless"}, "--display", 2);
  const auto ended = run_any({bin + "/vip-view", folder_ / "dam.toml", "--clock", "virtual"}, {});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("--clock virtual: is for a headset"));
  // --clock virtual needs a runtime whose time stands still while the program computes. This runtime's time
  // does not, so the program refuses and does not fall back to the desktop.
  const auto real = view("clock=real;rates=20;rate=20", {"--clock", "virtual"});
  EXPECT_EQ(real.exit_code, 1);
  EXPECT_THAT(real.err, HasSubstr("the headset's time does not wait"));
}

}  // namespace
}  // namespace apps
