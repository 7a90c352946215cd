#include "libstudy/observer/observer.hpp"
#include "libstudy/observer/frames_observer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "libstudy/observer/ptpe_observer.hpp"
#include "stats/base/error.hpp"

namespace study {
namespace {

Question seven_points() {
  Question question;
  question.id = "satisfaction";
  return question;
}

Occasion shown(double mean, double sd, int person, int position) {
  Occasion occasion;
  occasion.participant = "P" + std::to_string(person);
  occasion.seed = 7;
  occasion.position = position;
  occasion.shown.push_back({0, {{"dam", "Ours", "32k"}, {10, 0, 10}}, {300, mean, mean, sd}, 0, 0});
  return occasion;
}

int score(const Observer& observer, const Occasion& occasion) {
  return observer.score(seven_points(), occasion, true);
}

double mean_score(const std::string& specification, double mean, double sd, int people) {
  PtpeObserver observer(parse_ptpe_observer(specification));
  double sum = 0;
  for (int person = 0; person < people; ++person) sum += score(observer, shown(mean, sd, person, 3));
  return sum / people;
}

TEST(PtpeObserver, ScoresFourOnTheContourOnAverage) {
  // The standard error of the mean is about sqrt(noise^2 + participant_sd^2 + 1/12) / sqrt(people), here
  // sqrt(1 + 0.25 + 1/12) / sqrt(20000) = 0.008; 1/12 is the variance of rounding.
  for (const double sd : {0.0, 5.0, 10.0}) {
    EXPECT_NEAR(mean_score("ptpe:a=31,b=0.035", 31 * std::exp(0.035 * sd), sd, 20000), 4, 0.04) << sd;
  }
}

TEST(PtpeObserver, ExpectationFollowsTheClosedForm) {
  // P(score > k) = Phi((4 + slope tau - k - 1/2) / s), with slope = 0.14 and s^2 = noise^2 +
  // participant_sd^2.
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
  EXPECT_GT(score(observer, shown(50, 0, 1, 0)), 5);  // the cell asks for 10 frames/s
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
    Occasion other = shown(30, 5, i, 0);
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

TEST(PtpeObserver, PrefersEffectsByTheScoresThatItStates) {
  const PtpeObserver observer(parse_ptpe_observer("ptpe:a=30,b=0,noise=0,participant_sd=0,effects=1.6"));
  Occasion occasion = shown(30, 0, 1, 0);
  for (const auto& [level, wanted] : {std::pair{"", 4}, {"none", 4}, {"foam", 6}, {"scene", 6}}) {
    occasion.shown[0].what.stimulus.effects = level;
    EXPECT_EQ(score(observer, occasion), wanted) << level;
  }
  EXPECT_EQ(*observer.simulated(), "ptpe:a=30,b=0,slope=0.14,noise=0,participant_sd=0,effects=1.6");
  EXPECT_EQ(*PtpeObserver(parse_ptpe_observer("ptpe:a=30,b=0,effects=0")).simulated(),
            "ptpe:a=30,b=0,slope=0.14,noise=1,participant_sd=0.5")
      << "as records were before there was such a key";
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

/// Features by method: LoRes has coarse pictures (16 px), HiRes fine ones (8 px), and every other method 11
/// px. Flicker is equal.
class TwoFeatures final : public FeatureSource {
 public:
  PictureFeatures of(const StimulusSpec& stimulus) override {
    if (stimulus.method == "LoRes") return {16, 0.02};
    return {stimulus.method == "HiRes" ? 8.0 : 11.0, 0.02};
  }
};

TEST(FramesObserver, PrefersEffectsByTheScoresThatItStates) {
  TwoFeatures features;
  const FramesObserver observer(parse_frames_observer("frames:effects=1.25"), features);
  Occasion none = shown(30, 0, 1, 0), foam = none;
  none.shown[0].what.stimulus.effects = "none";
  foam.shown[0].what.stimulus.effects = "foam";
  EXPECT_DOUBLE_EQ(observer.quality(foam.shown[0]) - observer.quality(none.shown[0]), 1.25);
  EXPECT_THAT(*observer.simulated(), ::testing::EndsWith(",fatigue=0.02,effects=1.25"));
  EXPECT_THAT(*FramesObserver(FramesObserverParameters(), features).simulated(),
              ::testing::EndsWith(",fatigue=0.02"));
}

Question choice_of_two() {
  Question question;
  question.id = "preference";
  question.kind = AnswerKind::Choice;
  question.anchors = {{1, "first"}, {2, "second"}};
  question.scale_min = 1;
  question.scale_max = 2;
  return question;
}

ShownStimulus stimulus(const std::string& method, double mean, double sd) {
  return {0, {{"dam", method, "32k"}, {}}, {300, mean, mean, sd}, 0, 0};
}

Occasion pair_of(const ShownStimulus& first, const ShownStimulus& second, int person) {
  Occasion occasion = shown(30, 5, person, 3);
  occasion.shown = {first, second};
  return occasion;
}

/// Share of 4,000 people who prefer the second stimulus.
double second_preferred(const Observer& observer, const ShownStimulus& first, const ShownStimulus& second) {
  int count = 0;
  for (int person = 0; person < 4000; ++person)
    count += observer.score(choice_of_two(), pair_of(first, second, person), true) == 2;
  return count / 4000.0;
}

std::unique_ptr<Observer> observer_of(const std::string& specification) {
  static TwoFeatures features;
  return make_observer(specification, features);
}

TEST(MakeObserver, SpecificationsAreWrittenBackInFull) {
  const std::string of_frames =
      "frames:grain=4,flicker=0.6,timing=1.2,noise=0.9,participant_sd=0.5,bias=0,sickness=0.25,fatigue=0.02";
  for (const std::string& text :
       {std::string("random"), std::string("constant:4"), std::string("constant:2.5"),
        std::string("dropout:0.2,random"), std::string("dropout:0.1,constant:7"), of_frames}) {
    EXPECT_EQ(observer_of(text)->simulated(), text);
  }
  EXPECT_EQ(observer_of("dropout:0.2")->simulated(), "dropout:0.2,random");
  EXPECT_EQ(observer_of("frames:bias=0.5")->simulated(),
            "frames:grain=4,flicker=0.6,timing=1.2,noise=0.9,participant_sd=0.5,bias=0.5,sickness=0.25,"
            "fatigue=0.02");
  for (const char* bad : {"", "people", "constant:", "constant:x", "dropout:2", "dropout:0.1,people",
                          "frames:", "frames:bias=x", "frames:colour=1", "framesx", "random:1"})
    EXPECT_THROW(observer_of(bad), base::Error) << bad;
}

TEST(Observers, TheQuestionThatSteersAProcedureIsAnsweredByTheModel) {
  std::vector<Question> page{choice_of_two(), choice_of_two()};
  page[1].id = "steers";
  VirtualClock clock;
  const auto plain = observer_of("ptpe:a=31,b=0.035"), steered = observer_of("ptpe:a=31,b=0.035");
  steered->set_steering_question("steers");
  int as_first = 0, as_steering = 0;
  for (int person = 0; person < 50; ++person) {
    const Occasion occasion = shown(30, 0, person, 1);
    const auto model = plain->ask({}, {&page[1], 1}, occasion, clock, {})[0].answer.score;
    as_steering += steered->ask({}, page, occasion, clock, {})[1].answer.score == model;
    as_first += plain->ask({}, page, occasion, clock, {})[1].answer.score == model;
  }
  EXPECT_EQ(as_steering, 50);
  EXPECT_LT(as_first, 50);
}

TEST(Observers, TakePartAndAnswerWithinTheRules) {
  Question consent = choice_of_two(), screening = seven_points(), words, age = seven_points();
  consent.accept = {2, 2};
  screening.accept = {3, 4};
  words.kind = AnswerKind::Text;
  age.kind = AnswerKind::Number;
  age.scale_min = 18;
  age.scale_max = 99;
  const std::vector<Question> page{consent, screening, words, age};
  VirtualClock clock;
  for (const char* kind : {"random", "constant:7", "frames", "ptpe:a=31,b=0.035", "dropout:0.5"}) {
    const auto observer = observer_of(kind);
    for (int person = 0; person < 50; ++person) {
      Occasion occasion = shown(30, 0, person, 1);
      occasion.shown.clear();
      const auto answers = observer->ask({}, page, occasion, clock, {});
      ASSERT_EQ(answers.size(), 4u);
      EXPECT_EQ(answers[0].answer.score, 2);
      EXPECT_EQ(answers[1].answer.score, 3);
      EXPECT_FALSE(answers[2].answer.score);
      EXPECT_GE(answers[3].answer.score.value(), 18);
      EXPECT_LE(answers[3].answer.score.value(), 99);
      EXPECT_EQ(answers[0].response_time_s, 0);
    }
  }
  EXPECT_EQ(clock.now_ns(), 0);
}

TEST(Observers, AnswerLinesAndReactions) {
  Question line = seven_points(), reaction;
  line.kind = AnswerKind::Vas;
  line.scale_min = 0;
  line.scale_max = 600;
  reaction.id = "fast";
  reaction.kind = AnswerKind::Reaction;
  reaction.scale_min = 0;
  reaction.scale_max = 1;
  EXPECT_FALSE(asks_symptom(line)) << "it may ask for anything, and begins at 0";
  EXPECT_EQ(rated_score(line, 1), 400) << "a point of seven is a sixth of the line";
  EXPECT_EQ(rated_score(seven_points(), 1), 5);
  VirtualClock clock;
  for (const char* kind : {"random", "constant:1", "frames", "ptpe:a=31,b=0.035"}) {
    int pressed = 0;
    for (int person = 0; person < 50; ++person) {
      const auto answers =
          observer_of(kind)->ask({}, std::array{reaction, line}, shown(30, 0, person, 1), clock, {});
      pressed += *answers[0].answer.score;
      EXPECT_GE(answers[0].response_time_s, 0.2);
      EXPECT_EQ(answers[0].response_time_s < 5, answers[0].answer.score == 1);
      EXPECT_TRUE(can_be_given(line, *answers[1].answer.score));
      EXPECT_EQ(answers[1].response_time_s, 0);
    }
    EXPECT_EQ(pressed == 50, std::string(kind) != "random") << kind;
  }
}

TEST(Observers, OnlyWhoFeelsTriggersAStopRule) {
  Question sickness = fms_question("en", 2);
  VirtualClock clock;
  const auto most = [&](const char* kind) {
    int score = 0;
    for (int person = 0; person < 500; ++person) {
      const auto answers = observer_of(kind)->ask({}, {&sickness, 1}, shown(20, 10, person, 9), clock, {});
      score = std::max(score, answers.at(0).answer.score.value());
    }
    return score;
  };
  EXPECT_EQ(most("random"), 1);
  EXPECT_EQ(most("constant:20"), 1);
  EXPECT_GE(most("frames"), 10);
}

TEST(RandomObserver, GivesEveryScoreEquallyOften) {
  const auto observer = observer_of("random");
  std::vector<int> count(8);
  for (int person = 0; person < 7000; ++person)
    ++count.at(static_cast<std::size_t>(score(*observer, shown(30, 5, person, 2))));
  // The standard deviation of a count is sqrt(7000 (1/7) (6/7)) = 29.
  for (int k = 1; k <= 7; ++k) EXPECT_NEAR(count[static_cast<std::size_t>(k)], 1000, 120) << k;
}

TEST(ConstantObserver, SaysTheSameAndStaysOnTheScale) {
  EXPECT_EQ(score(*observer_of("constant:4"), shown(10, 5, 1, 2)), 4);
  EXPECT_EQ(score(*observer_of("constant:9"), shown(10, 5, 1, 2)), 7);
  EXPECT_EQ(observer_of("constant:4")->score(choice_of_two(), shown(10, 5, 1, 2), true), 2);
}

TEST(DropoutObserver, LeavesWithItsProbabilityBeforeEachTrial) {
  const auto observer = observer_of("dropout:0.2,constant:3");
  int left = 0;
  for (int person = 0; person < 200; ++person) {
    for (int position = 0; position < 50; ++position) {
      try {
        observer->before_trial(shown(30, 5, person, position));
      } catch (const Left&) {
        ++left;
      }
    }
  }
  EXPECT_NEAR(left / 10000.0, 0.2, 0.016);  // 0.016: four standard deviations
  EXPECT_EQ(score(*observer, shown(30, 5, 1, 1)), 3);
}

TEST(FramesObserver, PrefersFinePicturesAndSteadyTiming) {
  const auto observer = observer_of("frames:grain=1.2");
  const ShownStimulus coarse = stimulus("LoRes", 30, 5), fine = stimulus("HiRes", 30, 5);
  // The pictures' granularities differ by an octave, so the qualities by grain = 1.2. With noise 0.9 the
  // share is Phi(1.2 / 0.9) = 0.909.
  EXPECT_NEAR(second_preferred(*observer, coarse, fine), 0.909, 0.02);
  EXPECT_NEAR(second_preferred(*observer, fine, coarse), 0.091, 0.02);
  EXPECT_NEAR(second_preferred(*observer, fine, fine), 0.5, 0.032);
  EXPECT_GT(second_preferred(*observer, stimulus("HiRes", 15, 10), stimulus("HiRes", 50, 2)), 0.9);
}

TEST(FramesObserver, TheIntervalBiasShiftsChoicesOfEqualStimuli) {
  const ShownStimulus same = stimulus("Ours", 30, 5);
  // With bias 0.5 and noise 0.9 the share is Phi(0.5 / 0.9) = 0.711.
  EXPECT_NEAR(second_preferred(*observer_of("frames:bias=0.5"), same, same), 0.711, 0.03);
  EXPECT_NEAR(second_preferred(*observer_of("frames:bias=-0.5"), same, same), 0.289, 0.03);
}

TEST(FramesObserver, CoarsePicturesLookLessRealAndMakeSicker) {
  const auto observer = observer_of("frames:grain=1.2");
  Question dizziness = seven_points();
  dizziness.id = "dizziness";
  dizziness.scale_min = 0;
  dizziness.scale_max = 3;
  double realism[2] = {}, symptoms[2] = {};
  for (int person = 0; person < 2000; ++person) {
    for (const int fine : {0, 1}) {
      Occasion occasion = shown(30, 5, person, 4);
      occasion.shown = {stimulus(fine ? "HiRes" : "LoRes", 30, 5)};
      realism[fine] += score(*observer, occasion);
      symptoms[fine] += observer->score(dizziness, occasion, false);
    }
  }
  EXPECT_NEAR((realism[1] - realism[0]) / 2000, 1.2, 0.1);
  EXPECT_GT((symptoms[0] - symptoms[1]) / 2000, 0.1);
}

TEST(FeatureTable, KnowsTheCellsOfTheTasksAndNoOthers) {
  FeatureTable table;
  for (const char* scene : {"single_dam", "jet_impact", "faucet"}) {
    const auto features = [&](const char* method, const char* n_star) {
      return table.of({std::string("data/scenes/") + scene + ".toml", method, n_star});
    };
    for (const char* method : {"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"}) {
      EXPECT_GT(features(method, "16k").flicker, 0) << scene << method;
      EXPECT_NE(features(method, "16k").granularity_px, features(method, "32k").granularity_px);
      EXPECT_EQ(features(method, "1k").granularity_px, features(method, "16k").granularity_px);
    }
    EXPECT_GT(features("LoRes", "32k").granularity_px, features("HiRes", "32k").granularity_px) << scene;
    EXPECT_THROW(features("Theirs", "16k"), base::Error);
  }
  EXPECT_THROW(table.of({"peers_dam.toml", "HiRes", "16k"}), base::Error);
}

}  // namespace
}  // namespace study
