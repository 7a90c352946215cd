#include "stats/ordinal/cumulative_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/stats/oracle.hpp"

namespace {

using json = base::Json;
using stats::fit_cumulative_link;
using stats::fit_cumulative_link_mixed;
using stats::Link;
using stats::Predictor;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Columns by name; cells that are not numbers are missing.
std::map<std::string, std::vector<double>> read_columns(const std::string& name) {
  std::ifstream in(oracle::folder() / name);
  EXPECT_TRUE(in) << name;
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> columns;
  std::string line, cell;
  std::getline(in, line);
  for (std::istringstream head(line); std::getline(head, cell, ',');) {
    std::erase_if(cell, [](char c) { return c == '"' || c == '\r'; });
    names.push_back(cell);
  }
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    for (const auto& column : names) {
      std::getline(cells, cell, ',');
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      columns[column].push_back(end == cell.c_str() ? nan : value);
    }
  }
  return columns;
}

/// A fit, and what tests compare besides: `sd` is the standard deviation of people, if the model has it.
struct Reported {
  stats::OrdinalFit fit;
  double sd = nan;
  double reduced = 0;  ///< log-likelihood of the model without the predictor method
};

stats::Result<Reported> fit_model(const std::string& model, const json& input) {
  auto columns = read_columns(input.at("csv"));
  const auto& ratings = columns.at("rating");
  const auto methods = stats::indicators("method", columns.at("method"), input.at("reference_method"));
  const Link link = model.find("probit") == std::string::npos ? Link::Logit : Link::Probit;
  if (model.starts_with("clm_")) {
    const auto full = fit_cumulative_link(ratings, methods, link);
    if (!full) return stats::Refusal{full.reason()};
    return Reported{*full, nan, fit_cumulative_link(ratings, {}, link)->log_likelihood};
  }
  const auto at = model.find("agq");
  const int points = at == std::string::npos ? 1 : std::stoi(model.substr(at + 3));
  const std::vector<int> people(columns.at("participant").begin(), columns.at("participant").end());
  const auto full = fit_cumulative_link_mixed(ratings, methods, people, link, points);
  if (!full) return stats::Refusal{full.reason()};
  return Reported{*full, full->sd_participant,
                  fit_cumulative_link_mixed(ratings, {}, people, link, points)->log_likelihood};
}

/// Tolerances of oracle/README.md: clm 1e-5, or the case's own if that is tighter; clmm estimates 1e-3. The
/// reference's optimiser stops early, so an estimate near zero is compared within 2e-4 standard errors, and a
/// spread near zero absolutely. Its Laplace log-likelihoods and their ratios are off by up to 1.3e-4, because
/// they use the curvature before the last Newton step (TheReferencesLaplaceUsesAStaleCurvature proves it).
struct Tolerance {
  double estimate, log_likelihood, ratio, p;
};

Tolerance tolerance_of(const std::string& where, double rtol) {
  if (where.find("clmm") == std::string::npos) {
    const double r = std::min(rtol, 1e-5);
    return {r, 1e-5, r, r};
  }
  if (where.find("laplace") == std::string::npos) return {1e-3, 2e-8, 2e-8, 1e-8};
  return {1e-3, 2e-4, 2e-4, 5e-5};
}

void expect_ratio(const std::string& where, const Reported& got, const json& expect, const Tolerance& t) {
  if (!oracle::asks(expect, "lrt_method_chi2")) return;
  const int df = static_cast<int>(got.fit.beta.size());
  const auto test = stats::likelihood_ratio(got.fit.log_likelihood, got.reduced, df);
  EXPECT_NEAR(test.chi2, expect["lrt_method_chi2"], t.ratio) << where;
  if (oracle::asks(expect, "lrt_df")) {
    EXPECT_EQ(df, expect["lrt_df"]) << where;
  }
  if (oracle::asks(expect, "lrt_p")) oracle::expect_number(where + " p", test.p, expect["lrt_p"], t.p);
}

