/// Cumulative-link mixed models of separated ratings: the penalised fit against brute force, and in simulated
/// studies of six people.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"

namespace {

using stats::fit_cumulative_link_mixed;
using stats::Link;
using stats::MixedOrdinalFit;
using stats::Predictor;
using stats::Separation;

constexpr std::size_t methods = 5;

struct Study {
  std::vector<double> ratings, method;
  std::vector<int> people;

  stats::Result<MixedOrdinalFit> fit(Separation separation, int points = 15) const {
    return fit_cumulative_link_mixed(ratings, stats::indicators("method", method, 0), people, Link::Logit,
                                     points, separation);
  }
};

/// Effects in logits; the first method's is 0. The standard deviation of people is 1.
struct Truth {
  const char* words;
  std::vector<double> thresholds, effects;
};

/// With the first three truths most answers are 0, as for sickness.
const Truth no_effect{"mostly zero, no effect", {1.5, 3, 4.5}, {0, 0, 0, 0, 0}};
const Truth one_worse{"mostly zero, effects", {1.5, 3, 4.5}, {0, 2, 1, 0, 0}};
const Truth rare{"rarely not zero, effects", {2.5, 4, 5.5}, {0, 2, 1, 0, 0}};
const Truth far_apart{"methods far apart", {-3, -1.5, 0, 1.5, 3}, {0, -5, -4, -1, 0}};

/// Every person rates each method once.
Study simulate(const Truth& truth, int people, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(1e-12, 1);
  Study out;
  for (int person = 0; person < people; ++person) {
    const double level = normal(random);
    for (std::size_t method = 0; method < methods; ++method) {
      const double u = uniform(random), latent = level + truth.effects[method] + std::log(u / (1 - u));
      out.people.push_back(person);
      out.method.push_back(static_cast<double>(method));
      out.ratings.push_back(static_cast<double>(std::count_if(
          truth.thresholds.begin(), truth.thresholds.end(), [&](double t) { return latent > t; })));
    }
  }
  return out;
}

/// The first simulated study of six people whose ratings are separated, or, if not `separated`, the first one
/// that can be fitted without a penalty.
Study first_study(const Truth& truth, bool separated) {
  std::mt19937_64 random(1);
  for (;;) {
    auto study = simulate(truth, 6, random);
    const auto reason = study.fit(Separation::Refuse).reason();
    if (separated ? reason.starts_with("separation") : reason.empty()) return study;
  }
}

/// The log-likelihood by the trapezoidal rule over each person's effect, from the explicit logistic
/// distribution. Plus the penalty: for each effect b, the log of exp(b / 2) / (1 + exp(b)) less its value at
/// b = 0.
double penalised_log_likelihood(const Study& study, const MixedOrdinalFit& at) {
  const auto F = [](double x) { return 1 / (1 + std::exp(-x)); };
  constexpr double step = 0.02, end = 9;
  double out = 0;
  for (const double b : at.beta) out += b / 2 - std::log1p(std::exp(b)) + std::log(2);
  for (const int person : std::set<int>(study.people.begin(), study.people.end())) {
    double integral = 0;
    for (double u = -end; u <= end; u += step) {
      double density = std::exp(-u * u / 2) / std::sqrt(2 * std::acos(-1)) * step;
      for (std::size_t i = 0; i < study.ratings.size(); ++i) {
        if (study.people[i] != person) continue;
        const auto m = static_cast<std::size_t>(study.method[i]);
        const double v = at.sd_participant * u + (m ? at.beta[m - 1] : 0);
        const auto c = static_cast<std::size_t>(
            std::find(at.levels.begin(), at.levels.end(), study.ratings[i]) - at.levels.begin());
        density *=
            (c < at.thresholds.size() ? F(at.thresholds[c] - v) : 1) - (c ? F(at.thresholds[c - 1] - v) : 0);
      }
      integral += density;
    }
    out += std::log(integral);
  }
  return out;
}

TEST(PenalisedOrdinal, IsTheMaximumOfTheLikelihoodTimesThePrior) {
  for (const auto* truth : {&no_effect, &far_apart}) {
    const auto study = first_study(*truth, true);
    const auto fit = study.fit(Separation::Penalise, 41);
    ASSERT_TRUE(fit) << fit.reason();
    EXPECT_NEAR(fit->objective(), penalised_log_likelihood(study, *fit), 1e-5) << truth->words;
    EXPECT_LT(fit->log_prior, 0);
    auto at = *fit;
    std::vector<double*> parameters{&at.sd_participant};
    for (auto* list : {&at.thresholds, &at.beta})
      for (double& one : *list) parameters.push_back(&one);
    for (double* one : parameters) {
      constexpr double h = 1e-3;
      const double here = *one;
      *one = here + h;
      const double above = penalised_log_likelihood(study, at);
      *one = here - h;
      const double below = penalised_log_likelihood(study, at);
      *one = here;
      EXPECT_NEAR((above - below) / (2 * h), 0, 1e-4) << truth->words << ", at " << here;
    }
  }
}

TEST(PenalisedOrdinal, NothingChangesWhereRatingsOverlap) {
  for (const auto* truth : {&no_effect, &one_worse, &far_apart}) {
    const auto study = first_study(*truth, false);
    const auto plain = study.fit(Separation::Refuse), same = study.fit(Separation::Penalise);
    EXPECT_EQ(plain->beta, same->beta);
    EXPECT_EQ(plain->thresholds, same->thresholds);
    EXPECT_EQ(plain->covariance, same->covariance);
    EXPECT_EQ(plain->log_likelihood, same->log_likelihood);
    EXPECT_EQ(same->why_penalised, "");
    EXPECT_EQ(same->log_prior, 0);
  }
}

TEST(PenalisedOrdinal, SaysWhyAndIsOfLogOdds) {
  const auto study = first_study(no_effect, true);
  EXPECT_EQ(study.fit(Separation::Penalise)->why_penalised, study.fit(Separation::Refuse).reason());
  EXPECT_THROW(
      fit_cumulative_link_mixed(study.ratings, {}, study.people, Link::Probit, 15, Separation::Penalise),
      std::invalid_argument);
}

/// Fits of many studies of six people: sums, over the fitted studies, of each effect's error and its square,
/// and the number of 95 % intervals that hold the effect.
struct Tally {
  int studies = 0, separated = 0, refused = 0;
  std::vector<double> error = std::vector<double>(methods - 1), square = error, held = error;
  double largest = 0;  ///< largest of all effects and their standard errors

