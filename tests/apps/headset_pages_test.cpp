/// Logic of a page in a headset: its size, and the effect of hands, eyes and keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libstudy/pages/gui/pad.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/pages/headset/dwell.hpp"
#include "libstudy/pages/headset/hand_keys.hpp"
#include "libstudy/pages/headset/page_place.hpp"
#include "libstudy/pages/headset/terminal_keys.hpp"
#include "stats/base/error.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180;
constexpr std::int64_t ms = 1'000'000;

study::HeadsetPose head(double yaw_deg, double pitch_deg) {
  const double yaw = 0.5 * yaw_deg * degree, pitch = 0.5 * pitch_deg * degree;
  study::HeadsetPose pose;
  pose.place_m = {0.3F, 1.6F, -0.2F};
  // The yaw about the vertical axis, then the pitch about the turned head's x axis.
  pose.turn = {static_cast<float>(std::cos(yaw) * std::sin(pitch)),
               static_cast<float>(std::sin(yaw) * std::cos(pitch)),
               static_cast<float>(-std::sin(yaw) * std::sin(pitch)),
               static_cast<float>(std::cos(yaw) * std::cos(pitch))};
  pose.place_valid = pose.turn_valid = true;
  return pose;
}

/// Degrees between two places on a page for an eye `distance` m in front of its middle. The places are in m
/// from the middle.
double degrees_between(double x1, double y1, double x2, double y2, double distance) {
  const double dot = x1 * x2 + y1 * y2 + distance * distance;
  const double one = std::sqrt(x1 * x1 + y1 * y1 + distance * distance);
  const double two = std::sqrt(x2 * x2 + y2 * y2 + distance * distance);
  return std::acos(dot / one / two) / degree;
}

TEST(HeadsetPages, APageIsUprightAheadAndAtMostFortyDegreesWide) {
  const study::HeadsetPage page = study::place_page(head(30, -20));
  EXPECT_NEAR(page.pose.place_m[0], 0.3 - 1.5 * std::sin(30 * degree), 1e-5);
  EXPECT_NEAR(page.pose.place_m[1], 1.6, 1e-5);
  EXPECT_NEAR(page.pose.place_m[2], -0.2 - 1.5 * std::cos(30 * degree), 1e-5);
  EXPECT_THAT(study::axes_of(page.pose)[4], 1) << "neither rolled nor pitched";
  const double half = 0.5 * static_cast<double>(page.width_m);
  EXPECT_LE(degrees_between(-half, 0, half, 0, 1.5), 40);
  EXPECT_NEAR(static_cast<double>(page.height_m / page.width_m), 1120.0 / 1280, 1e-6) << "square pixels";
}

TEST(HeadsetPagesGl, TheLetterXIsHalfADegreeHighInEveryPlaceOfAPage) {
  const sim::GlContext gl = sim::GlContext::make_headless();
  const sim::Offscreen picture(16, 16);
  const study::Gui gui(study::type_for_x_height(study::px_of_height(study::least_x_height_deg)),
                       {[] {}, [&picture] { return picture.framebuffer(); }, true});
  const study::HeadsetPage page = study::place_page(head(0, 0));
  const double width = static_cast<double>(page.width_m), height = static_cast<double>(page.height_m);
  const double x_height = static_cast<double>(gui.x_height_px()) * height / study::page_height_px;
  for (const double u : {-0.5, 0.0, 0.5}) {
    for (const double v : {-0.5, 0.0, 0.5}) {
      const double towards_middle = v > 0 ? -x_height : x_height;
      EXPECT_GE(degrees_between(u * width, v * height, u * width, v * height + towards_middle, 1.5), 0.5)
          << u << " " << v;
    }
  }
}

TEST(HeadsetPages, ARayMeetsThePageWhereItPoints) {
  const study::HeadsetPage page = study::place_page(head(0, 0));
  study::HeadsetPose ray = head(0, 0);
  EXPECT_THAT(study::meet_page(page, ray)->first, ::testing::FloatNear(640, 0.01F));
  EXPECT_THAT(study::meet_page(page, ray)->second, ::testing::FloatNear(560, 0.01F));
  const auto upper_right = study::meet_page(page, head(-15, 10));
  const double px = study::page_width_px / static_cast<double>(page.width_m);
  EXPECT_NEAR(upper_right->first, 640 + px * 1.5 * std::tan(15 * degree), 0.1);
  EXPECT_LT(upper_right->second, 560);
  EXPECT_FALSE(study::meet_page(page, head(-25, 0))) << "beside it";
  EXPECT_FALSE(study::meet_page(page, head(180, 0))) << "away from it";
  ray.place_m[2] = -3;
  EXPECT_FALSE(study::meet_page(page, ray)) << "from behind it";
}