void expect_model(const std::string& where, const Reported& got, const json& expect, double rtol) {
  const auto t = tolerance_of(where, rtol);
  const auto se = got.fit.se();
  const std::size_t q = expect.at("thresholds").size();
  for (std::size_t i = 0; i < q; ++i) {
    oracle::expect_number(where + " threshold", got.fit.thresholds.at(i), expect["thresholds"][i],
                          t.estimate);
  }
  for (std::size_t i = 0; i < expect.at("beta").size(); ++i) {
    const double wanted = expect["beta"][i];
    EXPECT_NEAR(got.fit.beta.at(i), wanted,
                std::max(t.estimate * std::abs(wanted), 0.2 * t.estimate * se.at(q + i)))
        << where;
  }
  for (std::size_t i = 0; i < expect.at("se_all").size(); ++i) {
    oracle::expect_number(where + " se", se.at(i), expect["se_all"][i], t.estimate);
  }
  EXPECT_NEAR(got.fit.log_likelihood, expect.at("loglik").get<double>(), t.log_likelihood) << where;
  if (oracle::asks(expect, "sd_participant")) {
    EXPECT_NEAR(got.sd, expect["sd_participant"], std::max(1e-3 * got.sd, 5e-4)) << where;
  }
  expect_ratio(where, got, expect, t);
}

TEST(CumulativeLink, AgreesWithTheReferenceAnswers) {
  for (const auto& item : oracle::cases("ordinal")) {
    const std::string id = item.at("id");
    const auto& expect = item.at("expect");
    if (expect.at("status") != "ok") {
      for (const char* model : {"clm_logit", "clm_probit", "clmm_logit_laplace"}) {
        const auto got = fit_model(model, item.at("input"));
        EXPECT_FALSE(got) << id << ' ' << model;
        EXPECT_FALSE(got.reason().empty()) << id << ' ' << model;
      }
      continue;
    }
    for (const auto& [model, answer] : expect.items()) {
      if (!model.starts_with("clm") || answer.is_null()) continue;
      const std::string where = id + ' ' + model;
      const auto got = fit_model(model, item.at("input"));
      ASSERT_TRUE(got) << where << ": " << got.reason();
      expect_model(where, *got, answer, item.at("rtol"));
      if (oracle::asks(expect, "n_obs")) {
        EXPECT_EQ(got->fit.n, expect["n_obs"]) << where;
      }
      if (oracle::asks(expect, "levels_used")) {
        EXPECT_EQ(got->fit.levels, oracle::numbers(expect["levels_used"])) << where;
      }
    }
  }
}

/// sum log P - u^2 / 2 over one participant's answers, where u is the participant's standard normal effect.
/// Also its slope and minus its second derivative by finite differences. They use the explicit logistic
/// distribution, independently of the library.
struct Person {
  std::vector<double> lower, upper;  ///< thresholds less the fixed location

  double log_joint(double u, double sd) const {
    const auto F = [](double x) { return 1 / (1 + std::exp(-x)); };
    double sum = -u * u / 2;
    for (std::size_t i = 0; i < lower.size(); ++i)
      sum += std::log(F(upper[i] - sd * u) - F(lower[i] - sd * u));
    return sum;
  }
  double slope(double u, double sd) const {
    constexpr double h = 1e-4;
    const auto f = [&](double v) { return log_joint(v, sd); };
    return (8 * (f(u + h) - f(u - h)) - (f(u + 2 * h) - f(u - 2 * h))) / (12 * h);
  }
  double curvature(double u, double sd) const {
    constexpr double h = 1e-3;
    const auto f = [&](double v) { return log_joint(v, sd); };
    return -(16 * (f(u + h) + f(u - h)) - (f(u + 2 * h) + f(u - 2 * h)) - 30 * f(u)) / (12 * h * h);
  }
};

