/// Simulated pilots of people with contours of their own: coverage of the intervals of
/// stats/ptpe/people_fit.hpp, and whose error is smaller: the person's pooled curve, the curve by the
/// person's answers alone, or the population's. docs/statistics.md has the results. VIP_STUDIES sets the
/// number of studies of each cell.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/people_fit.hpp"
#include "stats/quantiles.hpp"

namespace {

using stats::Curve;
using stats::PilotMean;
using stats::PilotRating;

constexpr std::array<double, 5> shown_deltas{0, 5, 10, 15, 20};

struct World {
  double a = 24, b = 0.02, sd_log_a = 0.15, sd_b = 0.005, correlation = -0.3;
  double slope = 3.4, lapse = 0.02;  ///< scores for each unit of log mu; the noise of an answer is 1 score
  /// People judge by frames/s: score 4 + 0.14 (mu - a exp(b delta)) + taste, SD of the taste 0.14 a sd_log_a.
  bool parametric = false;
};

struct Study {
  std::vector<PilotRating> ratings;
  std::vector<std::array<double, 5>> log_mu;  ///< each person's true contour at shown_deltas
  std::vector<Curve> truth;
};

double normal(std::mt19937_64& engine) { return std::normal_distribution<double>()(engine); }
double uniform(std::mt19937_64& engine, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(engine);
}

/// The paper's 21 settings, each `repeats` times, in an order of each person's own.
Study simulate(const World& world, int people, int repeats, std::mt19937_64& engine) {
  Study study;
  for (int p = 0; p < people; ++p) {
    const double z = normal(engine), other = normal(engine), r = world.correlation;
    const Curve own{std::log(world.a) + world.sd_log_a * z,
                    world.b + world.sd_b * (r * z + std::sqrt(1 - r * r) * other)};
    const auto contour = [&](double delta) {
      return world.parametric
                 ? std::log(std::max(world.a * (std::exp(world.b * delta) + world.sd_log_a * z), 1.0))
                 : own.log_a + own.b * delta;
    };
    study.truth.push_back(world.parametric ? Curve{contour(0), (contour(20) - contour(0)) / 20} : own);
    study.log_mu.emplace_back();
    for (std::size_t i = 0; i < shown_deltas.size(); ++i) study.log_mu.back()[i] = contour(shown_deltas[i]);
    std::vector<std::array<double, 2>> order;
    for (int k = 0; k < repeats; ++k)
      for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0})
        for (const double delta : shown_deltas)
          if (delta < mu) order.push_back({mu, delta});
    std::shuffle(order.begin(), order.end(), engine);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto [mu, delta] = order[i];
      const double location = world.parametric ? 0.14 * (mu - std::exp(contour(delta)))
                                               : world.slope * (std::log(mu) - contour(delta));
      double score = std::clamp(std::round(4 + location + normal(engine)), 1.0, 7.0);
      if (uniform(engine, 0, 1) < world.lapse) score = 1 + std::floor(uniform(engine, 0, 7));
      study.ratings.push_back({p, mu, delta, mu, mu, delta, score, static_cast<int>(i)});
    }
  }
  return study;
}

/// Mean squared differences of log mu from the truth over shown_deltas.
double error_of(const Curve& curve, const std::array<double, 5>& truth) {
  double out = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    out +=
        std::pow(curve.log_a + curve.b * shown_deltas[i] - truth[i], 2) / static_cast<double>(truth.size());
  return out;
}

struct Mean {
  double sum = 0, n = 0;
  void add(double value) {
    sum += value;
    n += 1;
  }
  double operator()() const { return n > 0 ? sum / n : NAN; }
  double root() const { return std::sqrt((*this)()); }
};

/// Squared errors of log a (names ending in _a) and of log mu, as means over people.
struct Errors {
  Mean pooled_a, alone_a, plane_a, population_a, pooled, alone, population;
};

struct Tally {
  int studies = 0, refused = 0;
  Mean a, b, bias_a, bias_b, sd_log_a, sd_b, person_a, person_b, person_a_half, person_b_half, person_band,
      no_alone, doubt, share;
  Errors all;
  std::array<Errors, 4> by_share;  ///< own share below .3, .5, .7 and above
  std::array<int, 10> ranks_a{}, ranks_b{};

