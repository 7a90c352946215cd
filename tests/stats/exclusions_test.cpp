#include "stats/analysis/exclusions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stats {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Trials of one visit, whose timing passes, with these main ratings and five answers in each.
std::vector<TrialRecord> visit(const std::vector<double>& ratings, const std::string& participant = "P1") {
  std::vector<TrialRecord> out;
  for (const double rating : ratings) {
    TrialRecord trial;
    trial.participant = participant;
    trial.position = static_cast<int>(out.size());
    trial.timing = TrialTiming::Pass;
    trial.answer = rating;
    trial.answers = 5;
    out.push_back(trial);
  }
  return out;
}

const std::vector<double> ordinary{4, 5, 3, 6, 4, 5, 2, 6, 4, 5};

TEST(Exclusions, OrdinaryVisitsStay) {
  EXPECT_THAT(find_exclusions(visit(ordinary), {}, {}, false), IsEmpty());
  EXPECT_THAT(find_exclusions({}, {}, {}, false), IsEmpty());
}

TEST(Exclusions, TimingVerdictsAsTheRuleSays) {
  auto trials = visit(ordinary);
  trials[2].timing = TrialTiming::Fail;
  trials[2].timing_reason = "14 frames late";
  trials[5].timing = TrialTiming::Degraded;
  trials[7].timing = TrialTiming::Unjudged;
  ExclusionRules rules;
  const auto failed = find_exclusions(trials, {}, rules, false);
  ASSERT_THAT(failed, SizeIs(1));
  EXPECT_EQ(failed[0].position, 2);
  EXPECT_EQ(failed[0].rule, "timing");
  EXPECT_EQ(failed[0].reason, "timing verdict fail: 14 frames late");
  EXPECT_EQ(failed[0].answers, 5);
  rules.timing = TimingRule::Degraded;
  EXPECT_THAT(find_exclusions(trials, {}, rules, false), SizeIs(2));
  rules.timing = TimingRule::None;
  EXPECT_THAT(find_exclusions(trials, {}, rules, false), IsEmpty());
}

TEST(Exclusions, TheExperimentersReasonComesFirst) {
  auto trials = visit(ordinary);
  trials[2].timing = TrialTiming::Fail;
  trials[2].by_experimenter = "the phone rang";
  const auto found = find_exclusions(trials, {}, {}, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "experimenter");
  EXPECT_TRUE(found[0].by_hand());
  EXPECT_EQ(found[0].reason, "the phone rang");
}

TEST(Exclusions, CatchPagesBelowTheShareExcludeTheVisit) {
  const auto trials = visit(ordinary);
  const std::vector<CatchRecord> one_of_two{{"P1", 1, true}, {"P1", 1, false}};
  EXPECT_THAT(find_exclusions(trials, one_of_two, {}, false), IsEmpty()) << "half is enough by default";
  const std::vector<CatchRecord> none{{"P1", 1, false}, {"P1", 1, false}};
  const auto found = find_exclusions(trials, none, {}, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].position, -1);
  EXPECT_EQ(found[0].rule, "catch");
  EXPECT_THAT(found[0].reason, HasSubstr("0 of 2"));
  EXPECT_EQ(found[0].answers, 50);
  EXPECT_TRUE(is_excluded(found, "P1", 1, 7));
  EXPECT_FALSE(is_excluded(found, "P1", 2, 7));
  EXPECT_FALSE(is_excluded(found, "P2", 1, 7));
}

TEST(Exclusions, RepeatsFarFromTheirOriginals) {
  auto trials = visit(ordinary);
  for (int i = 0; i < 2; ++i) {
    TrialRecord repeat = trials[0];
    repeat.position = 10 + i;
    repeat.repeats = i;         // the originals' answers are 4 and 5
    repeat.answer = i ? 1 : 7;  // 3 and 4 points from the originals
    trials.push_back(repeat);
  }
  const auto found = find_exclusions(trials, {}, {}, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "repeat");
  EXPECT_THAT(found[0].reason, HasSubstr("3.5 points"));
  ExclusionRules lenient;
  lenient.max_repeat_difference = 3.5;
  EXPECT_THAT(find_exclusions(trials, {}, lenient, false), IsEmpty());
}

TEST(Exclusions, RepeatedPairsByAgreement) {
  auto trials = visit({1, 2, 1, 2});
  TrialRecord repeat = trials[0];
  repeat.position = 4;
  repeat.repeats = 0;
  repeat.answer = 2;
  trials.push_back(repeat);
  ExclusionRules rules;
  EXPECT_THAT(find_exclusions(trials, {}, rules, true), IsEmpty()) << "off by default";
  rules.min_repeat_agreement = 0.5;
  EXPECT_THAT(find_exclusions(trials, {}, rules, true), SizeIs(1));
  trials.back().answer = 1;
  EXPECT_THAT(find_exclusions(trials, {}, rules, true), IsEmpty());
}

TEST(Exclusions, OneAnswerToEverything) {
  EXPECT_THAT(find_exclusions(visit(std::vector<double>(10, 4)), {}, {}, false), IsEmpty())
      << "who sees no difference is not left out unasked";
  ExclusionRules rules;
  rules.straight_lining_answers = 8;
  const auto found = find_exclusions(visit(std::vector<double>(10, 4)), {}, rules, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "straight_lining");
  EXPECT_EQ(found[0].reason, "gave 4 in all 10 main ratings");
  const auto pairs = find_exclusions(visit(std::vector<double>(10, 2)), {}, rules, true);
  EXPECT_EQ(pairs.at(0).reason, "chose the second interval in all 10 pairs");
  EXPECT_THAT(find_exclusions(visit(std::vector<double>(7, 4)), {}, rules, false), IsEmpty())
      << "too few to tell";
  auto one_other = visit(std::vector<double>(10, 4));
  one_other[9].answer = 5;
  EXPECT_THAT(find_exclusions(one_other, {}, rules, false), IsEmpty());
}

TEST(Exclusions, UnfinishedVisitsOnlyWhenAsked) {
  auto trials = visit({4, 5, TrialRecord::unanswered, TrialRecord::unanswered, TrialRecord::unanswered});
  EXPECT_THAT(find_exclusions(trials, {}, {}, false), IsEmpty());
  ExclusionRules rules;
  rules.min_answered = 0.5;
  const auto found = find_exclusions(trials, {}, rules, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "incomplete");
  EXPECT_THAT(found[0].reason, HasSubstr("2 of 5"));
}

TEST(Exclusions, AnswersAreCountedOnce) {
  auto trials = visit(std::vector<double>(10, 4));
  trials[3].timing = TrialTiming::Fail;
  ExclusionRules rules;
  rules.straight_lining_answers = 8;
  const auto found = find_exclusions(trials, {}, rules, false);
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].position, -1) << "whole visits first";
  EXPECT_EQ(found[0].answers, 45);
  EXPECT_EQ(found[1].answers, 5);
}

TEST(Exclusions, PeopleAndVisitsAreTheirOwn) {
  auto trials = visit(std::vector<double>(10, 4), "P2");
  for (const auto& trial : visit(ordinary, "P1")) trials.push_back(trial);
  ExclusionRules rules;
  rules.straight_lining_answers = 8;
  const auto found = find_exclusions(trials, {}, rules, false);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].participant, "P2");
}

}  // namespace
}  // namespace stats
