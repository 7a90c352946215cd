/// Parts of the headset's session that need no runtime.
#include <gtest/gtest.h>

#include <cmath>
#include <future>

#include "libstudy/headset/flash_guard.hpp"
#include "libstudy/headset/picture_turns.hpp"
#include "libstudy/headset/rate_meter.hpp"
#include "libstudy/headset/views.hpp"
#include "libstudy/headset/watched_thread.hpp"
#include "libstudy/stimulus/framing.hpp"

namespace apps {
namespace {

constexpr double degree = 3.14159265358979 / 180;

/// Adds `count` slots `step_ns` apart. Returns the changes that were reported.
std::vector<study::RateChange> add_slots(study::RateMeter& meter, std::int64_t& now_ns, int count,
                                         std::int64_t step_ns, std::int64_t jitter_ns = 0) {
  std::vector<study::RateChange> changes;
  for (int i = 0; i < count; ++i) {
    now_ns += step_ns;
    const std::int64_t beside_ns = jitter_ns * (i % 5 - 2) / 2;
    if (const auto change = meter.add(now_ns + beside_ns)) changes.push_back(*change);
  }
  return changes;
}

constexpr std::int64_t at_90_hz = 11'111'111, at_72_hz = 13'888'889;

TEST(HeadsetRate, IsTheSettledStepAndNeverTheFirst) {
  study::RateMeter meter;
  std::int64_t now_ns = 5;
  EXPECT_TRUE(add_slots(meter, now_ns, 8, 3 * at_90_hz).empty());
  EXPECT_FALSE(meter.hz());
  EXPECT_TRUE(add_slots(meter, now_ns, 40, at_90_hz).empty());
  ASSERT_TRUE(meter.hz());
  EXPECT_NEAR(*meter.hz(), 90, 1e-3);
  EXPECT_EQ(meter.dropped(), 0);
}

TEST(HeadsetRate, JitterMovesItLittleAndIsOffTheGrid) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  EXPECT_TRUE(add_slots(meter, now_ns, 500, at_90_hz, 2'000'000).empty());
  EXPECT_NEAR(*meter.hz(), 90, 0.1);  // 2 ms of jitter at both ends of some 490 periods
  EXPECT_GT(meter.off_grid(), 90);    // each fifth step is 4 ms too short
  EXPECT_EQ(meter.dropped(), 0);
}

TEST(HeadsetRate, SlotsThatAreLeftOutOrToldTwiceAreCounted) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  add_slots(meter, now_ns, 30, at_90_hz);
  EXPECT_TRUE(add_slots(meter, now_ns, 1, 4 * at_90_hz).empty());
  add_slots(meter, now_ns, 2, 0);
  add_slots(meter, now_ns, 30, at_90_hz);
  EXPECT_EQ(meter.dropped(), 3);
  EXPECT_EQ(meter.repeated(), 2);
  EXPECT_EQ(meter.off_grid(), 0);
  EXPECT_NEAR(*meter.hz(), 90, 1e-3);
}

TEST(HeadsetRate, AChangeIsToldOnceWhenItHasSettled) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  add_slots(meter, now_ns, 50, at_90_hz);
  const auto changes = add_slots(meter, now_ns, 60, at_72_hz);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_NEAR(changes[0].from_hz, 90, 1e-3);
  EXPECT_NEAR(changes[0].to_hz, 72, 0.5);
  EXPECT_NEAR(*meter.hz(), 72, 0.5);
  EXPECT_EQ(meter.off_grid(), 0);
  EXPECT_EQ(meter.dropped(), 0);
}

TEST(HeadsetRate, SlotsAtHalfRateAreLeftOutAndNeverAnotherRate) {
  for (const bool reported : {false, true}) {
    study::RateMeter meter;
    std::int64_t now_ns = 0;
    if (reported) meter.report(90);
    if (!reported) add_slots(meter, now_ns, 50, at_90_hz);
    EXPECT_TRUE(add_slots(meter, now_ns, 34, 2 * at_90_hz).empty());
    ASSERT_TRUE(meter.hz()) << reported;
    EXPECT_NEAR(*meter.hz(), 90, 1e-3);
    EXPECT_GT(meter.dropped(), 24);
    EXPECT_TRUE(add_slots(meter, now_ns, 50, at_90_hz).empty());
    EXPECT_EQ(meter.off_grid(), 0);
  }
}

