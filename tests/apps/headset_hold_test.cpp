/// A held picture during movements of the head, and the space in which it is drawn.
#include <epoxy/gl.h>

#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include "libstudy/headset/headset_display.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Records the eye views for which it was drawn.
class SeenStimulus final : public study::Stimulus {
 public:
  std::string description() const override { return "seen"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t) override {}
  study::FrameFacts prepare(std::int64_t step) override {
    step_ = step;
    return {};
  }
  void draw(const study::Canvas& canvas) override {
    drawn.push_back({step_, canvas.eyes[0], canvas.eyes[1]});
  }

  struct Drawn {
    std::int64_t step;
    study::EyeView left, right;
  };
  std::vector<Drawn> drawn;

 private:
  std::int64_t step_ = 0;
};

class HeadsetHoldGl : public test::HeadsetRuns {
 protected:
  ~HeadsetHoldGl() override { EXPECT_THAT(calls(), Not(HasSubstr("BREACH"))); }

  /// Plays two pictures for nine slots each, with a head that moves as `head` says.
  void play(const study::HeadsetRules& rules, const std::string& head = "head=walk") {
    use_here("size=32x32;" + head);
    study::HeadsetDisplay display(study::SlotDrive::Caller, {}, rules);
    study::HeadsetClock clock(display);
    const auto played = study::play_trial({100'000'000, 100'000'000}, {}, stimulus_, display, clock,
                                          {.late_after_ns = 500'000, .overrun_ns = 1'000'000'000}, {});
    for (const auto& frame : played.frames) EXPECT_FALSE(frame.late);
    display.clear();
  }
  /// The text that matches `what` in the left eye's part of each frame's log line, slot by slot.
  std::vector<std::string> logged(const std::string& what) const {
    std::vector<std::string> found;
    std::istringstream lines(calls());
    const std::regex pattern("projection space.* left .*?(" + what + ")");
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (!std::regex_search(line, match, pattern)) continue;
      found.push_back(std::regex_replace(match[1].str(), std::regex("-0\\.000000"), "0.000000"));
    }
    return found;
  }
  static std::size_t different(const std::vector<std::string>& words) {
    return std::set<std::string>(words.begin(), words.end()).size();
  }

  SeenStimulus stimulus_;
  const std::string pose = "at [-.0-9]+ [-.0-9]+ [-.0-9]+ turned [-.0-9]+ [-.0-9]+ [-.0-9]+ [-.0-9]+";
};

TEST_F(HeadsetHoldGl, AnImageStaysWhereItWasDrawn) {
  play({});
  EXPECT_EQ(stimulus_.drawn.size(), 2u);
  ASSERT_EQ(logged(pose).size(), 18u);
  EXPECT_EQ(different(logged(pose)), 2u);
}

TEST_F(HeadsetHoldGl, EachEyeIsDrawnFromItsOwnPlaceIntoItsOwnHalf) {
  play({}, "head=still");
  const auto& [step, left, right] = stimulus_.drawn.front();
  EXPECT_NEAR(left.position_m[0], -0.0315, 1e-6);
  EXPECT_NEAR(right.position_m[0], 0.0315, 1e-6);
  EXPECT_EQ(left.x_px, 0);
  EXPECT_EQ(right.x_px, 32);
  // The headset's eyes have a wider view outwards.
  EXPECT_NEAR(left.left_rad, -52 * M_PI / 180, 1e-6);
  EXPECT_NEAR(right.right_rad, 52 * M_PI / 180, 1e-6);
}

TEST_F(HeadsetHoldGl, AStateIsDrawnAnewFromWhereTheHeadIs) {
  play({.hold = study::Hold::State, .refresh_hz = {}});
  ASSERT_EQ(logged(pose).size(), 18u);
  EXPECT_EQ(different(logged(pose)), 18u);
  ASSERT_EQ(stimulus_.drawn.size(), 18u);
  std::map<std::int64_t, int> slots;
  for (const auto& drawn : stimulus_.drawn) ++slots[drawn.step];
  EXPECT_EQ(slots, (std::map<std::int64_t, int>{{0, 9}, {1, 9}}));
}

