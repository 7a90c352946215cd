#include "stats/adaptive/quest_plus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "stats/adaptive/psychometric.hpp"

using namespace stats;

namespace {

/// One of the worked examples of Watson 2017, "QUEST+: A general multidimensional Bayesian adaptive
/// psychometric method", Journal of Vision 17(3):10. The trajectories are those that the open implementation
/// questplus (Höchenberger 2019) checks against the paper's Mathematica demonstration.
struct Example {
  std::vector<double> stimuli;
  std::vector<PsychometricCurve> points;  ///< grid of parameters
  std::vector<int> chosen;                ///< stimulus of each trial
  std::string_view responses;             ///< C: correct, i: incorrect
};

std::vector<double> whole(int first, int last) {
  std::vector<double> out;
  for (int i = first; i <= last; ++i) out.push_back(i);
  return out;
}

PsychometricCurve weibull(double threshold, double slope, double lapse) {
  return {.form = PsychometricForm::WeibullLog,
          .threshold = threshold,
          .shape = slope,
          .guess = 0.5,
          .lapse = lapse};
}

/// Replays the example; every choice must be the paper's. Returns the curve of the posterior's mode.
PsychometricCurve replay(const Example& example) {
  const auto chance = [&](int s, int p, int o) {
    const double correct =
        example.points[static_cast<std::size_t>(p)](example.stimuli[static_cast<std::size_t>(s)]);
    return o == 0 ? correct : 1 - correct;
  };
  const std::vector<double> prior(example.points.size(), 1.0);
  QuestPlus quest(static_cast<int>(example.stimuli.size()), 2, prior, chance);
  EXPECT_EQ(example.chosen.size(), example.responses.size());
  for (std::size_t i = 0; i < example.chosen.size(); ++i) {
    const int next = quest.next();
    EXPECT_EQ(example.stimuli[static_cast<std::size_t>(next)], example.chosen[i]) << "trial " << i;
    quest.update(next, example.responses[i] == 'C' ? 0 : 1);
  }
  return example.points[static_cast<std::size_t>(quest.mode())];
}

}  // namespace

TEST(QuestPlus, FollowsWatsonsFirstExample) {
  Example example{.stimuli = whole(-40, 0),
                  .points = {},
                  .chosen = {-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19,
                             -20, -20, -18, -18, -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19},
                  .responses = "CCCCiiCCCCCCCCiCCiCCiCCCCCCCCCCC"};
  for (const double t : whole(-40, 0)) example.points.push_back(weibull(t, 3.5, 0.02));
  EXPECT_EQ(replay(example).threshold, -20);
}

TEST(QuestPlus, FollowsWatsonsThresholdSlopeAndLapse) {
  Example example{.stimuli = whole(-40, 0),
                  .points = {},
                  .chosen = {-18, -22, -25, -28, -30, -21, -12, -14, -15, -16, -18, -19, -20, -22, -23, -18,
                             -19, -16, -17, -17, -18, -18, -18, -19, -19, -17, -17, -18, -18, -18, -18, -19,
                             -19, -20, -18, -18, -18, -18, -18, -19, -19, -19, -19, -20, -18, -18, -18, -18,
                             -18, -18, -18, -18, -18, -19, -19, -19, -20, -18, -18, -18, -18, -19, -19, -19,
                             -18, -18, -18, -18, -19, -19, -19, -19, -19, -19, -19, -19, -20, -21, -19, -19,
                             -19, -19, -19, -19, -19, -18, -19, -19, -16, -16, -16, -16, -16, -16, 0,   0,
                             -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -21, -21,
                             -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19},
                  .responses =
                      "CCCCiiCCCCCCCCiCiCCCCCCCiCCCCCCCCiCCCCCCCCCiCCCiCCCCCCCCiCCCCCCiCCCCCCCCCCCCCiCiCCCCiC"
                      "CiCCCCCCCiCCCCCCCCCCCCCCCiCCCiCiiCCCCiCCCC"};
  for (const double t : whole(-40, 0))
    for (const double slope : whole(2, 5))
      for (const double lapse : {0.0, 0.01, 0.02, 0.03, 0.04})
        example.points.push_back(weibull(t, slope, lapse));
  const PsychometricCurve mode = replay(example);
  EXPECT_EQ(mode.threshold, -20);
  EXPECT_EQ(mode.shape, 5);
  EXPECT_EQ(mode.lapse, 0.04);
}

