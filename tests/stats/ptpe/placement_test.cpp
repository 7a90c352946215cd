#include "stats/ptpe/placement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "stats/ptpe/placement_study.hpp"

using namespace stats;

namespace {

/// The pilot's 21 settings, or with a smaller step more of them up to a higher mean.
std::vector<PlacementSetting> settings(double step, double highest) {
  std::vector<PlacementSetting> out;
  for (double mu = 10; mu <= highest; mu += step)
    for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0})
      if (delta < mu) out.push_back({mu, delta});
  return out;
}

const std::vector<PlacementSetting> pilot = settings(10, 50), fine = settings(2.5, 70);

}  // namespace

TEST(Placement, BracketsTheContourOfARaterWithoutNoise) {
  Placement placement(fine, placement_prior(fine));
  int smallest = 0, on = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const int index = placement.next();
    const PlacementSetting& one = fine[static_cast<std::size_t>(index)];
    const double contour = 24 * std::exp(0.02 * one.delta);
    if (trial < 3) {
      EXPECT_TRUE(one.delta > 0 && one.delta < 20) << trial;
    }
    if (trial > 12) {
      EXPECT_TRUE(one.delta == 0 || one.delta == 20) << trial;
      const double distance = std::log(one.mu / contour) / std::log(1.5);
      EXPECT_NEAR(distance, std::round(distance), 0.35) << trial;
      EXPECT_LE(std::abs(std::round(distance)), 1) << trial;
      smallest += one.delta == 0;
      on += std::round(distance) == 0;
    }
    placement.add(index, std::clamp(static_cast<int>(std::lround(4 + 0.14 * (one.mu - contour))), 1, 7));
  }
  EXPECT_NEAR(smallest, 0.75 * 17, 1);
  EXPECT_NEAR(on, 17 / 3.0, 1);
  EXPECT_NEAR(placement.a().mean, 24, 2.5);
  EXPECT_NEAR(placement.b().mean, 0.02, 0.005);
}

TEST(Placement, ShowsNoSettingTooOftenAndSaysWhenAllAreShown) {
  const std::vector<PlacementSetting> two{{10, 0}, {20, 0}};
  Placement placement(two, placement_prior(two), {.most_of_one = 2});
  for (int trial = 0; trial < 4; ++trial) placement.add(placement.next(), 4);
  EXPECT_THROW(placement.next(), std::logic_error);
}

TEST(Placement, RefusesWhatItCannotUse) {
  const std::vector<PlacementSetting> same{{10, 0}, {10, 5}}, one{{10, 0}};
  EXPECT_THROW(placement_prior(same), std::invalid_argument);
  EXPECT_THROW(placement_prior(one), std::invalid_argument);
  EXPECT_THROW(Placement(pilot, placement_prior(pilot), {.bracket = 1}), std::invalid_argument);
  Placement placement(pilot, placement_prior(pilot));
  EXPECT_THROW(placement.add(0, 8), std::invalid_argument);
}

TEST(Placement, TwoThirdsOfTheTrialsGiveTheSameWidths) {
  PlacementStudy study;
  study.adaptive = false;
  const PlacementSummary all = simulate_placement(study, pilot, fine, 30, 1);
  study.adaptive = true;
  study.trials = 14;
  const PlacementSummary placed = simulate_placement(study, pilot, fine, 30, 1);
  EXPECT_EQ(placed.fitted, 30);
  EXPECT_LT(placed.b_width, 1.1 * all.b_width);
  EXPECT_LT(placed.a_width, 1.15 * all.a_width);
  EXPECT_GE(placed.a_covered, 0.8);
}

/// Prints the tables of docs/statistics.md, "Adaptive placement".
TEST(PlacementSlow, WidthsBesideFixedSettings) {
  int same_width = 0, truths = 0;
  for (const PlacementTruth truth :
       {PlacementTruth::Model, PlacementTruth::Linear, PlacementTruth::Lapses, PlacementTruth::Drift}) {
    for (const double a : {18.0, 24.0, 31.0}) {
      for (const double b : {0.01, 0.02, 0.03}) {
        PlacementStudy study{.a = a, .b = b, .truth = truth, .adaptive = false};
        const PlacementSummary all = simulate_placement(study, pilot, fine, 200, 1);
        study.adaptive = true;
        for (const int trials : {7, 10, 12, 14, 21}) {
          study.trials = trials;
          const PlacementSummary placed = simulate_placement(study, pilot, fine, 200, 1);
          std::printf(
              "%s a %g b %g trials %d: fitted %.3f, width a %.2f b %.2f, covered %.3f %.3f (fixed %.3f "
              "%.3f), "
              "form rejected %.2f (fixed %.2f)\n",
              placement_truth_word(truth), a, b, trials, placed.fitted / 200.0, placed.a_width / all.a_width,
              placed.b_width / all.b_width, placed.a_covered, placed.b_covered, all.a_covered, all.b_covered,
              placed.form_rejected, all.form_rejected);
          if (truth != PlacementTruth::Model || trials != 14) continue;
          ++truths;
          same_width += placed.a_width <= 1.05 * all.a_width && placed.b_width <= 1.05 * all.b_width;
          EXPECT_GT(placed.b_covered, 0.87);
          EXPECT_GT(placed.a_covered, 0.87);
        }
      }
    }
  }
  EXPECT_GE(same_width, 5) << "of " << truths;
}