  double bias(std::size_t k) const { return error[k] / fitted(); }
  double root_mean_square(std::size_t k) const { return std::sqrt(square[k] / fitted()); }
  double coverage(std::size_t k) const { return held[k] / fitted(); }
  double fitted() const { return studies - refused; }
};

Tally fit_many(const Truth& truth, int studies) {
  std::mt19937_64 random(3);
  Tally out;
  while (out.studies < studies) {
    const auto study = simulate(truth, 6, random);
    if (std::set<double>(study.ratings.begin(), study.ratings.end()).size() < 2) continue;
    ++out.studies;
    const auto fit = study.fit(Separation::Penalise);
    out.refused += fit ? 0 : 1;
    if (!fit) continue;
    out.separated += fit->why_penalised.empty() ? 0 : 1;
    for (std::size_t k = 0; k + 1 < methods; ++k) {
      const double error = fit->beta[k] - truth.effects[k + 1];
      const double se = fit->se()[fit->thresholds.size() + k];
      out.error[k] += error;
      out.square[k] += error * error;
      out.held[k] += std::abs(error) < 1.96 * se ? 1 : 0;
      out.largest = std::max({out.largest, std::abs(fit->beta[k]), se});
    }
  }
  return out;
}

TEST(PenalisedOrdinal, FewStudiesOfSixPeopleAreLeftWithoutEstimates) {
  const auto zeros = fit_many(no_effect, 40), apart = fit_many(far_apart, 40);
  EXPECT_GT(zeros.separated, 16) << "studies that were refused before";
  EXPECT_GT(apart.separated, 12);
  for (const auto* one : {&zeros, &apart}) {
    EXPECT_LE(one->refused, 1);
    EXPECT_LT(one->largest, 20) << "no estimate runs away";
  }
}

// Prints the table of docs/statistics.md about separated answers.
TEST(PenalisedOrdinalSlow, EstimatesOfSixPeopleAreNearTheTruth) {
  for (const auto* truth : {&no_effect, &one_worse, &rare, &far_apart}) {
    const auto got = fit_many(*truth, 1000);
    std::printf("%s: separated %.3f, refused %.3f, largest %.1f\n", truth->words, got.separated / 1000.0,
                got.refused / 1000.0, got.largest);
    EXPECT_LT(got.refused, 20) << truth->words;
    EXPECT_GT(got.separated, 400) << truth->words;
    for (std::size_t k = 0; k + 1 < methods; ++k) {
      std::printf("  effect %4.1f: bias %5.2f, error %.2f, interval holds %.3f\n", truth->effects[k + 1],
                  got.bias(k), got.root_mean_square(k), got.coverage(k));
      EXPECT_LT(std::abs(got.bias(k)), 0.6) << truth->words;
      EXPECT_LT(got.root_mean_square(k), 2) << truth->words;
      EXPECT_GT(got.coverage(k), 0.9) << truth->words;
    }
  }
}

}  // namespace