  void add(const World& world, const Study& study, const stats::PeopleFit& fit);
  void print(const char* what) const;
};

bool within(const std::array<double, 2>& ends, double value) { return ends[0] <= value && value <= ends[1]; }

void Tally::add(const World& world, const Study& study, const stats::PeopleFit& fit) {
  a.add(within(fit.population.a_ci, world.a));
  b.add(within(fit.population.b_ci, world.b));
  bias_a.add(fit.population.curve.log_a - std::log(world.a));
  bias_b.add(fit.population.curve.b - world.b);
  sd_log_a.add(fit.sd_log_a.value);
  sd_b.add(fit.sd_b.value);
  for (const auto& one : fit.people) {
    const auto p = static_cast<std::size_t>(one.participant);
    const Curve& truth = study.truth[p];
    const auto& own = one.pooled;
    const double z_a = (truth.log_a - own.curve.log_a) / std::sqrt(own.var_log_a),
                 z_b = (truth.b - own.curve.b) / std::sqrt(own.var_b), middle = stats::normal_quantile(0.75);
    person_a.add(within(one.a_ci, truth.a()));
    person_b.add(within(one.b_ci, truth.b));
    person_a_half.add(std::abs(z_a) < middle);
    person_b_half.add(std::abs(z_b) < middle);
    for (std::size_t i = 0; i < shown_deltas.size(); ++i)
      person_band.add(within(one.band(shown_deltas[i], 0.95), std::exp(study.log_mu[p][i])));
    const auto bin = [](double z) {
      return static_cast<std::size_t>(std::min(9.0, 10 * stats::normal_probability(z)));
    };
    ++ranks_a[bin(z_a)];
    ++ranks_b[bin(z_b)];
    no_alone.add(!one.alone);
    doubt.add(!one.doubt().empty());
    share.add(one.own_share);
    std::vector<PilotRating> ratings;
    for (const auto& r : study.ratings)
      if (r.participant == one.participant) ratings.push_back(r);
    const auto observations = stats::PilotTable(ratings).observations(PilotMean::Harmonic);
    const auto plane = stats::DirectModel(observations, 4).fit_straight();
    const std::size_t bucket = one.own_share < 0.3   ? 0
                               : one.own_share < 0.5 ? 1
                               : one.own_share < 0.7 ? 2
                                                     : 3;
    for (Errors* errors : {&all, &by_share[bucket]}) {
      errors->pooled_a.add(std::pow(own.curve.log_a - truth.log_a, 2));
      errors->population_a.add(std::pow(fit.population.curve.log_a - truth.log_a, 2));
      if (one.alone) errors->alone_a.add(std::pow(one.alone->curve.log_a - truth.log_a, 2));
      if (plane) errors->plane_a.add(std::pow(plane->curve.log_a - truth.log_a, 2));
      errors->pooled.add(error_of(own.curve, study.log_mu[p]));
      errors->population.add(error_of(fit.population.curve, study.log_mu[p]));
      if (one.alone) errors->alone.add(error_of(one.alone->curve, study.log_mu[p]));
    }
  }
}

void Tally::print(const char* what) const {
  std::printf(
      "%s: %d studies, refused %d; holds a %.3f b %.3f; bias of log a %.3f, of b %.4f; SDs %.3f %.4f\n"
      "  people: 95 %% holds a %.3f b %.3f curve %.3f; 50 %% a %.3f b %.3f; no alone %.3f; doubt %.3f; own "
      "%.2f\n",
      what, studies, refused, a(), b(), bias_a(), bias_b(), sd_log_a(), sd_b(), person_a(), person_b(),
      person_band(), person_a_half(), person_b_half(), no_alone(), doubt(), share());
  const auto line = [](const char* name, const Errors& e) {
    std::printf(
        "  %s (%.0f people): log a pooled %.4f alone %.4f plane %.4f population %.4f; log mu pooled %.4f "
        "alone "
        "%.4f population %.4f\n",
        name, e.pooled_a.n, e.pooled_a.root(), e.alone_a.root(), e.plane_a.root(), e.population_a.root(),
        e.pooled.root(), e.alone.root(), e.population.root());
  };
  line("all", all);
  for (std::size_t i = 0; i < by_share.size(); ++i)
    line(std::array{"own < .3", "own < .5", "own < .7", "own above"}[i], by_share[i]);
  std::printf("  ranks of a:");
  for (const int n : ranks_a) std::printf(" %d", n);
  std::printf("; of b:");
  for (const int n : ranks_b) std::printf(" %d", n);
  std::printf("\n");
  std::fflush(stdout);
}

