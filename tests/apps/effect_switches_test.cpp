#include "apps/view/effect_switches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/view/pass_means.hpp"
#include "stats/base/error.hpp"

namespace apps {
namespace {

using sim::EffectKind;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Effects = std::vector<sim::Effect>;

const Effects listed{
    {EffectKind::Cohesion, 3}, {EffectKind::Adhesion, 2}, {EffectKind::AirDrag, 0.5}, {EffectKind::Foam, 0}};
const Effects above_0{listed.begin(), listed.begin() + 3};

TEST(EffectSwitches, AreOnWhereTheEffectRuns) {
  auto switches = switches_of(listed, {{EffectKind::AirDrag, 0.75}, {EffectKind::Cohesion, 0}});
  ASSERT_EQ(switches.size(), 4u);
  EXPECT_FALSE(switches[0].on) << "at 0";
  EXPECT_FALSE(switches[1].on);
  EXPECT_TRUE(switches[2].on);
  EXPECT_EQ(switches[2].effect.coefficient, 0.75) << "as it runs";
  EXPECT_EQ(switches[2].most, 2) << "of what the scene lists";
  EXPECT_EQ(switches[1].effect.coefficient, 2) << "as it would run";
  EXPECT_EQ(switches[3].most, 0);
  EXPECT_EQ(turned_on(switches), (Effects{{EffectKind::AirDrag, 0.75}}));
}

TEST(EffectSwitches, WhatNeedsAnotherFallsWithIt) {
  auto switches = switches_of(listed, listed);
  EXPECT_EQ(turned_on(switches), above_0) << "what is at 0 is not on";
  switches[0].on = false;
  EXPECT_EQ(turned_on(switches), (Effects{{EffectKind::AirDrag, 0.5}}));
  switches[0].on = true;
  EXPECT_EQ(turned_on(switches), above_0);
  switches[0].effect.coefficient = 0;
  EXPECT_EQ(turned_on(switches), (Effects{{EffectKind::AirDrag, 0.5}}));
}

TEST(EffectSwitches, WhatCannotRunIsNotShownAsOn) {
  auto switches = switches_of(listed, listed);
  for (auto& one : switches) one.on = true;
  switches[0].on = false;
  drop_what_cannot_run(switches);
  for (const auto& one : switches) EXPECT_EQ(one.on, one.effect.kind == EffectKind::AirDrag);
}

TEST(EffectSwitches, WordsTurnThemOff) {
  EXPECT_EQ(left_on(listed, ""), listed) << "also what is at 0, as the scene says";
  EXPECT_EQ(left_on(listed, "air_drag"), (Effects{{EffectKind::Cohesion, 3}, {EffectKind::Adhesion, 2}}));
  EXPECT_TRUE(left_on(listed, "air_drag,cohesion").empty());
  const auto refused = [](const Effects& effects, const std::string& off, const std::string& why) {
    EXPECT_THAT([&] { left_on(effects, off); }, testing::ThrowsMessage<base::Error>(HasSubstr(why))) << off;
  };
  refused(listed, "heat", "--effects-off heat: is not an effect that the scene lists");
  refused(listed, "heat", "write for example cohesion");
  refused(listed, "cohesion,", "is not an effect");
  refused({}, "cohesion", "leave the option out");
  EXPECT_EQ(in_words(listed), "cohesion, adhesion, air_drag, foam");
  EXPECT_EQ(in_words(Effects{}), "no effects");
}

std::vector<sim::StageTime> frame_of(double a, double b) {
  return {{"saliency", "frame start", sim::no_effect, a},
          {"air drag", "substep end", EffectKind::AirDrag, b}};
}

TEST(PassMeans, AreOfTheLastSecond) {
  PassMeans means;
  EXPECT_TRUE(means.rows().empty());
  EXPECT_EQ(means.total_ms(), 0);
  means.push(frame_of(100, 100), 0.3);
  means.push(frame_of(1, 2), 0.4);
  means.push(frame_of(3, 6), 0.4);  // 1.1 s: the first frame has left the window
  const auto rows = means.rows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].name, "saliency");
  EXPECT_EQ(rows[0].phase, "frame start");
  EXPECT_EQ(rows[0].effect, "");
  EXPECT_EQ(rows[1].effect, "air_drag");
  EXPECT_DOUBLE_EQ(rows[0].ms, 2);
  EXPECT_DOUBLE_EQ(rows[1].ms, 4);
  EXPECT_DOUBLE_EQ(rows[1].share, 2.0 / 3);
  EXPECT_DOUBLE_EQ(means.total_ms(), 6);
}

TEST(PassMeans, ALongFrameStandsAlone) {
  PassMeans means;
  means.push(frame_of(1, 1), 0.1);
  means.push(frame_of(0, 8), 5);
  EXPECT_DOUBLE_EQ(means.total_ms(), 8);
  EXPECT_DOUBLE_EQ(means.rows()[1].share, 1);
  means.push(frame_of(0, 0), 5);
  EXPECT_EQ(means.rows()[1].share, 0) << "no share of nothing";
}

TEST(PassMeans, ANewScheduleForgetsTheOld) {
  PassMeans means;
  means.push(frame_of(1, 1), 0.1);
  auto other = frame_of(5, 0);
  other.pop_back();
  means.push(other, 0.1);
  ASSERT_EQ(means.rows().size(), 1u);
  EXPECT_DOUBLE_EQ(means.rows()[0].ms, 5);
  means.push(frame_of(2, 2), 0.1);
  EXPECT_DOUBLE_EQ(means.total_ms(), 4);
}

}  // namespace
}  // namespace apps