TEST(HeadsetRate, OfTheRuntimeHoldsUntilItTellsAnother) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  meter.report(90);
  add_slots(meter, now_ns, 50, at_90_hz);
  EXPECT_TRUE(add_slots(meter, now_ns, 60, at_72_hz).empty());
  EXPECT_NEAR(*meter.hz(), 82, 9) << "steps off the grid count as they are";
  EXPECT_GT(meter.off_grid(), 50);
  EXPECT_FALSE(meter.contradicted());
  add_slots(meter, now_ns, 30, at_72_hz);
  EXPECT_TRUE(meter.contradicted());
  meter.doubt();
  EXPECT_TRUE(add_slots(meter, now_ns, 60, at_72_hz).empty()) << "it was the runtime's once";
  meter.report(72);
  EXPECT_FALSE(meter.hz());
  add_slots(meter, now_ns, 30, at_72_hz);
  EXPECT_NEAR(*meter.hz(), 72, 1e-3);
}

TEST(HeadsetRate, OfTheRuntimeIsNotBelievedWhereNoStepEverFits) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  meter.report(90);
  add_slots(meter, now_ns, 100, at_72_hz);
  EXPECT_FALSE(meter.hz());
  ASSERT_TRUE(meter.contradicted());
  meter.doubt();
  EXPECT_TRUE(add_slots(meter, now_ns, 20, at_72_hz).empty());
  EXPECT_NEAR(*meter.hz(), 72, 1e-3);
}

TEST(HeadsetFlash, LightFollowsBlackThreeTimesInASecondAtMost) {
  study::FlashGuard guard;
  std::vector<std::int64_t> onsets_ns;
  bool lit = false;
  for (std::int64_t now_ns = 1; now_ns < 5'000'000'000; now_ns += at_90_hz) {
    const bool wanted = now_ns / at_90_hz % 4 < 2;
    const bool shown = guard.admit(now_ns, wanted) && wanted;
    if (shown && !lit) onsets_ns.push_back(now_ns);
    lit = shown;
  }
  EXPECT_EQ(onsets_ns.size(), 15u);
  for (std::size_t i = 3; i < onsets_ns.size(); ++i)
    EXPECT_GE(onsets_ns[i] - onsets_ns[i - 3], 1'000'000'000);
}

TEST(HeadsetFlash, WhatStaysOnOrComesAndGoesSlowlyIsNeverHeldBack) {
  study::FlashGuard guard;
  for (std::int64_t slot = 0; slot < 900; ++slot)
    EXPECT_TRUE(guard.admit(slot * at_90_hz, slot % 40 < 30 || slot > 400)) << slot;
}

TEST(HeadsetRate, IsTheDisplaysWhereMostSlotsAreLeftOut) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  for (int i = 0; i < 20; ++i) {
    add_slots(meter, now_ns, 2, 2 * at_90_hz);
    add_slots(meter, now_ns, 1, at_90_hz);
  }
  ASSERT_TRUE(meter.hz());
  EXPECT_NEAR(*meter.hz(), 90, 1e-3);
  EXPECT_GT(meter.dropped(), 30);
  EXPECT_EQ(meter.off_grid(), 0);
}

TEST(HeadsetRate, APauseIsNoDroppedSlot) {
  study::RateMeter meter;
  std::int64_t now_ns = 0;
  add_slots(meter, now_ns, 50, at_90_hz);
  meter.interrupt();
  now_ns += 100 * at_90_hz;
  EXPECT_TRUE(add_slots(meter, now_ns, 50, at_90_hz).empty());
  EXPECT_EQ(meter.dropped(), 0);
}

TEST(HeadsetViews, LookAlongTheirPose) {
  study::HeadsetPose pose;
  EXPECT_EQ(study::direction_of(pose), (std::array<float, 3>{0, 0, -1}));
  const auto half = static_cast<float>(std::sqrt(0.5));
  pose.turn = {0, half, 0, half};  // a quarter turn to the left
  const auto left = study::direction_of(pose);
  EXPECT_NEAR(left[0], -1, 1e-6);
  EXPECT_NEAR(left[2], 0, 1e-6);
}

