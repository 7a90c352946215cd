/// What a case's findings come to: passes and margins.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  // It falls: faster than 1 m/s after 0.1 s.
  Watch watch(scene, options_of({}, scene, start), {.speed_m_s = 1});
  int frames = 0;
  while (watch.step()) ASSERT_LT(++frames, 60);
  EXPECT_NEAR(frames, 6, 1);
  EXPECT_FALSE(watch.outcome({watch.speed_finding()}).passes());
  EXPECT_FALSE(watch.step());
}

TEST(HardCases, AreFoundByTheirIds) {
  EXPECT_STREQ(hard_case("S9").suite, "S09Jet");
  EXPECT_THROW(hard_case("S0"), base::Error);
}

}  // namespace