TEST(HeadsetPages, APageComesAfterAHeadThatTurnedOrWentAway) {
  const study::HeadsetPage page = study::place_page(head(0, 0));
  EXPECT_FALSE(study::is_left_behind(page, head(40, 10)));
  EXPECT_TRUE(study::is_left_behind(page, head(60, 0)));
  study::HeadsetPose far = head(0, 0);
  far.place_m[2] += 1;
  EXPECT_TRUE(study::is_left_behind(page, far));
}

/// Looks at a target from one time to another in slots of 10 ms. Returns the number of choices.
int look(study::Dwell& dwell, unsigned target, bool seen, int from_ms, int to_ms) {
  int chosen = 0;
  for (int at = from_ms; at < to_ms; at += 10) chosen += dwell.look(target, seen, at * ms) ? 1 : 0;
  return chosen;
}

TEST(HeadsetPages, ALookOfASecondChoosesOnceUntilItHasLeft) {
  study::Dwell dwell;
  EXPECT_EQ(look(dwell, 7, true, 0, 990), 0);
  EXPECT_NEAR(dwell.progress(), 0.98, 0.011);
  EXPECT_EQ(look(dwell, 7, true, 990, 5000), 1);
  EXPECT_EQ(look(dwell, 0, true, 5000, 5050), 0);
  EXPECT_EQ(look(dwell, 7, true, 5050, 6100), 1);
  EXPECT_EQ(look(dwell, 0, true, 7000, 9000), 0) << "nothing is no choice";
}

TEST(HeadsetPages, AnotherTargetBeginsAnew) {
  study::Dwell dwell;
  EXPECT_EQ(look(dwell, 7, true, 0, 900), 0);
  EXPECT_EQ(look(dwell, 8, true, 900, 1800), 0);
  EXPECT_EQ(look(dwell, 8, true, 1800, 2000), 1);
}

TEST(HeadsetPages, ABlinkPausesALookAndALostEyeBeginsItAnew) {
  study::Dwell blinked;
  EXPECT_EQ(look(blinked, 7, true, 0, 600), 0);
  EXPECT_EQ(look(blinked, 7, false, 600, 800), 0);
  EXPECT_EQ(look(blinked, 7, true, 800, 1180), 0) << "the blink itself is no look";
  EXPECT_EQ(look(blinked, 7, true, 1180, 1400), 1);
  study::Dwell lost;
  EXPECT_EQ(look(lost, 7, true, 0, 600), 0);
  EXPECT_EQ(look(lost, 7, false, 600, 1000), 0);
  EXPECT_EQ(look(lost, 7, true, 1000, 1900), 0);
  EXPECT_EQ(look(lost, 7, true, 1900, 2100), 1);
}

study::HeadsetHands pushing(float right, float up) {
  study::HeadsetHands hands;
  hands.stick = {right, up};
  return hands;
}

TEST(HeadsetPages, AStickPushesOnceAndAgainWhenItIsHeld) {
  study::HandKeys keys;
  const auto pushes = [&](float right, float up, int from_ms, int to_ms) {
    std::vector<study::PageKey> out;
    for (int at = from_ms; at < to_ms; at += 10) {
      for (const study::PageEvent& event : keys.take(pushing(right, up), true, at * ms))
        out.push_back(*event.key);
    }
    return out;
  };
  EXPECT_THAT(pushes(0.9F, 0.2F, 0, 400), ElementsAre(study::PageKey::Right));
  EXPECT_THAT(pushes(0.5F, 0, 400, 450), ElementsAre()) << "not let go yet";
  EXPECT_THAT(pushes(0, 0, 450, 500), ElementsAre());
  EXPECT_THAT(pushes(0, -0.8F, 500, 1100), ElementsAre(study::PageKey::Down, study::PageKey::Down));
  keys.forget();
  EXPECT_THAT(pushes(0, -0.8F, 1100, 2000), ElementsAre()) << "held since before";
}