TEST(QuestPlus, FollowsWatsonsMeanAndDeviation) {
  Example example{
      .stimuli = whole(-10, 10),
      .points = {},
      .chosen = {0,  -1, 2,  -2, 2,  3,  3,  -5, 3,  3,  3,  3,  -7, -7, -7, -7, 4,  -7, 4,  4,  4,  -8,
                 -8, -8, 4,  -8, 4,  -8, -7, 4,  -7, -7, 4,  -7, 4,  -7, -6, 3,  -4, -5, 3,  3,  -7, 2,
                 2,  1,  0,  -7, -6, -6, -6, 2,  -5, 2,  -6, -5, 3,  -5, -5, 3,  4,  -5, -5, 4,  -4, -4,
                 -4, -4, 4,  3,  3,  4,  5,  5,  -5, 5,  -5, -5, 4,  5,  5,  -5, -4, -4, -4, -4, 5,  -4,
                 -4, -3, 4,  4,  5,  5,  -4, 5,  -4, -4, 5,  4,  5,  5,  -5, 5,  -4, -4, -4, -4, 5,  -4,
                 5,  4,  -4, 4,  -4, -4, -4, 4,  -4, -4, -4, 4,  4,  -4, 4,  4,  4,  -4},
      .responses =
          "CiiCCCCCCCiCiiiiCCiCCiiiCiCiiCiiCiCiiCiCCCiCCCiiiiiCiiiiCiiiCiiCiiiCCCiiCCiCiiiCCiiiiiCiiCCiCCiCiC"
          "CiCCiCiiiiCCCCiCiiiCiiiiCCCCCi"};
  for (const double mean : whole(-5, 5))
    for (const double sd : whole(1, 10))
      for (const double lapse : {0.0, 0.01, 0.02, 0.03, 0.04})
        example.points.push_back({.threshold = mean, .shape = sd, .guess = lapse, .lapse = lapse});
  const PsychometricCurve mode = replay(example);
  EXPECT_EQ(mode.threshold, 0);
  EXPECT_EQ(mode.shape, 4);
  EXPECT_EQ(mode.lapse, 0.01);
}

TEST(QuestPlus, ParametersOutsideTheInterestDoNotSteerTheChoice) {
  // The answer to stimulus 0 depends on parameter A = p / 2, that to stimulus 1 more strongly on B = p % 2.
  // If only A is of interest, 0 is chosen.
  const std::vector<double> prior(4, 1.0);
  const auto chance = [](int s, int p, int o) {
    const bool high = s == 0 ? p / 2 == 1 : p % 2 == 1;
    const double yes = s == 0 ? (high ? 0.8 : 0.2) : (high ? 0.99 : 0.01);
    return o == 0 ? yes : 1 - yes;
  };
  EXPECT_EQ(QuestPlus(2, 2, prior, chance).next(), 1);
  EXPECT_EQ(QuestPlus(2, 2, prior, chance, std::vector{0, 0, 1, 1}).next(), 0);
  EXPECT_EQ(QuestPlus(2, 2, prior, chance).next(std::vector{0}), 0);
}

