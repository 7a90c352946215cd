/// The frame thread behind HeadsetDisplay, on the system's clock: slots continue whatever the program does.
#include <epoxy/gl.h>

#include <array>
#include <chrono>
#include <sstream>
#include <thread>

#include "libstudy/headset/headset_display.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A stimulus whose start and steps take real time. Each step has its own colour.
class SlowStimulus final : public study::Stimulus {
 public:
  SlowStimulus(std::chrono::milliseconds start, std::chrono::milliseconds step)
      : start_(start), each_(step) {}
  std::string description() const override { return "slow"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t) override { std::this_thread::sleep_for(start_); }
  study::FrameFacts prepare(std::int64_t step) override {
    std::this_thread::sleep_for(each_);
    step_ = step;
    return {};
  }
  void draw(const study::Canvas& canvas) override {
    const std::array<float, 4> colour{1, static_cast<float>(step_ % 250) / 255, 0, 1};
    glClearNamedFramebufferfv(canvas.framebuffer, GL_COLOR, 0, colour.data());
  }

 private:
  std::chrono::milliseconds start_, each_;
  std::int64_t step_ = 0;
};

class HeadsetRealTimeGl : public test::HeadsetRuns {
 protected:
  ~HeadsetRealTimeGl() override { EXPECT_THAT(calls(), Not(HasSubstr("BREACH"))); }

  /// Opens the display at 20 Hz, so slowly that a busy machine does not miss slots.
  study::HeadsetDisplay& start(const std::string& profile) {
    use_here("size=32x32;clock=real;rates=20;rate=20;" + profile);
    display_.emplace(study::SlotDrive::Thread);
    return *display_;
  }
  int count(const std::string& word) const {
    int found = 0;
    std::istringstream lines(calls());
    for (std::string line; std::getline(lines, line);) found += line.find(word) != std::string::npos;
    return found;
  }

  std::optional<study::HeadsetDisplay> display_;
};

TEST_F(HeadsetRealTimeGl, NoSlotIsMissedWhileAStimulusStartsAndComputes) {
  study::HeadsetDisplay& display = start("hash=1");
  study::HeadsetClock clock(display);
  SlowStimulus stimulus(std::chrono::seconds(2), std::chrono::milliseconds(50));
  const auto played = study::play_trial(std::vector<std::int64_t>(8, 200'000'000), {}, stimulus, display,
                                        clock, {.late_after_ns = 500'000, .overrun_ns = 5'000'000'000}, {});
  display.clear();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // as long as writing an answer may take
  display_.reset();

  // On the thread of the slots, the stimulus' start of 2 s alone would miss 40 slots.
  EXPECT_GT(count("frame "), 60);
  EXPECT_LE(count("starved"), 1);
  int late = 0;
  for (const study::FrameRecord& frame : played.frames) late += frame.late;
  EXPECT_LE(late, 1);
  EXPECT_NEAR(static_cast<double>(played.end_ns - played.frames[0].times.predicted_display_ns), 1.6e9, 1e7);
}

TEST_F(HeadsetRealTimeGl, APictureThatIsLeftBehindFadesAway) {
  std::string all = "0";
  for (int i = 1; i < 300; ++i) all += "," + std::to_string(i);
  study::HeadsetDisplay& display = start("dump=" + all);
  study::HeadsetClock clock(display);
  SlowStimulus stimulus({}, {});
  stimulus.prepare(100);
  display.render(stimulus);
  display.present(display.first_onset(clock.now_ns()), clock);
  const std::int64_t on = display.facts().last.index;
  std::this_thread::sleep_for(std::chrono::milliseconds(2700));
  const std::int64_t faded = display.facts().last.index - 1;
  display_.reset();
  EXPECT_EQ(picture(on + 4, "left").rgba[0], 255);
  EXPECT_EQ(picture(faded, "left").rgba[0], 0);
}

TEST_F(HeadsetRealTimeGl, WhatHappensToTheSessionIsToldToTheProgram) {
  study::HeadsetDisplay& display = start("at=40:instance_lost/5");
  const auto wait = [&] {
    for (int i = 0; i < 400; ++i) display.turn();
  };
  EXPECT_THROW(wait(), base::Error);
  display_.reset();
  EXPECT_THAT(calls(), HasSubstr("xrDestroySession"));
}

TEST_F(HeadsetRealTimeGl, AHeadsetThatIsTakenOffHoldsNobodyUp) {
  study::HeadsetDisplay& display = start("at=100:off/3");
  study::HeadsetClock clock(display);
  SlowStimulus stimulus({}, {});
  stimulus.prepare(1);
  bool spoilt = false;
  for (int i = 0; i < 200 && !spoilt; ++i) {
    display.render(stimulus);
    display.present(clock.now_ns(), clock);
    spoilt = display.take_spoilt().has_value();
  }
  EXPECT_TRUE(spoilt);
  display.turn();  // focus is lost one slot after the first that is not visible
  EXPECT_FALSE(display.focused());
  const std::int64_t off_ns = clock.now_ns();
  clock.wait_until(off_ns + 500'000'000);  // time continues without slots
  EXPECT_GE(clock.now_ns(), off_ns + 500'000'000);
  for (int i = 0; i < 200 && !display.focused(); ++i) display.turn();
  EXPECT_TRUE(display.focused());
}

}  // namespace
}  // namespace apps