TEST(HeadsetPages, ALongPressOfMenuAsksToStopOnce) {
  study::HandKeys keys;
  study::HeadsetHands hands;
  hands.menu = true;
  int stops = 0, first_ms = -1;
  for (int at = 0; at < 3000; at += 10) {
    for (const study::PageEvent& event : keys.take(hands, false, at * ms)) stops += event.stop ? 1 : 0;
    if (stops > 0 && first_ms < 0) first_ms = at;
  }
  EXPECT_EQ(stops, 1);
  EXPECT_EQ(first_ms, 1000);
}

TEST(HeadsetPages, ATerminalsBytesAreKeys) {
  const auto events = study::page_events("\033[C5\r\033[Z\033OB-\x7f");
  ASSERT_EQ(events.size(), 7u);
  EXPECT_EQ(events[0].key, study::PageKey::Right);
  EXPECT_EQ(events[1].digit, 5);
  EXPECT_EQ(events[1].letters, "5");
  EXPECT_EQ(events[2].key, study::PageKey::Enter);
  EXPECT_EQ(events[3].key, study::PageKey::Previous);
  EXPECT_EQ(events[4].key, study::PageKey::Down);
  EXPECT_TRUE(events[5].minus);
  EXPECT_EQ(events[6].key, study::PageKey::Erase);
  for (const study::PageEvent& event : events) EXPECT_FALSE(event.stop);
  EXPECT_TRUE(study::page_events("\033")[0].stop);
}

study::Question question(study::AnswerKind kind) {
  study::Question out;
  out.kind = kind;
  out.scale_min = -9;
  out.scale_max = 99;
  return out;
}

TEST(HeadsetPages, APadTypesNumbersByArrowsAndEnter) {
  const study::Question age = question(study::AnswerKind::Number);
  study::PageState state({&age, 1}, 0, 0);
  study::Pad pad(age);
  const auto press = [&](study::PageKey key) { return pad.press(key, state, 1000 * ms); };
  EXPECT_FALSE(press(study::PageKey::Enter)) << "no arrow was used";
  EXPECT_TRUE(press(study::PageKey::Right));
  EXPECT_TRUE(press(study::PageKey::Right));
  EXPECT_TRUE(press(study::PageKey::Enter));
  EXPECT_TRUE(press(study::PageKey::Left));
  EXPECT_TRUE(press(study::PageKey::Enter));
  EXPECT_EQ(state.item(0).typed, "21");
  EXPECT_FALSE(press(study::PageKey::Down)) << "leaves the pad";
  EXPECT_FALSE(press(study::PageKey::Enter));
  pad.type(study::Pad::erase, state, 1000 * ms);
  pad.type(study::Pad::erase, state, 1000 * ms);
  pad.type(pad.rows()[0][10], state, 1000 * ms);
  pad.type("7", state, 1000 * ms);
  EXPECT_EQ(state.item(0).typed, "-7");
}

TEST(HeadsetPages, APadTypesWords) {
  study::Question words = question(study::AnswerKind::Text);
  words.language = "de";
  study::PageState state({&words, 1}, 0, 0);
  const study::Pad pad(words);
  state.use(study::AnswerInput::Ray);
  for (const char* key : {"s", "c", "h", "ö", "n", "ß", study::Pad::erase, "."})
    pad.type(key, state, 1000 * ms);
  EXPECT_EQ(state.item(0).typed, "schön.");
  state.click_confirm(1000 * ms);
  EXPECT_EQ(state.answers()[0].input, study::AnswerInput::Ray);
}

TEST(HeadsetPages, WaysToAnswerAreNamed) {
  const study::AnswerWays usual = study::parse_answer_ways(study::usual_answer_ways);
  EXPECT_TRUE(usual.ray && usual.stick && usual.keyboard && !usual.dwell);
  EXPECT_TRUE(study::parse_answer_ways("dwell").dwell);
  const auto refused = [](const std::string& words) {
    try {
      study::parse_answer_ways(words);
    } catch (const base::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("ray,dwell"), HasSubstr("both point"));
  EXPECT_THAT(refused("nod"), HasSubstr("'nod' is not known"));
  EXPECT_THAT(refused(""), HasSubstr("nothing to answer with"));
}

TEST(HeadsetPages, TimeAwayBeforeAPageCameIsNotLeftOut) {
  const study::Question rating;
  study::PageState state({&rating, 1}, 0, 1000 * ms);
  state.leave_out(200 * ms, 1500 * ms);
  EXPECT_TRUE(state.guarded(1700 * ms));
  state.digit(4, 2500 * ms);
  state.click_confirm(2600 * ms);
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 1);
}

}  // namespace
}  // namespace apps
