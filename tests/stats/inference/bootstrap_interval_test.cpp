#include "stats/inference/bootstrap_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/quantiles.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using stats::bootstrap_interval;
using Values = std::vector<double>;

stats::Statistic statistic(const std::string& name) {
  const std::map<std::string, stats::Statistic> known{{"mean", stats::mean_statistic()},
                                                      {"median", stats::median_statistic()},
                                                      {"var", stats::variance_statistic()},
                                                      {"dz", stats::dz_statistic()}};
  return known.at(name);
}

std::vector<int> indices(const std::string& file) {
  std::ifstream in(oracle::folder() / file);
  if (!in)
    throw std::runtime_error("cannot read the oracle's " + file +
                             "; mend: restore it, or unset VIP_ORACLE_DIR");
  std::vector<int> out;
  for (std::string line, cell; std::getline(in, line);) {
    std::istringstream cells(line);
    while (std::getline(cells, cell, ',')) out.push_back(std::stoi(cell));
  }
  return out;
}

void expect_pair(const json& c, const std::string& field, const std::array<double, 2>& got) {
  if (!oracle::asks(c.at("expect"), field)) return;
  for (std::size_t end = 0; end < 2; ++end)
    oracle::expect_number(c.at("id").get<std::string>() + ": " + field, got[end],
                          c.at("expect").at(field).at(end), c.at("rtol"));
}

void expect_strict(const json& c, const std::optional<stats::BcaInterval>& strict) {
  oracle::expect_field(c, "z0_strict", strict ? std::optional(strict->z0) : std::nullopt);
  if (!strict) return;
  expect_pair(c, "bca_probs_strict", strict->probabilities);
  expect_pair(c, "bca_type7_strict", strict->ci);
  expect_pair(c, "bca_bootci", strict->ci_normal);
}