TEST_F(HeadsetHoldGl, AHeadLockedPictureMovesWithTheHead) {
  play({});
  const std::size_t drawn = stimulus_.drawn.size(), slots = logged(pose).size();
  play({.hold = study::Hold::HeadLocked, .refresh_hz = {}});
  EXPECT_EQ(stimulus_.drawn.size(), 2 * drawn);
  // The layer's pose is relative to the head and constant: the left eye is half the distance between the eyes
  // to the left.
  const auto all = logged(pose);
  const std::vector<std::string> locked(all.begin() + static_cast<std::ptrdiff_t>(slots), all.end());
  ASSERT_EQ(locked.size(), slots);
  EXPECT_EQ(different(locked), 1u);
  EXPECT_THAT(locked.front(), HasSubstr("at -0.031500 0.000000 0.000000 turned 0.000000"));
  // The picture itself is drawn for the head's place in the world.
  EXPECT_NE(stimulus_.drawn.back().left.position_m, stimulus_.drawn[drawn].left.position_m);
}

TEST_F(HeadsetHoldGl, AMarginSurroundsWhatTheEyesSee) {
  play({});
  const auto before = stimulus_.drawn.front().left;
  play({.hold_margin_deg = 10, .refresh_hz = {}});
  const auto after = stimulus_.drawn.back().left;
  const double margin = 10 * M_PI / 180;
  EXPECT_NEAR(after.left_rad, before.left_rad - margin, 1e-6);
  EXPECT_NEAR(after.right_rad, before.right_rad + margin, 1e-6);
  EXPECT_NEAR(after.up_rad, before.up_rad + margin, 1e-6);
  EXPECT_NEAR(after.down_rad, before.down_rad - margin, 1e-6);
  // The layer has the margin too, so that the visible part stays in place.
  EXPECT_THAT(logged("fov [-.0-9]+").back(), HasSubstr("fov -1.08210"));
}

TEST_F(HeadsetHoldGl, AMetreOfTheSceneTakesTheProtocolsMetresOfTheRoom) {
  play({.world_scale = 2, .refresh_hz = {}});
  const auto& [step, left, right] = stimulus_.drawn.front();
  double apart = 0;
  for (std::size_t k = 0; k < 3; ++k) apart += std::pow(left.position_m[k] - right.position_m[k], 2);
  EXPECT_NEAR(std::sqrt(apart), 0.063 / 2, 1e-6);
}

TEST_F(HeadsetHoldGl, TheProtocolsRefreshRateIsAskedForAndMet) {
  use_here("size=32x32");
  const study::HeadsetDisplay display(study::SlotDrive::Caller, {}, {.refresh_hz = 120});
  EXPECT_EQ(display.refresh_hz(), 120);
  EXPECT_NEAR(display.measured_hz(), 120, 1e-3);
  // The change of the rate does not affect the grade.
  EXPECT_EQ(display.grade(), study::TimingGrade::Compositor);
}

TEST_F(HeadsetHoldGl, TheGradeRecoversAfterAChangeOfTheRateAndInANewSession) {
  for (const auto& [trouble, hz] :
       {std::pair{"at=60:rate/72", 72.0}, std::pair{"at=60:repeat,90:lost_now", 90.0}}) {
    use_here(std::string("size=32x32;") + trouble);
    study::HeadsetDisplay display(study::SlotDrive::Caller, {});
    study::HeadsetClock clock(display);
    clock.wait_until(clock.now_ns() + 3'000'000'000);
    EXPECT_NEAR(display.measured_hz(), hz, 0.5) << trouble;
    EXPECT_EQ(display.grade(), study::TimingGrade::Compositor) << trouble;
  }
}

TEST_F(HeadsetHoldGl, ARefreshRateThatDoesNotComeStopsTheProgram) {
  use_here("size=32x32;ignores_rate=1");
  EXPECT_THAT(
      [] { study::HeadsetDisplay(study::SlotDrive::Caller, {}, {.refresh_hz = 120}); },
      ::testing::ThrowsMessage<base::Error>(HasSubstr("does not change to the protocol's refresh_hz")));
  EXPECT_THAT([] { study::HeadsetDisplay(study::SlotDrive::Caller, {}, {.refresh_hz = 100}); },
              ::testing::ThrowsMessage<base::Error>(HasSubstr("100 Hz is not one of its refresh rates")));
}

}  // namespace
}  // namespace apps