/// Laplace's approximation after `steps` Newton steps from 0. The curvature is that at the end or, if
/// `stale`, that before the last step.
double laplace(const std::vector<Person>& people, double sd, int steps, bool stale) {
  double sum = 0;
  for (const auto& person : people) {
    double u = 0, before = 0;
    for (int i = 0; i < steps; ++i) {
      before = u;
      u += person.slope(u, sd) / person.curvature(u, sd);
    }
    sum += person.log_joint(u, sd) - std::log(person.curvature(stale ? before : u, sd)) / 2;
  }
  return sum;
}

std::vector<Person> people_of(const json& input, const json& at) {
  auto columns = read_columns(input.at("csv"));
  auto levels = columns.at("rating");
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  const auto methods = stats::indicators("method", columns.at("method"), input.at("reference_method"));
  const auto thresholds = oracle::numbers(at.at("thresholds")), beta = oracle::numbers(at.at("beta"));
  std::map<double, Person> people;
  for (std::size_t i = 0; i < columns.at("rating").size(); ++i) {
    double location = 0;
    for (std::size_t k = 0; k < beta.size(); ++k) location += beta[k] * methods[k].values[i];
    const auto level =
        std::lower_bound(levels.begin(), levels.end(), columns.at("rating")[i]) - levels.begin();
    auto& person = people[columns.at("participant")[i]];
    const auto c = static_cast<std::size_t>(level);
    person.lower.push_back(c ? thresholds[c - 1] - location : -1e3);
    person.upper.push_back(c < thresholds.size() ? thresholds[c] - location : 1e3);
  }
  std::vector<Person> out;
  for (auto& [id, person] : people) out.push_back(std::move(person));
  return out;
}

// The reason for the loose tolerance for Laplace: at the reference's own estimates, a curvature from one
// Newton step before the last reproduces its log-likelihood to 1e-6, and the right curvature does not.
TEST(CumulativeLink, TheReferencesLaplaceUsesAStaleCurvature) {
  for (const auto& item : oracle::cases("ordinal")) {
    if (item.at("expect").at("status") != "ok" || !item["expect"].contains("clmm_logit_laplace")) continue;
    const auto& at = item["expect"]["clmm_logit_laplace"];
    const auto people = people_of(item.at("input"), at);
    const double sd = at.at("sd_participant"), theirs = at.at("loglik");
    double nearest = 1;
    for (const int steps : {1, 2, 3, 4, 5})
      nearest = std::min(nearest, std::abs(laplace(people, sd, steps, true) - theirs));
    EXPECT_LT(nearest, 1e-6) << item.at("id");
    const auto ours = fit_model("clmm_logit_laplace", item["input"]);
    EXPECT_NEAR(ours->fit.log_likelihood, laplace(people, sd, 20, false), 1e-6) << item.at("id");
  }
}

// Closed form without predictors: thresholds are quantiles of the cumulative shares.
TEST(CumulativeLink, WithoutPredictorsReturnsTheShares) {
  const std::vector<double> ratings{1, 1, 2, 2, 2, 4, 4, 7, 7, 7};
  const auto fit = fit_cumulative_link(ratings, {}, Link::Logit);
  ASSERT_TRUE(fit) << fit.reason();
  ASSERT_EQ(fit->thresholds.size(), 3u);
  for (const auto& [i, share] : std::map<std::size_t, double>{{0, 0.2}, {1, 0.5}, {2, 0.7}})
    EXPECT_NEAR(fit->thresholds[i], std::log(share / (1 - share)), 1e-9);
  EXPECT_NEAR(fit->log_likelihood, 2 * std::log(.2) + 3 * std::log(.3) + 2 * std::log(.2) + 3 * std::log(.3),
              1e-9);
}