/// The library's own resamples reproduce the ends of the intervals within 4 % of their width, the tolerance
/// of oracle/README.md.
void expect_many_resamples(const json& c, const Values& x, const stats::Statistic& of, double confidence) {
  const auto got = bootstrap_interval(x, of, {.resamples = 50'000, .seed = 2, .confidence = confidence});
  ASSERT_TRUE(got) << got.reason();
  const auto& want = c.at("expect").at("large_B_50000");
  const auto near = [&](const char* field, const std::array<double, 2>& ci) {
    if (!want.contains(field)) return;
    const double low = want.at(field).at(0), high = want.at(field).at(1);
    EXPECT_NEAR(ci[0], low, 0.04 * (high - low)) << c.at("id") << ": " << field;
    EXPECT_NEAR(ci[1], high, 0.04 * (high - low)) << c.at("id") << ": " << field;
  };
  near("bca", got->bca.ci_normal);
  near("perc", got->percentile);
  near("basic", got->basic);
  if (want.contains("se")) {
    EXPECT_NEAR(got->se / want.at("se").get<double>(), 1, 0.04) << c.at("id");
  }
  // The reference counts a resample equal to the estimate as half below it. The standard error of z0 is
  // 0.006.
  if (want.contains("z0")) {
    EXPECT_NEAR(got->bca.z0, want.at("z0").get<double>(), 0.04) << c.at("id");
  }
}

TEST(BootstrapInterval, AgreesWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("bootstrap")) {
    const auto& input = c.at("input");
    const Values x = oracle::numbers(input.at("x"));
    const auto of = statistic(input.at("statistic"));
    const double confidence = input.at("conf");
    if (oracle::is_undefined(c)) {
      oracle::expect_refused(c, bootstrap_interval(x, of, {.confidence = confidence}));
      continue;
    }
    const auto got = bootstrap_interval(x, of, indices(input.at("index_csv_zero_based")), confidence);
    ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
    oracle::expect_known_fields(
        c, {"t0", "boot_mean", "boot_se", "accel_jackknife", "z0_half_ties", "z0_strict", "bca_probs_half",
            "bca_type7_half", "bca_probs_strict", "bca_type7_strict", "bca_bootci", "perc_type7",
            "perc_type6", "large_B_50000"});
    oracle::expect_field(c, "t0", got->estimate);
    oracle::expect_field(c, "boot_mean", got->mean);
    oracle::expect_field(c, "boot_se", got->se);
    oracle::expect_field(c, "accel_jackknife", got->acceleration);
    oracle::expect_field(c, "z0_half_ties", got->bca.z0);
    expect_pair(c, "bca_probs_half", got->bca.probabilities);
    expect_pair(c, "bca_type7_half", got->bca.ci);
    expect_strict(c, got->bca_strict);
    expect_pair(c, "perc_type7", got->percentile);
    expect_pair(c, "perc_type6", got->percentile_type6);
    if (oracle::asks(c.at("expect"), "large_B_50000")) expect_many_resamples(c, x, of, confidence);
  }
}

/// Skewed to the right, with mean 1.
Values exponential(int n, uniformity::Draws& draws) {
  Values out;
  for (int i = 0; i < n; ++i) out.push_back(-std::log(draws.uniform()));
  return out;
}

TEST(BootstrapInterval, SameSeedSameInterval) {
  uniformity::Draws draws(1);
  const Values x = exponential(20, draws);
  const auto of = [&](std::uint64_t seed) {
    return bootstrap_interval(x, stats::mean_statistic(), {.resamples = 500, .seed = seed})->bca.ci;
  };
  EXPECT_EQ(of(7), of(7));
  EXPECT_NE(of(7), of(8));
}

TEST(BootstrapInterval, ShiftScaleAndReflectionCarryThrough) {
  uniformity::Draws draws(2);
  const Values x = exponential(18, draws);
  std::vector<int> drawn;
  for (int i = 0; i < 18 * 400; ++i) drawn.push_back(static_cast<int>(draws.uniform() * 18));
  const auto base = bootstrap_interval(x, stats::median_statistic(), drawn);
  Values moved = x, turned = x;
  for (double& v : moved) v = 3 * v + 10;
  for (double& v : turned) v = -v;
  const auto other = bootstrap_interval(moved, stats::median_statistic(), drawn);
  const auto mirror = bootstrap_interval(turned, stats::median_statistic(), drawn);
  for (std::size_t end = 0; end < 2; ++end) {
    EXPECT_NEAR(other->bca.ci[end], 3 * base->bca.ci[end] + 10, 1e-11);
    EXPECT_NEAR(other->basic[end], 3 * base->basic[end] + 10, 1e-11);
    EXPECT_NEAR(mirror->bca.ci[end], -base->bca.ci[1 - end], 1e-9);
    EXPECT_NEAR(mirror->percentile[end], -base->percentile[1 - end], 1e-11);
  }
  EXPECT_NEAR(mirror->acceleration, -base->acceleration, 1e-14);
}

TEST(BootstrapInterval, BcaFollowsAMonotoneTransformation) {
  // The defining property of BCa: with the same resamples, the interval of log(mean) is the log of the
  // interval of the mean, up to the acceleration, which the jackknife estimates on another scale.
  uniformity::Draws draws(3);
  const Values x = exponential(40, draws);
  const auto plain = bootstrap_interval(x, stats::mean_statistic(), {.resamples = 4000});
  const auto logs = bootstrap_interval(
      x, [](std::span<const double> v) { return std::log(stats::mean_statistic()(v)); }, {.resamples = 4000});
  EXPECT_DOUBLE_EQ(plain->bca.z0, logs->bca.z0);
  const double width = plain->bca.ci[1] - plain->bca.ci[0];
  for (std::size_t end = 0; end < 2; ++end) {
    EXPECT_NEAR(std::exp(logs->bca.ci[end]), plain->bca.ci[end], 0.05 * width);
    EXPECT_NEAR(std::exp(logs->percentile[end]), plain->percentile[end], 1e-4);
  }
}

TEST(BootstrapInterval, BcaCoversASkewedMeanBetterThanPercentiles) {
  uniformity::Draws draws(4);
  int bca = 0, percentile = 0;
  constexpr int studies = 1000;
  const auto covers = [](const std::array<double, 2>& ci) { return ci[0] <= 1 && 1 <= ci[1]; };
  for (int study = 0; study < studies; ++study) {
    const auto got = bootstrap_interval(exponential(26, draws), stats::mean_statistic(),
                                        {.resamples = 999, .seed = static_cast<std::uint64_t>(study)});
    bca += covers(got->bca.ci);
    percentile += covers(got->percentile);
  }
  // 26 exponential values: published coverage of BCa about .92 to .93, of percentiles about .91.
  EXPECT_GT(bca, percentile);
  EXPECT_GT(bca, 0.90 * studies);
  EXPECT_LT(bca, 0.96 * studies);
}

TEST(BootstrapInterval, CoarseRatingsCountTiesHalf) {
  // The median of resampled whole ratings often equals the estimate.
  const auto got = bootstrap_interval(Values{3, 3, 4, 4, 4, 5, 5, 5, 6, 6}, stats::median_statistic());
  ASSERT_TRUE(got) << got.reason();
  EXPECT_LT(std::abs(got->bca.z0), 0.1) << "the sample is symmetric";
  ASSERT_TRUE(got->bca_strict);
  EXPECT_LT(got->bca_strict->z0, -0.2);
  EXPECT_EQ(got->estimate, 4.5);
  EXPECT_LT(got->bca.ci[0], 4.5);
  EXPECT_GT(got->bca.ci[1], 4.5);
}

TEST(BootstrapInterval, MissingValuesAreDroppedAndCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto got = bootstrap_interval(Values{1, nan, 2, 4, nan, 3, 6, 5}, stats::mean_statistic());
  ASSERT_TRUE(got);
  EXPECT_EQ(got->n, 6);
  EXPECT_EQ(got->n_missing, 2);
  EXPECT_EQ(got->bca.ci, bootstrap_interval(Values{1, 2, 4, 3, 6, 5}, stats::mean_statistic())->bca.ci);
}

// A bootstrap interval lies within the range of the n values. That range holds the centre of a symmetric
// distribution with probability 1 - 2^(1 - n).
TEST(BootstrapInterval, TooFewValuesForTheLevelAreRefusedInWords) {
  const Values x{1, 4, 2, 7, 3, 9};
  for (std::size_t n = 2; n <= 5; ++n) {
    const auto refused = bootstrap_interval(std::span(x).first(n), stats::mean_statistic());
    const std::string start = std::to_string(n) +
                              " values are too few: an interval within their range holds at "
                              "most ";
    EXPECT_EQ(refused.reason().substr(0, start.size()), start) << refused.reason();
  }
  EXPECT_EQ(bootstrap_interval(std::span(x).first(5), stats::mean_statistic()).reason(),
            "5 values are too few: an interval within their range holds at most 93.75 %, not 95 %");
  EXPECT_TRUE(bootstrap_interval(x, stats::mean_statistic()));
  EXPECT_TRUE(bootstrap_interval(std::span(x).first(5), stats::mean_statistic(), {.confidence = 0.9}));
}

TEST(BootstrapInterval, RefusesWhatHasNoInterval) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Values& x : {Values{}, Values{4}, Values{4, nan}, Values{4, 4, 4, 4}, Values{1, 2, inf}})
    EXPECT_NE(bootstrap_interval(x, stats::mean_statistic()).reason(), "") << x.size();
  EXPECT_NE(bootstrap_interval(Values{1, 2, 3, 4, 5, 6}, [](auto) { return 5.0; }).reason(), "")
      << "a statistic that nothing changes";
  EXPECT_NE(bootstrap_interval(Values{3, 4, 4, 4, 4, 4, 5}, stats::median_statistic()).reason(), "")
      << "without any one value the median is the same: no acceleration";
  EXPECT_NE(bootstrap_interval(Values{1, 2}, stats::dz_statistic(), {.confidence = 0.5}).reason(), "")
      << "a single value has no standard deviation";
  EXPECT_NE(bootstrap_interval(Values{1, 2, 3}, stats::dz_statistic(), {.confidence = 0.5}).reason(), "")
      << "a resample of one value three times has none either";
  EXPECT_THROW(bootstrap_interval(Values{1, 2}, stats::mean_statistic(), {.confidence = 1}),
               std::invalid_argument);
  EXPECT_THROW(bootstrap_interval(Values{1, 2}, stats::mean_statistic(), {.resamples = 1}),
               std::invalid_argument);
  EXPECT_THROW(bootstrap_interval(Values{1, 2}, stats::mean_statistic(), std::vector<int>{0, 1, 2, 0}, 0.5),
               std::invalid_argument);
  EXPECT_THROW(bootstrap_interval(Values{1, 2}, stats::mean_statistic(), std::vector<int>{0, 1, 1}, 0.5),
               std::invalid_argument);
}

}  // namespace
