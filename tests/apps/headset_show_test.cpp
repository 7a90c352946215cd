/// vip-study headset --show: its output for sessions that go well, and for those that do not.
#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HeadsetShowE2e : public test::HeadsetRuns {
 protected:
  /// Uses small pictures.
  test::Ended show(const std::string& profile, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"--show", seconds_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return on("size=64x64;" + profile, arguments);
  }
  /// Expects a session that ends well and prints these lines.
  void expect_says(const std::string& profile, const std::vector<std::string>& lines,
                   const std::vector<std::string>& more = {}) {
    const auto ended = show(profile, more);
    EXPECT_EQ(ended.exit_code, 0) << profile << ": " << ended.err;
    for (const std::string& line : lines) EXPECT_THAT(ended.out, HasSubstr(line)) << profile;
    EXPECT_THAT(calls(), HasSubstr("xrDestroyInstance")) << profile;
  }

  std::string seconds_ = "0.5";  ///< for --show; counted in predicted display time
};

TEST_F(HeadsetShowE2e, ASessionGoesThroughItsStates) {
  const std::string to_focused = "states      idle, ready, synchronized, visible, focused, ";
  expect_says("", {"shown in    Simulated headset, 64 x 64 px an eye, GL_SRGB8_ALPHA8\n",
                   to_focused + "visible, synchronized, stopping, idle, exiting\n",
                   "frames      47, 46 with pictures\n",
                   "rate        90.00 Hz measured from predicted times; 90 Hz reported by the runtime\n",
                   "dropped     0 slots; 0 predicted times repeated, 0 off the grid\n",
                   "ended       after the time of --show\n"});
  EXPECT_THAT(calls(), Not(HasSubstr("\nnote")));
}

TEST_F(HeadsetShowE2e, TheRateIsMeasuredAndNeverTheFirstPeriod) {
  // The only rate that is listed is the display's.
  expect_says("rates=90;rate=90;wrong_periods=5",
              {"rate        90.00 Hz measured from predicted times; 90 Hz reported by the runtime\n"});
  EXPECT_THAT(calls(), Not(HasSubstr("xrGetDisplayRefreshRateFB")));
  expect_says("without=XR_FB_display_refresh_rate;rate=20", {"not known: too few steps"});
  expect_says("rates=90;rate=90;at=30:skips/1", {"rate        90.00 Hz measured", "dropped     9 slots"});
  // drop/3 skips three slots. The repeated time skips a fourth, the slot that should have come then.
  expect_says("at=30:drop/3,35:repeat",
              {"rate        90.00 Hz", "dropped     4 slots; 1 predicted times repeated"});
}

TEST_F(HeadsetShowE2e, ASlotWithoutAValidTimeIsLeftOutAndManyEndTheProgram) {
  expect_says("at=30:untimed/1", {"dropped     1 slots; 0 predicted times repeated, 0 off the grid\n"});
  const auto ended = show("at=10:untimed/40");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("the runtime predicts no valid times for its frames\n  mend: "));
}

TEST_F(HeadsetShowE2e, WhetherTheHeadsetIsWornIsReportedWhereTheRuntimeKnows) {
  expect_says("presence=1;at=20:worn/0,30:worn/1",
              {"worn        reported by the runtime\n", "note        the headset was taken off\n",
               "note        the headset was put on\n"});
  for (const char* profile : {"at=20:worn/0", "presence=1;without=XR_EXT_user_presence;at=20:worn/0"})
    expect_says(profile, {"worn        not reported, except by its states\n"});
}

TEST_F(HeadsetShowE2e, AChangeOfTheRateIsTold) {
  seconds_ = "1";
  for (const char* profile : {"at=28:rate/72", "at=28:rate/72;rates=90"})
    expect_says(profile, {"note        refresh went from 90 to 72 Hz\n", "rate        72.00 Hz"});
}