// Two scores and one indicator: beta is the log odds ratio, its variance the sum of reciprocal counts.
TEST(CumulativeLink, OfTwoScoresIsTheLogOddsRatio) {
  std::vector<double> ratings, group;
  const auto add = [&](double score, double g, int times) {
    for (int i = 0; i < times; ++i) {
      ratings.push_back(score);
      group.push_back(g);
    }
  };
  add(1, 0, 12), add(2, 0, 5), add(1, 1, 4), add(2, 1, 9);
  const auto fit = fit_cumulative_link(ratings, std::vector<Predictor>{{"group", group}}, Link::Logit);
  ASSERT_TRUE(fit) << fit.reason();
  EXPECT_NEAR(fit->beta[0], std::log(9.0 * 12 / (4 * 5)), 1e-9);
  EXPECT_NEAR(fit->se()[1], std::sqrt(1. / 12 + 1. / 5 + 1. / 4 + 1. / 9), 1e-9);
}

struct Made {
  std::vector<double> ratings, x;
  std::vector<int> people;
};

/// Nine ratings of each of eight people, higher with x and with the person.
Made made() {
  Made m;
  unsigned state = 12345;
  for (int person = 0; person < 8; ++person) {
    for (int i = 0; i < 9; ++i) {
      state = state * 1664525u + 1013904223u;
      const double noise = 3.0 * (state >> 8) / (1u << 24) - 1.5;
      m.x.push_back(i);
      m.people.push_back(person);
      m.ratings.push_back(std::clamp(std::round(1 + 0.35 * i + 0.4 * (person - 3.5) + noise), 1.0, 5.0));
    }
  }
  return m;
}

TEST(CumulativeLink, OrderShiftAndScaleFollowThrough) {
  const auto m = made();
  const std::size_t n = m.x.size();
  Made other = m;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i * 29) % n;
    other.ratings[i] = 10 * m.ratings[j] + 3;
    other.x[i] = 100 + 1e-3 * m.x[j];
    other.people[i] = 100 - 7 * m.people[j];
  }
  for (const Link link : {Link::Logit, Link::Probit}) {
    const auto one = fit_cumulative_link_mixed(m.ratings, std::vector<Predictor>{{"x", m.x}}, m.people, link);
    const auto two =
        fit_cumulative_link_mixed(other.ratings, std::vector<Predictor>{{"x", other.x}}, other.people, link);
    ASSERT_TRUE(one) << one.reason();
    ASSERT_TRUE(two) << two.reason();
    EXPECT_NEAR(two->beta[0] * 1e-3, one->beta[0], 1e-6);
    EXPECT_NEAR(two->se().back() * 1e-3, one->se().back(), 1e-6);
    EXPECT_NEAR(two->sd_participant, one->sd_participant, 1e-6);
    EXPECT_NEAR(two->log_likelihood, one->log_likelihood, 1e-8);
    EXPECT_EQ(two->levels.front(), 10 * one->levels.front() + 3);
    // With the scale reversed, thresholds and beta change sign.
    std::vector<double> negative;
    for (const double r : other.ratings) negative.push_back(-r);
    const auto turned =
        fit_cumulative_link_mixed(negative, std::vector<Predictor>{{"x", other.x}}, other.people, link);
    EXPECT_NEAR(turned->beta[0], -two->beta[0], 1e-3);
    EXPECT_NEAR(turned->log_likelihood, two->log_likelihood, 1e-8);
  }
}

// More nodes converge to the integral; Laplace has a small error.
TEST(CumulativeLink, QuadratureConverges) {
  const auto m = made();
  const std::vector<Predictor> x{{"x", m.x}};
  const auto fit = [&](int points) {
    return *fit_cumulative_link_mixed(m.ratings, x, m.people, Link::Logit, points);
  };
  const double exact = fit(61).log_likelihood;
  EXPECT_NEAR(fit(15).log_likelihood, exact, 1e-7);
  EXPECT_GT(std::abs(fit(1).log_likelihood - exact), 1e-3);
  EXPECT_NEAR(fit(1).log_likelihood, exact, 0.5);
  // People differ: the fit without their effect is worse.
  EXPECT_LT(fit_cumulative_link(m.ratings, x, Link::Logit)->log_likelihood, exact - 1);
}