int studies_of(int usual) {
  const char* given = std::getenv("VIP_STUDIES");
  return given ? std::atoi(given) : usual;
}

template <class Draw>
Tally run(int people, int repeats, int studies, std::uint64_t seed, Draw world_of) {
  Tally out;
  out.studies = studies;
  std::mt19937_64 engine(seed);
  for (int i = 0; i < studies; ++i) {
    const World world = world_of(engine);
    const auto study = simulate(world, people, repeats, engine);
    const auto fit = stats::fit_people(study.ratings, PilotMean::Harmonic, 4);
    out.refused += !fit;
    if (fit) out.add(world, study, *fit);
  }
  return out;
}

struct Cell {
  int people, repeats;
};
class PeopleRecoverySlow : public testing::TestWithParam<Cell> {};

std::string named(const char* what, const Cell& cell) {
  return std::string(what) + ", " + std::to_string(cell.people) + " people x " + std::to_string(cell.repeats);
}

/// `share` of n draws; true if it is not further below `least` than chance explains (3 standard errors).
bool at_least(const Mean& share, double least) {
  return share() >= least - 3 * std::sqrt(least * (1 - least) / share.n);
}

TEST_P(PeopleRecoverySlow, IntervalsHoldAndPoolingHasTheSmallestError) {
  for (const double spread : {0.15, 0.05}) {
    World world;
    world.sd_log_a = spread;
    world.sd_b = spread / 30;
    const auto tally = run(GetParam().people, GetParam().repeats, studies_of(10), 7,
                           [&](std::mt19937_64&) { return world; });
    tally.print(named(spread > 0.1 ? "SD .15, .005" : "SD .05, .0017", GetParam()).c_str());
    EXPECT_LE(tally.refused, tally.studies / 20);
    EXPECT_TRUE(at_least(tally.a, 0.93));
    EXPECT_TRUE(at_least(tally.b, 0.93));
    EXPECT_LT(tally.all.pooled_a(), tally.all.alone_a());
    EXPECT_LT(tally.all.pooled_a(), 1.5 * tally.all.population_a());
    if (spread > 0.1) {
      EXPECT_LT(tally.all.pooled_a(), tally.all.population_a());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, PeopleRecoverySlow,
                         testing::Values(Cell{12, 1}, Cell{24, 1}, Cell{12, 2}, Cell{24, 2}, Cell{12, 4},
                                         Cell{24, 4}));

/// Truths are drawn anew for each study. The place of a person's true value in the person's distribution is
/// then uniform.
TEST(PeopleCalibrationSlow, PeopleAreWhereTheirIntervalsSay) {
  const auto tally = run(16, 1, studies_of(20), 5, [](std::mt19937_64& engine) {
    World world;
    world.a = uniform(engine, 18, 30);
    world.b = uniform(engine, 0.01, 0.03);
    world.sd_log_a = uniform(engine, 0.05, 0.35);
    world.sd_b = uniform(engine, 0.002, 0.015);
    world.correlation = uniform(engine, -0.7, 0.7);
    world.slope = uniform(engine, 2.5, 4.5);
    world.lapse = uniform(engine, 0, 0.06);
    return world;
  });
  tally.print("drawn truths, 16 people x 1");
  EXPECT_TRUE(at_least(tally.person_a, 0.9));
  EXPECT_TRUE(at_least(tally.person_b, 0.9));
  EXPECT_NEAR(tally.person_a_half(), 0.5, 0.1);
  EXPECT_NEAR(tally.person_b_half(), 0.5, 0.12);
}

TEST(PeopleCalibrationSlow, PeopleWhoJudgeByFramesASecond) {
  World world;
  world.parametric = true;
  const auto tally = run(16, 1, studies_of(20), 6, [&](std::mt19937_64&) { return world; });
  tally.print("parametric observer, 16 people x 1");
  EXPECT_TRUE(at_least(tally.person_band, 0.88));
  EXPECT_LT(tally.all.pooled(), tally.all.population());
}

}  // namespace