TEST_F(HeadsetShowE2e, ARateIsAskedForAndConfirmed) {
  const char* runs = "rate        120.00 Hz measured from predicted times; 120 Hz reported by the runtime\n";
  expect_says("", {runs}, {"--refresh", "120"});
  expect_says("ignores_rate=1", {"rate        90.00 Hz", "note        the display did not go to 120 Hz\n"},
              {"--refresh", "120"});
  const auto ended = show("", {"--refresh", "75"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("75 Hz is not one of its refresh rates"));
}

TEST_F(HeadsetShowE2e, PositiveCodesUnknownEventsAndLateImagesAreNoFailures) {
  for (const char* profile : {"positive=1", "at=5:unknown,9:events_lost/3", "image_timeouts=3",
                              "leave_context=none;leave_error=1", "leave_context=other;leave_error=1"})
    expect_says(profile, {"frames      47, 46 with pictures\n"});
}

TEST_F(HeadsetShowE2e, NothingIsShownThatNobodySeesOrNobodyKnowsFromWhere) {
  expect_says("at=20:orientation/0", {"frames      47, 19 with pictures\n"});
  expect_says("at=20:shown/0,30:shown/1", {"frames      47, 36 with pictures\n"});
}

TEST_F(HeadsetShowE2e, TheEyesAreFollowedAtTheirOwnRate) {
  seconds_ = "1";
  expect_says("look_yaw=-10;look_pitch=5;yaw=30;pitch=-8;x=1",
              {"100.0 % valid, 100.0 % tracked; on average 10.0 degrees right, 5.0 up\n"});
  expect_says("gaze_rate=30", {"gaze        31 samples, 100.0 % valid"});
  expect_says("gaze_tracked=0", {" samples, 100.0 % valid, 0.0 % tracked"});
  expect_says("gaze_valid=0", {" samples, 0.0 % valid, 0.0 % tracked\n"});
}

TEST_F(HeadsetShowE2e, EyesThatAreNotFollowedAreNotAskedFor) {
  for (const char* profile : {"gaze=0", "without=XR_EXT_eye_gaze_interaction"}) {
    expect_says(profile, {"gaze        none\n"});
    EXPECT_THAT(calls(), Not(HasSubstr("gaze_ext")));
  }
}

TEST_F(HeadsetShowE2e, HandsAnswerWhileTheSessionIsFocused) {
  const std::string presses =
      "at=10:select/1,14:select/0,18:select/1,22:select/0,24:thumb_x/0.9,28:thumb_x/0";
  expect_says(presses, {"hands       pressed 2 times, stick pushed 0 times\n"});
  for (const char* controller : {"oculus/touch_controller", "htc/vive_focus3_controller",
                                 "bytedance/pico4_controller", "bytedance/pico_neo3_controller"})
    expect_says(std::string("controller=") + controller + ";" + presses,
                {"hands       pressed 2 times, stick pushed 1 times\n"});
  expect_says("controller=ext/hand_interaction_ext;" + presses,
              {"hands       pressed 2 times, stick pushed 0 times\n"});
  expect_says("controller=bytedance/pico4_controller;without=XR_BD_controller_interaction;" + presses,
              {"hands       pressed 0 times, stick pushed 0 times\n"});
  expect_says("controller=none;" + presses, {"hands       pressed 0 times, stick pushed 0 times\n"});
  expect_says("at=8:focus/0,10:select/1,14:select/0,16:focus/1", {"hands       pressed 0 times"});
}

TEST_F(HeadsetShowE2e, TheHeadsetIsTakenOffAndPutOnAgain) {
  expect_says("at=20:off/0.1",
              {"focused, visible, synchronized, stopping, idle, ready, synchronized, visible, focused"});
  EXPECT_THAT(calls(), HasSubstr("xrEndSession"));
}

TEST_F(HeadsetShowE2e, ASessionThatIsLostIsMadeAnew) {
  for (const char* profile : {"at=20:lost/3", "at=20:lost_now", "at=20:instance_lost/5"}) {
    expect_says(profile, {"note        a session was lost and started again\n",
                          "ended       after the time of --show\n"});
  }
  const auto ended = show("at=5:lost_now,10:lost_now,15:lost_now");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("keeps losing the session"));
  EXPECT_THAT(ended.out, HasSubstr("ended       by an error\n"));
}

TEST_F(HeadsetShowE2e, TheRuntimeMayAskToLeave) {
  expect_says("at=20:exit", {"exiting\n", "ended       the runtime asked to leave\n"});
}

TEST_F(HeadsetShowE2e, AWaitThatNeverReturnsIsGivenUp) {
  const auto ended = show("at=10:hang/60", {"--patience", "0.5"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("the runtime has let no frame begin for 0.5 s"));
  EXPECT_THAT(ended.err, HasSubstr("mend: "));
  EXPECT_THAT(ended.out, HasSubstr("frames      10, "));
}

TEST_F(HeadsetShowE2e, WhatCannotShowIsRefused) {
  for (const auto& [profile, says] : std::vector<std::pair<std::string, std::string>>{
           {"opaque=0", "shows the world through the picture"},
           {"without=XR_MNDX_egl_enable", "does not offer XR_MNDX_egl_enable"},
           {"formats=depth32f", "offers no format of pictures"},
           {"formats=srgb_only;broken=srgb8_alpha8", "xrCreateSwapchain"},
           {"headset=unavailable", "no headset is connected"}}) {
    const auto ended = show(profile);
    EXPECT_EQ(ended.exit_code, 1) << profile;
    EXPECT_THAT(ended.err, HasSubstr(says)) << profile;
    EXPECT_THAT(ended.out, Not(HasSubstr("shown in"))) << profile;
  }
}

}  // namespace
}  // namespace apps