TEST(CumulativeLink, DropsAndCountsMissingRows) {
  auto m = made();
  const auto whole = fit_cumulative_link(m.ratings, std::vector<Predictor>{{"x", m.x}});
  m.ratings.push_back(nan);
  m.x.push_back(3);
  m.ratings.push_back(4);
  m.x.push_back(nan);
  const auto fit = fit_cumulative_link(m.ratings, std::vector<Predictor>{{"x", m.x}});
  EXPECT_EQ(fit->n_missing, 2);
  EXPECT_EQ(fit->n, whole->n);
  EXPECT_EQ(fit->beta, whole->beta);
}

void expect_refused(const std::string& words, const std::vector<double>& ratings,
                    const std::vector<Predictor>& predictors, const std::vector<int>& people) {
  for (const Link link : {Link::Logit, Link::Probit}) {
    for (const int points : {0, 1, 15}) {
      const auto reason = points == 0
                              ? fit_cumulative_link(ratings, predictors, link).reason()
                              : fit_cumulative_link_mixed(ratings, predictors, people, link, points).reason();
      EXPECT_NE(reason.find(words), std::string::npos) << link_name(link) << points << ": " << reason;
    }
  }
}

TEST(CumulativeLink, RefusesWithANamedReason) {
  const std::vector<int> two{1, 1, 1, 2, 2, 2};
  expect_refused("no ratings", {}, {}, {});
  expect_refused("no ratings", {nan}, {}, {1});
  expect_refused("all ratings are equal", {4, 4, 4, 4, 4, 4}, {}, two);
  expect_refused("all ratings are equal", {4}, {}, {1});
  expect_refused("method2 is constant", {1, 2, 3, 4, 5, 4}, {{"method2", {0, 0, 0, 0, 0, 0}}}, two);
  expect_refused("combination", {1, 2, 3, 4, 5, 4}, {{"x", {1, 2, 3, 4, 5, 7}}, {"y", {2, 4, 6, 8, 10, 14}}},
                 two);
  expect_refused("infinite", {1, 2, 3, 4, 5, 4},
                 {{"x", {1, 2, 3, 4, 5, std::numeric_limits<double>::infinity()}}}, two);
  // Complete separation, a group with only the highest score, and scores that rise with x without overlap.
  expect_refused("separation", {1, 1, 1, 2, 2, 2}, {{"x", {0, 0, 0, 1, 1, 1}}}, two);
  expect_refused("separation", {1, 3, 2, 3, 3, 3}, {{"x", {0, 0, 0, 1, 1, 1}}}, two);
  expect_refused("by x", {1, 1, 2, 2, 3, 3}, {{"x", {0, 0, 1, 1, 2, 2}}, {"z", {0, 1, 0, 1, 0, 1}}}, two);
}

TEST(CumulativeLink, RefusesSpreadsThatAreNone) {
  const std::vector<double> ratings{1, 2, 3, 2, 3, 1};
  EXPECT_NE(fit_cumulative_link_mixed(ratings, {}, std::vector<int>(6, 1))
                .reason()
                .find("fewer than two participants"),
            std::string::npos);
  EXPECT_NE(fit_cumulative_link_mixed(ratings, {}, std::vector<int>{1, 2, 3, 4, 5, 6})
                .reason()
                .find("one rating from each"),
            std::string::npos);
  // Each person always gives the same score, different from the others'.
  std::vector<double> own;
  std::vector<int> people;
  for (int i = 0; i < 60; ++i) {
    own.push_back(1 + i % 6);
    people.push_back(i % 6);
  }
  const auto fit = fit_cumulative_link_mixed(own, {}, people);
  EXPECT_FALSE(fit);
  EXPECT_FALSE(fit.reason().empty());
  EXPECT_THROW(fit_cumulative_link_mixed(own, {}, people, Link::Logit, 0), std::invalid_argument);
  EXPECT_THROW(fit_cumulative_link(own, std::vector<Predictor>{{"x", {1, 2}}}), std::invalid_argument);
  EXPECT_THROW(stats::likelihood_ratio(1, 0, 0), std::invalid_argument);
}

}  // namespace
