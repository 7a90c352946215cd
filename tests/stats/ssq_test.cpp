/// The Simulator Sickness Questionnaire's scores, and changes of sickness.
#include "stats/analysis/ssq.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "stats/analysis/sickness.hpp"

namespace stats {
namespace {

using ::testing::Optional;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

SsqAnswers all(int answer) {
  SsqAnswers answers;
  answers.fill(answer);
  return answers;
}

/// How often one item counts in a scale.
int times_in(SsqScale scale, int item) {
  SsqAnswers answers = all(0);
  answers[static_cast<std::size_t>(item - 1)] = 1;
  return ssq_sum(scale, answers).value();
}

TEST(Ssq, AllThreesGiveThePublishedMaxima) {
  const double maxima[] = {200.34, 159.18, 292.32, 235.62};
  for (std::size_t i = 0; i < ssq_scales.size(); ++i) {
    EXPECT_THAT(ssq_score(ssq_scales[i], all(3)), Optional(maxima[i]));
    EXPECT_THAT(ssq_score(ssq_scales[i], all(0)), Optional(0));
  }
}

TEST(Ssq, EveryItemCountsWhereKennedyPutsIt) {
  // One row per symptom: 1 if the paper's table 4 marks it for nausea, oculomotor symptoms or disorientation.
  const int marks[ssq_item_count][3] = {{1, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 1}, {1, 0, 0},
                                        {1, 0, 0}, {1, 0, 1}, {1, 1, 0}, {0, 0, 1}, {0, 1, 1}, {0, 0, 1},
                                        {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}};
  for (int item = 1; item <= ssq_item_count; ++item) {
    int in_total = 0;
    for (int scale = 0; scale < 3; ++scale) {
      EXPECT_EQ(times_in(ssq_scales[static_cast<std::size_t>(scale)], item), marks[item - 1][scale]) << item;
      in_total += marks[item - 1][scale];
    }
    EXPECT_EQ(times_in(SsqScale::Total, item), in_total) << "items of two scales count twice";
  }
}

TEST(Ssq, AMissingItemEmptiesItsScalesAndTheTotalAlone) {
  SsqAnswers answers = all(1);
  answers[6] = {};  // sweating counts only for nausea
  EXPECT_FALSE(ssq_score(SsqScale::Nausea, answers).has_value());
  EXPECT_THAT(ssq_score(SsqScale::Oculomotor, answers), Optional(53.06));
  EXPECT_THAT(ssq_score(SsqScale::Disorientation, answers), Optional(97.44));
  EXPECT_FALSE(ssq_score(SsqScale::Total, answers).has_value());
}

TEST(Ssq, AnAnswerOffTheScaleIsAProgrammingError) {
  SsqAnswers answers = all(0);
  answers[15] = 4;
  EXPECT_THROW(ssq_sum(SsqScale::Oculomotor, answers), std::invalid_argument);
  answers[15] = -1;
  EXPECT_THROW(ssq_score(SsqScale::Total, answers), std::invalid_argument);
}

AnalysisPlan quick_plan() {
  AnalysisPlan plan;
  plan.resamples = 400;
  return plan;
}

TEST(SicknessChange, ComparesThoseWithBothAndDescribesAll) {
  const std::vector<ExactMean> before{{0}, {1}, {2}, {missing}, {4}}, after{{1}, {1}, {6}, {9}, {missing}};
  auto plan = quick_plan();
  plan.confidence = 0.7;  // the interval of three signed ranks has at most the level 0.75
  const auto change = compare_sickness(before, after, 2, plan);
  EXPECT_EQ(change.n, 3u);
  EXPECT_EQ(change.n_missing, 2u);
  EXPECT_EQ(change.before->n, 4u);
  EXPECT_DOUBLE_EQ(change.before->mean, 3.5);
  EXPECT_DOUBLE_EQ(change.after->max, 18);
  EXPECT_DOUBLE_EQ(change.change->mean, 10. / 3);
  EXPECT_DOUBLE_EQ(change.bootstrap->estimate, 10. / 3);
  EXPECT_EQ(change.ranks->n_nonzero, 2u);
  EXPECT_DOUBLE_EQ(change.ranks->w_plus, 3);
  EXPECT_DOUBLE_EQ(change.ranks->hodges_lehmann, 3) << "on the score's scale: Walsh averages 0 1 1 2 4 8";
}

TEST(SicknessChange, EqualChangesTieWhateverTheirLevel) {
  // The changes of the first two differ as doubles.
  ASSERT_NE(9.54 * 7 - 9.54 * 1, 9.54 * 6 - 9.54 * 0);
  const std::vector<ExactMean> before{{1}, {0}, {0}}, after{{7}, {6}, {9}};
  const auto change = compare_sickness(before, after, 9.54, quick_plan());
  EXPECT_TRUE(change.ranks->has_ties);
}

TEST(SicknessChange, WithoutAnyChangeThereIsNoTest) {
  const std::vector<ExactMean> same{{2}, {0}};
  const auto change = compare_sickness(same, same, 1, quick_plan());
  EXPECT_EQ(change.change->mean, 0);
  EXPECT_FALSE(change.ranks);
  EXPECT_FALSE(change.bootstrap);
}

TEST(SicknessChange, CountsParticipantsAlsoWhereTheirChangesAreRefused) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto change =
      compare_sickness(std::vector<ExactMean>{{0}, {infinite}, {2}, {missing}},
                       std::vector<ExactMean>{{1}, {1}, {missing}, {missing}}, 1, quick_plan());
  EXPECT_FALSE(change.change);
  EXPECT_EQ(change.n, 2u);
  EXPECT_EQ(change.n_missing, 1u);
}

}  // namespace
}  // namespace stats
