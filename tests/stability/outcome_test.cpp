/// What the findings of a hard case make its outcome: whether it passes, and by what share of each limit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

#include "libsim/cases/watch.hpp"
#include "stats/base/error.hpp"

namespace {

using namespace sim::cases;

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST(CaseOutcome, MarginsAreSharesOfTheLimit) {
  EXPECT_DOUBLE_EQ(at_most("a", 0.75, 1).margin(), 0.25);
  EXPECT_DOUBLE_EQ(at_most("a", 3, 2).margin(), -0.5);
  EXPECT_DOUBLE_EQ(at_least("a", 3, 2).margin(), 0.5);
  EXPECT_DOUBLE_EQ(at_least("a", 1, 2).margin(), -0.5);
  EXPECT_EQ(at_most("nobody", 0, 0).margin(), infinite);
  EXPECT_EQ(at_most("nobody", 1, 0).margin(), -infinite);
  EXPECT_EQ(reported("a", 1e9).margin(), infinite);
}

TEST(CaseOutcome, WithEffectsOnlyStabilityCounts) {
  const Outcome all{{at_most("speed at rest", 3, 2), at_most("at 30 m/s: particles outside", 0, 0),
                     at_most("braked", 0, 0), at_most("largest rho / rho_0", 1.1, 1.5)},
                    {}};
  EXPECT_FALSE(all.passes());
  EXPECT_TRUE(of_stability(all).passes());
  EXPECT_EQ(of_stability(all).findings.size(), 3u);
  for (std::size_t k = 1; k < 4; ++k) {
    Outcome broken = all;
    broken.findings[k].value = 2;
    EXPECT_FALSE(of_stability(broken).passes()) << broken.findings[k].name;
  }
  Outcome stopped = all;
  stopped.stopped = Stop{3, "not finite"};
  EXPECT_FALSE(of_stability(stopped).passes());
}

TEST(CaseOutcome, WhatIsNoNumberFails) {
  for (const Finding& one : {at_most("a", std::nan(""), 1), at_least("a", std::nan(""), 1)}) {
    EXPECT_FALSE(one.passes());
    EXPECT_LT(one.margin(), 0);
  }
}

TEST(CaseOutcome, TheWorstFindingDecides) {
  Outcome out{{at_most("a", 0.5, 1), at_least("b", 3, 2.9)}, {}};
  EXPECT_TRUE(out.passes());
  EXPECT_NEAR(out.margin(), 0.1 / 2.9, 1e-12);
  out.findings.push_back(at_most("c", 2, 1, "m"));
  EXPECT_FALSE(out.passes());
  EXPECT_DOUBLE_EQ(out.margin(), -1);
  EXPECT_THAT(out.text(), testing::HasSubstr("c 2 m (at most 1, FAILS)"));
}

TEST(CaseOutcome, AStoppedRunFails) {
  const Outcome out{{at_most("a", 0, 1)}, Stop{7, "it is cold"}};
  EXPECT_FALSE(out.passes());
  EXPECT_LE(out.margin(), -1);
  EXPECT_THAT(out.text(), testing::HasSubstr("stopped at frame 7: it is cold"));
}

TEST(CaseOutcome, ARunStopsWhereItsBoundIs) {
  sim::Scene scene = tank({2, 2, 2}, {1, 1, 1});
  const State start = block(sim::MethodKind::HiRes, {0.5, 0.5, 0.5}, {1.1, 1.1, 1.1});
  // The block falls, so it is faster than 1 m/s after 0.1 s.
  Watch watch(scene, options_of({}, scene, start), {.speed_m_s = 1});
  int frames = 0;
  while (watch.step()) ASSERT_LT(++frames, 60);
  EXPECT_NEAR(frames, 6, 1);
  EXPECT_FALSE(watch.outcome({watch.speed_finding()}).passes());
  EXPECT_FALSE(watch.step());
}

TEST(CaseOutcome, AShareOfTheFramesKeepsToADensity) {
  sim::Scene scene = tank({2, 2, 2}, {1, 1, 1});
  const State start = block(sim::MethodKind::HiRes, {0.5, 0.5, 0.5}, {1.1, 1.1, 1.1});
  Watch watch(scene, options_of({}, scene, start), {});
  EXPECT_EQ(watch.densest_in(0.95), 0);
  std::vector<double> of_frames;
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(watch.step());
    of_frames.push_back(watch.report().density_max);
  }
  std::sort(of_frames.begin(), of_frames.end());
  EXPECT_EQ(watch.densest_in(0.95), of_frames[18]);
  EXPECT_EQ(watch.densest_in(0.5), of_frames[9]);
  EXPECT_EQ(watch.densest_in(1), watch.densest());
}

TEST(HardCases, AreFoundByTheirIds) {
  EXPECT_STREQ(hard_case("S9").suite, "S09Jet");
  EXPECT_THROW(hard_case("S0"), base::Error);
}

}  // namespace