TEST(QuestPlus, IntervalsCoverTheThresholdOfSimulatedPeople) {
  const std::vector<double> stimuli = whole(0, 40);
  std::vector<PsychometricCurve> points;
  std::vector<double> thresholds;
  for (const double t : whole(0, 40))
    for (const double sd : {2.0, 4.0, 6.0})
      for (const double lapse : {0.0, 0.03}) {
        points.push_back({.threshold = t, .shape = sd, .lapse = lapse});
        thresholds.push_back(t);
      }
  const auto chance = [&](int s, int p, int o) {
    const double yes = points[static_cast<std::size_t>(p)](stimuli[static_cast<std::size_t>(s)]);
    return o == 0 ? yes : 1 - yes;
  };
  const std::vector<double> prior(points.size(), 1.0);
  const QuestPlus fresh(static_cast<int>(stimuli.size()), 2, prior, chance);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit;
  int covered = 0;
  constexpr int people = 100;
  for (int person = 0; person < people; ++person) {
    const PsychometricCurve truth{
        .threshold = 10 + 20 * unit(random), .shape = 2 + 4 * unit(random), .lapse = 0.03 * unit(random)};
    QuestPlus quest = fresh;
    for (int trial = 0; trial < 30; ++trial) {
      const int s = quest.next();
      quest.update(s, unit(random) < truth(stimuli[static_cast<std::size_t>(s)]) ? 0 : 1);
    }
    const GridEstimate estimate = grid_estimate(thresholds, quest.posterior());
    covered += estimate.low <= truth.threshold && truth.threshold <= estimate.high;
  }
  // Of 100 intervals 95 cover on average, with a standard deviation of 2.2. 88 is three of these below.
  EXPECT_GE(covered, 88);
  EXPECT_LE(covered, 100);
}

TEST(QuestPlus, RefusesWhatIsNoDistribution) {
  const auto half = [](int, int, int) { return 0.5; };
  const std::vector<double> none{0, 0}, negative{1, -1}, two{1, 1};
  EXPECT_THROW(QuestPlus(1, 2, none, half), std::invalid_argument);
  EXPECT_THROW(QuestPlus(1, 2, negative, half), std::invalid_argument);
  EXPECT_THROW(QuestPlus(0, 2, two, half), std::invalid_argument);
  EXPECT_THROW(QuestPlus(1, 2, two, [](int, int, int) { return 1.5; }), std::invalid_argument);
  EXPECT_THROW(QuestPlus(1, 2, two, half, std::vector{0}), std::invalid_argument);
  QuestPlus quest(1, 2, two, half);
  EXPECT_THROW(quest.update(1, 0), std::invalid_argument);
}

TEST(QuestPlus, AnImpossibleOutcomeLeavesThePosteriorUnchanged) {
  const std::vector<double> prior{1, 3};
  QuestPlus quest(1, 2, prior, [](int, int, int o) { return o == 0 ? 1.0 : 0.0; });
  quest.update(0, 1);
  EXPECT_DOUBLE_EQ(quest.posterior()[1], 0.75);
  EXPECT_NEAR(quest.entropy(), -0.75 * std::log(0.75) - 0.25 * std::log(0.25), 1e-15);
}

TEST(GridEstimate, SpreadsTheProbabilityOfAValueOverItsCell) {
  // Even weights on 0 .. 9 are spread over cells from -0.5 to 9.5.
  const std::vector<double> values = whole(0, 9), even(10, 1.0);
  const GridEstimate estimate = grid_estimate(values, even, 0.8);
  EXPECT_NEAR(estimate.mean, 4.5, 1e-12);
  EXPECT_NEAR(estimate.low, 0.5, 1e-9);
  EXPECT_NEAR(estimate.high, 8.5, 1e-9);
  EXPECT_THROW(grid_estimate({}, {}), std::invalid_argument);
}

TEST(Psychometric, InvertsEachForm) {
  for (const char* word : {"normal", "logistic", "weibull", "weibull_db"}) {
    const auto form = psychometric_form(word);
    ASSERT_TRUE(form);
    EXPECT_STREQ(psychometric_word(*form), word);
    const PsychometricCurve curve{.form = *form, .threshold = 12, .shape = 2.5, .guess = 0.1, .lapse = 0.05};
    for (const double p : {0.2, 0.5, 0.9}) EXPECT_NEAR(curve(*curve.stimulus_at(p)), p, 1e-12) << word;
    EXPECT_FALSE(curve.stimulus_at(0.1));
    EXPECT_FALSE(curve.stimulus_at(0.96));
  }
  EXPECT_FALSE(psychometric_form("probit"));
  const PsychometricCurve weibull{.form = PsychometricForm::Weibull, .threshold = 12, .shape = 2.5};
  EXPECT_NEAR(weibull(12), 1 - std::exp(-1), 1e-12);
  EXPECT_EQ(weibull(-1), 0);
}