/// The renderers' view in a scene whose camera is at the room's origin and looks along -z.
sim::View seen_by(const study::HeadsetEye& eye) {
  sim::Camera camera;
  camera.eye_m = {0, 0, 0};
  camera.target_m = {0, 0, -1};
  return study::eye_view(camera, study::study_view(eye, 0));
}

TEST(HeadsetViews, AFieldOfViewFillsItsPicture) {
  study::HeadsetEye eye;
  eye.pose.place_m = {0.5f, 1, 2};
  eye.fov = {-0.9f, 0.7f, 0.8f, -0.85f};
  eye.width_px = 200;
  eye.height_px = 100;
  const sim::PixelRays rays = sim::pixel_rays(seen_by(eye));
  EXPECT_NEAR(rays.offset_x, std::tan(-0.9), 1e-5);
  EXPECT_NEAR(200 * rays.scale_x + rays.offset_x, std::tan(0.7), 1e-5);
  EXPECT_NEAR(rays.offset_y, std::tan(-0.85), 1e-5);
  EXPECT_NEAR(100 * rays.scale_y + rays.offset_y, std::tan(0.8), 1e-5);
}

TEST(HeadsetViews, TheWorldIsSeenFromWhereTheEyeIs) {
  study::HeadsetEye eye;
  eye.pose.place_m = {0.5f, 1, 2};
  const auto half = static_cast<float>(std::sin(15 * degree));
  eye.pose.turn = {0, 0, half, static_cast<float>(std::cos(15 * degree))};  // leans 30 degrees to the left
  eye.fov = {-0.8f, 0.8f, 0.8f, -0.8f};
  eye.width_px = eye.height_px = 100;
  const sim::Mat4 view = seen_by(eye).view;
  // A point 1 m to the right of the eye and 3 m ahead, along the room's axes.
  const std::array<double, 3> point{1.5, 1, -1};
  std::array<double, 3> seen{};
  for (std::size_t row = 0; row < 3; ++row) {
    seen[row] = static_cast<double>(view[12 + row]);
    for (std::size_t column = 0; column < 3; ++column)
      seen[row] += static_cast<double>(view[4 * column + row]) * point[column];
  }
  EXPECT_NEAR(seen[0], std::cos(30 * degree), 1e-5);
  EXPECT_NEAR(seen[1], -std::sin(30 * degree), 1e-5);
  EXPECT_NEAR(seen[2], -3, 1e-5);
}

TEST(HeadsetTurns, APictureThatIsDroppedWhileItIsDrawnNeverComesOn) {
  study::PictureTurns turns;
  turns.begin();
  turns.drop();
  turns.post();
  EXPECT_FALSE(turns.waits());
  turns.begin();
  turns.post();
  turns.take();
  EXPECT_TRUE(turns.shows());
  turns.drop();
  EXPECT_FALSE(turns.shows());
}

TEST(HeadsetWatch, ACallThatComesBackIsDone) {
  study::WatchedThread watched;
  int calls = 0;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(watched.run([&] { ++calls; }, std::chrono::hours(1)));
  EXPECT_EQ(calls, 3);
}

TEST(HeadsetWatch, ACallThatHangsIsLeftToItself) {
  std::promise<void> freed;
  const auto wait = freed.get_future().share();
  // `let_go` is ready once the thread has destroyed the function that it ran, and so `held`, whether or not
  // the function has begun.
  auto held = std::make_shared<std::promise<void>>();
  const auto let_go = held->get_future();
  {
    study::WatchedThread watched;
    EXPECT_FALSE(watched.run([wait, held = std::move(held)] { wait.wait(); }, std::chrono::milliseconds(1)));
    EXPECT_TRUE(watched.hangs());
    EXPECT_FALSE(watched.run([] {}, std::chrono::hours(1)));
  }
  freed.set_value();
  let_go.wait();
}

}  // namespace
}  // namespace apps
