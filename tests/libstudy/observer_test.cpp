#include "libstudy/observer/ptpe_observer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "stats/base/error.hpp"

namespace study {
namespace {

Question seven_points() {
  Question question;
  question.id = "satisfaction";
  return question;
}

ShownTrial shown(double mean, double sd, int person, int position) {
  ShownTrial trial;
  trial.participant = "P" + std::to_string(person);
  trial.seed = 7;
  trial.position = position;
  trial.realised = {300, mean, mean, sd};
  return trial;
}

int score(PtpeObserver& observer, const ShownTrial& trial) {
  VirtualClock clock;
  return observer.answer(seven_points(), trial, clock).score;
}

double mean_score(const std::string& specification, double mean, double sd, int people) {
  PtpeObserver observer(parse_ptpe_observer(specification));
  double sum = 0;
  for (int person = 0; person < people; ++person) sum += score(observer, shown(mean, sd, person, 3));
  return sum / people;
}

TEST(PtpeObserver, ScoresFourOnTheContourOnAverage) {
  // SE of the mean is about sqrt(1 + 0.25 + 1/12) / sqrt(20000) = 0.008.
  for (const double sd : {0.0, 5.0, 10.0}) {
    EXPECT_NEAR(mean_score("ptpe:a=31,b=0.035", 31 * std::exp(0.035 * sd), sd, 20000), 4, 0.04) << sd;
  }
}

TEST(PtpeObserver, ExpectationFollowsTheClosedForm) {
  // P(score > k) = Phi((4 + slope tau - k - 1/2) / s), s^2 = noise^2 + participant_sd^2.
  const double tau = 20 - 31, s = std::sqrt(1.25);
  double expected = 1;
  for (int k = 1; k < 7; ++k) expected += 0.5 * std::erfc(-(4 + 0.14 * tau - k - 0.5) / s / std::sqrt(2));
  EXPECT_NEAR(mean_score("ptpe:a=31,b=0.035", 20, 0, 20000), expected, 0.04);
}

TEST(PtpeObserver, WithoutNoiseIsTheNearestCategory) {
  PtpeObserver observer(parse_ptpe_observer("ptpe:a=30,b=0,slope=0.1,noise=0,participant_sd=0"));
  EXPECT_EQ(score(observer, shown(30, 10, 1, 0)), 4);
  EXPECT_EQ(score(observer, shown(34.9, 10, 1, 0)), 4);
  EXPECT_EQ(score(observer, shown(35.1, 10, 1, 0)), 5);
  EXPECT_EQ(score(observer, shown(24.9, 10, 1, 0)), 3);
  EXPECT_EQ(score(observer, shown(1, 0, 1, 0)), 1);
  EXPECT_EQ(score(observer, shown(500, 0, 1, 0)), 7);
}

TEST(PtpeObserver, JudgesTheFramesShownNotTheNominalSetting) {
  PtpeObserver observer(parse_ptpe_observer("ptpe:a=30,b=0.02,noise=0,participant_sd=0"));
  ShownTrial trial = shown(50, 0, 1, 0);
  trial.nominal = {10, 0, 10};
  EXPECT_GT(score(observer, trial), 5);
}

TEST(PtpeObserver, IsAFunctionOfSeedPersonAndPosition) {
  PtpeObserver observer(parse_ptpe_observer("ptpe:a=31,b=0.035")),
      again(parse_ptpe_observer("ptpe:a=31,b=0.035"));
  int differ_by_person = 0, differ_by_position = 0, differ_by_seed = 0;
  for (int i = 0; i < 200; ++i) {
    const int here = score(observer, shown(30, 5, i, 0));
    EXPECT_EQ(here, score(again, shown(30, 5, i, 0)));
    differ_by_person += here != score(observer, shown(30, 5, i + 1000, 0));
    differ_by_position += here != score(observer, shown(30, 5, i, 1));
    ShownTrial other = shown(30, 5, i, 0);
    other.seed = 8;
    differ_by_seed += here != score(observer, other);
  }
  EXPECT_GT(differ_by_person, 50);
  EXPECT_GT(differ_by_position, 50);
  EXPECT_GT(differ_by_seed, 50);
}

TEST(PtpeObserver, DefaultsSpanTheRangeOfFigureSix) {
  EXPECT_LT(mean_score("ptpe:a=31,b=0.035", 20, 15, 16), 1.6);
  EXPECT_LT(mean_score("ptpe:a=24,b=0.02", 10, 5, 16), 2.6);
  const double best = mean_score("ptpe:a=31,b=0.035", 50, 0, 16);
  EXPECT_GT(best, 5.7);
  EXPECT_LT(best, 6.8);
}

TEST(PtpeObserver, SpecificationIsReadAndWrittenBack) {
  const PtpeObserver observer(parse_ptpe_observer("ptpe:b=0.035,a=31,noise=0.8"));
  EXPECT_EQ(*observer.simulated(), "ptpe:a=31,b=0.035,slope=0.14,noise=0.8,participant_sd=0.5");
  EXPECT_EQ(*PtpeObserver(parse_ptpe_observer(*observer.simulated())).simulated(), *observer.simulated());
}

struct Bad {
  const char* specification;
  const char* place_and_problem;
};

class PtpeObserverErrors : public ::testing::TestWithParam<Bad> {};

TEST_P(PtpeObserverErrors, NameThePlace) {
  try {
    parse_ptpe_observer(GetParam().specification);
    FAIL() << "accepted " << GetParam().specification;
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(GetParam().place_and_problem));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("mend: "));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PtpeObserverErrors,
    ::testing::Values(
        Bad{"", "character 1: is not a kind"}, Bad{"people", "character 1: is not a kind"},
        Bad{"ptpe:", "character 6: expected key=number"},
        Bad{"ptpe:a=31", "character 10: key 'b' is missing"},
        Bad{"ptpe:a=31,b=0.035,c=1", "character 19: unknown key 'c'"},
        Bad{"ptpe:a=31,a=31,b=0", "character 11: key 'a' is given twice"},
        Bad{"ptpe:a=,b=0", "character 8: '' is not a number"}, Bad{"ptpe:a=3x,b=0", "'3x' is not a number"},
        Bad{"ptpe:a=nan,b=0", "'nan' is not a number"}, Bad{"ptpe:a=inf,b=0", "'inf' is not a number"},
        Bad{"ptpe:a=1e999,b=0", "is not a number"}, Bad{"ptpe:a=0,b=0", "a = 0 is out of range"},
        Bad{"ptpe:a=31,b=2", "b = 2 is out of range"},
        Bad{"ptpe:a=31,b=0,noise=-1", "character 21: noise = -1 is out of range"},
        Bad{"ptpe:a=31,b=0,", "character 15: expected key=number"}));

}  // namespace
}  // namespace study
