#include "apps/view/choices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using apps::Change;
using apps::FrameStrip;
using ::testing::ElementsAre;

TEST(Choices, OnlyNumbersChangeARunningFluid) {
  const apps::ViewOptions before;
  EXPECT_EQ(apps::change_between(before, before), Change::Nothing);
  auto after = before;
  after.alpha = 0.5;
  EXPECT_EQ(apps::change_between(before, after), Change::Numbers);
  after = before;
  after.iterations = 3;
  EXPECT_EQ(apps::change_between(before, after), Change::Numbers);
  after = before;
  after.effects.emplace();
  EXPECT_EQ(apps::change_between(before, after), Change::Numbers) << "none instead of the scene's";
  for (const auto& [member, value] : {std::pair{&apps::ViewOptions::scene, "b.toml"},
                                      {&apps::ViewOptions::method, "Ours"},
                                      {&apps::ViewOptions::preset, "paper"},
                                      {&apps::ViewOptions::n_star, "4k"}}) {
    after = before;
    after.*member = value;
    EXPECT_EQ(apps::change_between(before, after), Change::Fluid) << value;
    after.alpha = 0.5;
    EXPECT_EQ(apps::change_between(before, after), Change::Fluid) << "numbers come with the fluid";
  }
  after = before;
  after.levels = 2;
  EXPECT_EQ(apps::change_between(before, after), Change::Fluid);
}

TEST(Choices, ScenesAreThePapersAndTheOneOpened) {
  const auto paper = apps::scenes_to_offer("data/scenes/faucet.toml");
  EXPECT_THAT(paper, ElementsAre("data/scenes/faucet.toml", "data/scenes/single_dam.toml",
                                 "data/scenes/jet_impact.toml"));
  const std::string absolute = base::resource("data/scenes/faucet.toml").string();
  EXPECT_EQ(apps::scenes_to_offer(absolute).size(), 3u) << "the same file by another name";
  EXPECT_EQ(apps::scenes_to_offer("data/scenes/peers_dam.toml").size(), 4u);
  EXPECT_EQ(apps::scene_title("data/scenes/faucet.toml"), "faucet");
}

TEST(Choices, SizesHoldTheOneInUseInItsPlace) {
  EXPECT_THAT(apps::sizes_to_offer("16k"), ElementsAre("1k", "2k", "4k", "8k", "16k", "32k", "64k", "128k"));
  EXPECT_THAT(apps::sizes_to_offer("4096"),
              ElementsAre("1k", "2k", "4096", "8k", "16k", "32k", "64k", "128k"));
  EXPECT_THAT(apps::sizes_to_offer("3000"),
              ElementsAre("1k", "2k", "3000", "4k", "8k", "16k", "32k", "64k", "128k"));
  EXPECT_THROW(apps::sizes_to_offer("none"), base::Error);
}

TEST(FrameStrip, ScaleFollowsTheData) {
  FrameStrip strip;
  EXPECT_EQ(strip.scale_ms(), 1);
  for (const auto& [ms, top] : {std::pair{0.3, 1.0},
                                {1.4, 2.0},
                                {4.0, 5.0},
                                {5.0, 5.0},
                                {16.7, 20.0},
                                {33.4, 50.0},
                                {51.0, 100.0},
                                {180.0, 200.0},
                                {2300.0, 5000.0}}) {
    strip.push(ms);
    EXPECT_DOUBLE_EQ(strip.scale_ms(), top) << ms;
  }
  for (int i = 0; i < FrameStrip::length; ++i) strip.push(3);
  EXPECT_EQ(strip.scale_ms(), 5) << "what has left the strip no longer counts";
  strip.clear();
  EXPECT_EQ(strip.scale_ms(), 1);
}

TEST(FrameStrip, LeavesOutWhatIsNoTimeAndKeepsTheOrder) {
  FrameStrip strip;
  for (const double ms : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -1.0}) strip.push(ms);
  EXPECT_EQ(strip.oldest(), 0);
  for (int i = 1; i <= FrameStrip::length + 2; ++i) strip.push(i);
  EXPECT_EQ(strip.oldest(), 2);
  EXPECT_EQ(strip.ms()[2], 3) << "the oldest that is kept";
  EXPECT_EQ(strip.ms()[1], FrameStrip::length + 2) << "the newest";
}

TEST(Choices, ScreenshotsAreNamedForWhatTheyShow) {
  apps::ViewOptions options;
  options.scene = "data/scenes/faucet.toml";
  options.method = "Ours-TSp";
  EXPECT_EQ(apps::screenshot_name(options, 120), "vip-view_faucet_Ours-TSp_0120.png");
}

}  // namespace
