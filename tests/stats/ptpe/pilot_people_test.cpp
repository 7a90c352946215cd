/// Reverse coders (people who use the rating scale the wrong way round), drift of ratings over the session
/// and lapses of attention: their detection, and the corrections by the plan's rules.
#include "stats/ptpe/pilot_people.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "tests/stats/ptpe/simulated_ratings.hpp"

namespace {

using ::testing::HasSubstr;

struct Raters {
  int people = 16;
  int reversed = 0;   ///< this many people, the first ones, answer 8 - score
  double drift = 0;   ///< points from the first to the last trial
  double lapses = 0;  ///< share of answers that are the lowest score whatever was shown
};

/// The parametric observer's pilot, with the settings in a different order for each person.
std::vector<stats::PilotRating> pilot(const Raters& raters, std::uint64_t seed) {
  const simulated::Truth truth;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto settings = simulated::pilot(truth, 1, 1);
  std::vector<stats::PilotRating> ratings;
  for (int p = 0; p < raters.people; ++p) {
    const double person = truth.participant_sd * normal(engine);
    auto order = settings;
    std::shuffle(order.begin(), order.end(), engine);
    for (std::size_t i = 0; i < order.size(); ++i) {
      auto rating = order[i];
      rating.participant = p;
      rating.position = static_cast<int>(i);
      const double tau = rating.mu - truth.a * std::exp(truth.b * rating.delta);
      const double place = static_cast<double>(i) / static_cast<double>(order.size() - 1) - 0.5;
      const double x = 4 + truth.slope * tau + person + raters.drift * place + truth.noise * normal(engine);
      rating.score = std::clamp(std::round(x), 1.0, 7.0);
      if (p < raters.reversed) rating.score = 8 - rating.score;
      if (uniform(engine) < raters.lapses) rating.score = 1;
      ratings.push_back(rating);
    }
  }
  return ratings;
}

TEST(PilotPeople, OrdinaryRatersAreLeftAlone) {
  const auto people = stats::pilot_people(pilot({}, 1), 0.95);
  EXPECT_EQ(people.slopes.size(), 16u);
  EXPECT_EQ(people.reversed(), 0);
  ASSERT_TRUE(people.drift) << people.drift.reason();
  EXPECT_FALSE(people.drift->found());
  ASSERT_TRUE(people.lapses) << people.lapses.reason();
  EXPECT_FALSE(people.lapses->found());
}

// Least squares in closed form.
TEST(PilotPeople, ASlopeIsOfOnePersonWithinStandardDeviations) {
  std::vector<stats::PilotRating> ratings;
  const std::vector<std::array<double, 3>> given{{10, 0, 1}, {20, 0, 3}, {40, 0, 4},
                                                 {20, 5, 2}, {40, 5, 5}, {80, 5, 6}};
  for (const auto& [mu, delta, score] : given) ratings.push_back({3, mu, delta, mu, mu, delta, score, 0});
  const auto people = stats::pilot_people(ratings, 0.95);
  ASSERT_EQ(people.slopes.size(), 1u);
  // x, log mu standardised, is -1, 0, 1 at both delta. With y about its mean at each delta, the sums of x y
  // are 3 and 4. So the slope is 7 / 4 and the residual sum of squares is sum y^2 - 7^2 / 4.
  const double slope = 7.0 / 4, yy = 14.0 / 3 + 26.0 / 3, rest = yy - slope * 7;
  EXPECT_NEAR(people.slopes[0].slope, slope, 1e-12);
  EXPECT_EQ(people.slopes[0].df, 3);
  EXPECT_NEAR(people.slopes[0].t, slope / std::sqrt(rest / 3 / 4), 1e-10);
}

TEST(PilotPeople, AReverseCoderIsFoundAndLeftOutByTheRule) {
  const auto ratings = pilot({.reversed = 2}, 2);
  const auto people = stats::pilot_people(ratings, 0.95);
  EXPECT_EQ(people.reversed(), 2);
  EXPECT_TRUE(people.slopes[0].reversed && people.slopes[1].reversed);
  EXPECT_EQ(stats::apply_rules(ratings, people, {}).size(), ratings.size());
  EXPECT_EQ(stats::apply_rules(ratings, people, {.exclude_reverse_coders = true}).size(), 14u * 21);
}

TEST(PilotPeople, ADriftIsFoundAndTakenOffAboutTheMiddleOfTheSession) {
  const auto ratings = pilot({.drift = -3}, 3);
  const auto people = stats::pilot_people(ratings, 0.95);
  ASSERT_TRUE(people.drift);
  EXPECT_TRUE(people.drift->found());
  EXPECT_NEAR(people.drift->change, -3, 1);
  const auto mended = stats::apply_rules(ratings, people, {.model_drift = true});
  const auto after = stats::pilot_people(mended, 0.95);
  EXPECT_NEAR(after.drift->change, 0, 0.1);
  double sum = 0;  // the middle of the session keeps its scores
  for (std::size_t i = 0; i < ratings.size(); ++i) {
    sum += mended[i].score - ratings[i].score;
    if (ratings[i].position == 10) {
      EXPECT_EQ(mended[i].score, ratings[i].score);
    }
  }
  EXPECT_NEAR(sum, 0, 1e-9);
}

TEST(PilotPeople, LapsesAreFoundAndMoveNoMeanUnderTheRule) {
  const auto ratings = pilot({.people = 40, .lapses = 0.08}, 4), clean = pilot({.people = 40}, 4);
  const auto people = stats::pilot_people(ratings, 0.95);
  ASSERT_TRUE(people.lapses) << people.lapses.reason();
  EXPECT_TRUE(people.lapses->found());
  EXPECT_NEAR(people.lapses->rate, 0.08, 0.03);
  const auto mean = [](const std::vector<stats::PilotRating>& list) {
    double sum = 0;
    for (const auto& rating : list) sum += rating.score / static_cast<double>(list.size());
    return sum;
  };
  const double lost = mean(clean) - mean(ratings);
  EXPECT_GT(lost, 0.15);
  EXPECT_NEAR(mean(stats::apply_rules(ratings, people, {.model_lapses = true})), mean(clean), 0.5 * lost);
}

namespace {

/// Ten settings for each person, near the person's own contour and all of them different, as adaptive
/// placement gives them.
std::vector<stats::PilotRating> own_settings(const Raters& raters, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<stats::PilotRating> ratings;
  for (int p = 0; p < raters.people; ++p) {
    const double person = 0.5 * normal(engine);
    for (int i = 0; i < 10; ++i) {
      const double delta = 10 * (i % 3), contour = 24 * std::exp(0.02 * delta);
      const double mu = (contour - 2 * person) * std::exp(0.7 * uniform(engine) - 0.35);
      const double x =
          4 + 0.14 * (mu - contour) + person + raters.drift * (i / 9.0 - 0.5) + 0.9 * normal(engine);
      const double score = uniform(engine) < raters.lapses ? 1 : std::clamp(std::round(x), 1.0, 7.0);
      ratings.push_back({p, mu, delta, mu, mu, delta, score, i});
    }
  }
  return ratings;
}

}  // namespace

TEST(PilotPeople, DriftAndLapsesAreFoundWherePeopleRatedSettingsOfTheirOwn) {
  int drift_found = 0, lapses_found = 0, false_drift = 0, false_lapses = 0;
  double change = 0, rate = 0;
  constexpr int studies = 40;
  for (int seed = 1; seed <= studies; ++seed) {
    const auto same = stats::pilot_people(own_settings({}, seed), 0.95);
    false_drift += same.drift->found();
    false_lapses += same.lapses->found();
    const auto drifting = stats::pilot_people(own_settings({.drift = -1.5}, seed), 0.95);
    drift_found += drifting.drift->found();
    change += drifting.drift->change / studies;
    const auto lapsing = stats::pilot_people(own_settings({.lapses = 0.1}, seed), 0.95);
    lapses_found += lapsing.lapses->found();
    rate += lapsing.lapses->rate / studies;
  }
  EXPECT_GE(drift_found, 36);
  EXPECT_NEAR(change, -1.5, 0.15);
  EXPECT_GE(lapses_found, 36);
  EXPECT_NEAR(rate, 0.1, 0.03);
  EXPECT_LE(false_drift, 6);
  EXPECT_LE(false_lapses, 2);
}

TEST(PilotPeople, RandomAnswersInAPartOfTheTrialsAreFound) {
  auto ratings = pilot({}, 3);
  const auto before = stats::pilot_people(ratings, 0.95);
  ASSERT_TRUE(before.far);
  EXPECT_FALSE(before.far->found());
  EXPECT_EQ(before.far->answers, 16 * 21);
  for (std::size_t i = 0; i < ratings.size(); i += 8) ratings[i].score = 1 + static_cast<double>(i / 8 % 7);
  const auto after = stats::pilot_people(ratings, 0.95);
  EXPECT_TRUE(after.far->found());
  EXPECT_GT(after.far->far, before.far->far + 5);
}

TEST(PilotPeople, WithoutAScatterTheReasonOfNoLapsesIsTheTrueOne) {
  const auto reason = [](double low, double middle, double high) {
    std::vector<stats::PilotRating> ratings;
    for (int p = 0; p < 3; ++p)
      for (const double mu : {10.0, 20.0, 40.0})
        ratings.push_back({p, mu, 0, mu, mu, 0, mu < 15 ? low : mu > 30 ? high : middle, 0});
    ratings[0].score += high > low ? 1 : 0;  // two different answers to this setting
    return stats::pilot_people(ratings, 0.95).lapses.reason();
  };
  EXPECT_EQ(reason(0, 1, 10), "no expected score lies in the middle half of the scores given");
  EXPECT_EQ(reason(0, 5, 10),
            "no answer whose expected score lies in the middle half of the scores given departs from it");
  EXPECT_EQ(reason(4, 4, 4), "all answers are equal");
}

TEST(PilotPeople, WithoutPositionsThereIsNoDrift) {
  const auto people = stats::pilot_people(simulated::pilot({}, 8, 1), 0.95);
  EXPECT_THAT(people.drift.reason(), HasSubstr("positions"));
}

/// Shares of pilots. reversed: all reversed people were found; false_alarms: somebody else was taken for one;
/// drift, lapses: drift or lapses were found.
struct Found {
  double reversed = 0, false_alarms = 0, drift = 0, lapses = 0;
  double bias = 0, bias_mended = 0;  ///< bias of a, frames/s
};

Found found_in(const Raters& raters, int pilots) {
  Found sum;
  int fitted = 0;
  for (int i = 0; i < pilots; ++i) {
    const auto ratings = pilot(raters, static_cast<std::uint64_t>(i) + 1);
    const auto people = stats::pilot_people(ratings, 0.95);
    bool all = true, other = false;
    for (const auto& one : people.slopes)
      (one.participant < raters.reversed ? all : other) =
          one.participant < raters.reversed ? all && one.reversed : other || one.reversed;
    sum.reversed += all;
    sum.false_alarms += other;
    sum.drift += people.drift && people.drift->found();
    sum.lapses += people.lapses && people.lapses->found();
    const auto fit_of = [](const std::vector<stats::PilotRating>& list) {
      return stats::estimate_direct(stats::PilotTable(list).observations(stats::PilotMean::Harmonic), 4, {0})
          .fit;
    };
    const auto before = fit_of(ratings),
               after =
                   fit_of(stats::apply_rules(ratings, people, {true, raters.drift != 0, raters.lapses > 0}));
    if (!before || !after) continue;
    ++fitted;
    sum.bias += before->curve.a() - 24;
    sum.bias_mended += after->curve.a() - 24;
  }
  for (double* share : {&sum.reversed, &sum.false_alarms, &sum.drift, &sum.lapses}) *share /= pilots;
  sum.bias /= fitted;
  sum.bias_mended /= fitted;
  return sum;
}

TEST(PilotPeopleSlow, SizeAndPower) {
  const char* given = std::getenv("VIP_PILOTS");
  const int pilots = given ? std::atoi(given) : 500;
  std::printf(
      "| people | reverse coders | drift | lapses | reverse coders found | others called so | drift found | "
      "lapses found | bias of a | with the rule that fits |\n");
  for (const int people : {12, 16, 24}) {
    for (const Raters& raters :
         {Raters{people}, Raters{people, 1}, Raters{people, 3}, Raters{people, 0, -2}, Raters{people, 0, -4},
          Raters{people, 0, 4}, Raters{people, 0, 0, 0.05}, Raters{people, 0, 0, 0.1}}) {
      const auto found = found_in(raters, pilots);
      std::printf("| %d | %d | %g | %g | %.3f | %.3f | %.3f | %.3f | %+.2f | %+.2f |\n", people,
                  raters.reversed, raters.drift, raters.lapses, found.reversed, found.false_alarms,
                  found.drift, found.lapses, found.bias, found.bias_mended);
      std::fflush(stdout);
      EXPECT_LE(found.false_alarms, 0.02);
      EXPECT_GE(found.reversed, raters.reversed > 0 ? 0.85 : 0);
      EXPECT_GE(found.drift, raters.drift == 0 ? 0 : 0.95);
      EXPECT_LE(found.drift, raters.drift == 0 ? 0.09 : 1);
      EXPECT_GE(found.lapses, raters.lapses > 0 ? 0.9 : 0);
    }
  }
}

}  // namespace
