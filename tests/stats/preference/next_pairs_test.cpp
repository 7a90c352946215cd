/// The pairs that tell most: against the mutual information summed over a grid.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "stats/preference/next_pairs.hpp"
#include "stats/preference/quality_scale.hpp"
#include "stats/quantiles.hpp"

namespace {

double entropy_bits(double p) {
  return p <= 0 || p >= 1 ? 0 : -p * std::log2(p) - (1 - p) * std::log2(1 - p);
}

/// Mutual information of an answer to a pair and two independent values, over a grid of both.
double grid_information(double mean_i, double sd_i, double mean_j, double sd_j) {
  double weights = 0, p_all = 0, within = 0;
  for (double a = -7; a <= 7; a += 0.05) {
    for (double b = -7; b <= 7; b += 0.05) {
      const double weight = std::exp(-(a * a + b * b) / 2);
      const double p = stats::normal_probability((mean_i + sd_i * a - mean_j - sd_j * b) / stats::jod_sigma);
      weights += weight;
      p_all += weight * p;
      within += weight * entropy_bits(p);
    }
  }
  return entropy_bits(p_all / weights) - within / weights;
}

TEST(NextPairs, GainIsTheMutualInformation) {
  const std::vector<double> jod{0.2, -1.1, 2.0}, sd{0.7, 1.3, 0.4};
  std::vector<double> covariance(9, 0.0);
  for (std::size_t i = 0; i < 3; ++i) covariance[i * 4] = sd[i] * sd[i];
  double most = 0;
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}})
    most = std::max(most, grid_information(jod[i], sd[i], jod[j], sd[j]));
  const auto next = stats::next_pairs(jod, covariance, 1);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].first, 0);
  EXPECT_EQ(next[0].second, 1);
  EXPECT_NEAR(next[0].bits, most, 1e-9);
}

TEST(NextPairs, ABatchGoesOnToOtherPairs) {
  // Four equal conditions: after a pair is chosen, a pair that shares no condition with it tells more.
  std::vector<double> covariance(16, 0.0);
  for (std::size_t i = 0; i < 4; ++i) covariance[i * 5] = 4;
  const auto next = stats::next_pairs(std::vector<double>(4, 0.0), covariance, 2);
  EXPECT_EQ(next[0].first + next[0].second, 1);
  EXPECT_EQ(next[1].first + next[1].second, 5);
  EXPECT_LE(next[1].bits, next[0].bits);
  EXPECT_TRUE(stats::next_pairs(std::vector<double>(4, 0.0), covariance, 0).empty());
  EXPECT_THROW(stats::next_pairs(std::vector<double>(3, 0.0), covariance, 1), std::invalid_argument);
}

/// Root mean square error of a scale of eight conditions after `answers` answers to pairs that `choose`
/// gives.
template <class Choose>
double error_after(int answers, std::uint64_t seed, Choose choose) {
  std::uint64_t state = 0x9E3779B97F4A7C15ull * (seed + 1);
  const auto uniform = [&] {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (static_cast<double>(state >> 11) + 0.5) * 0x1.0p-53;
  };
  for (int i = 0; i < 50; ++i) uniform();
  const int n = 8;
  std::vector<double> truth;
  for (int i = 0; i < n; ++i) truth.push_back(1.2 * i - 4.2);
  stats::ScaleData data{.conditions = n, .pairs = {}, .ratings = {}, .people_known = false};
  const auto ask = [&](int a, int b) {
    const double p = stats::normal_probability(
        (truth[static_cast<std::size_t>(a)] - truth[static_cast<std::size_t>(b)]) / stats::jod_sigma);
    const bool first = uniform() < p;
    data.pairs.push_back({0, a, b, first ? 1.0 : 0.0, first ? 0.0 : 1.0});
  };
  for (int i = 0; i < n; ++i) ask(i, (i + 3) % n);
  const auto fit = [&] { return stats::quality_scale(data, {.prior = stats::ScalePrior::Normal}).value(); };
  while (static_cast<int>(data.pairs.size()) < answers) {
    const auto [a, b] = choose(fit(), uniform);
    ask(a, b);
  }
  const auto scale = fit();
  double sum = 0;
  for (std::size_t i = 0; i < 8; ++i) sum += (scale.jod[i] - truth[i]) * (scale.jod[i] - truth[i]);
  return std::sqrt(sum / n);
}

TEST(NextPairsSlow, NeedFewerAnswersThanRandomPairs) {
  const auto active = [](const stats::QualityScale& scale, const auto&) {
    const auto next = stats::next_pairs(scale.jod, scale.model_covariance, 1);
    return std::pair{next[0].first, next[0].second};
  };
  const auto random = [](const stats::QualityScale&, const auto& uniform) {
    const int a = static_cast<int>(8 * uniform()), b = static_cast<int>(7 * uniform());
    return std::pair{a, b < a ? b : b + 1};
  };
  double with = 0, without = 0, twice = 0;
  const int studies = 200;
  for (int s = 0; s < studies; ++s) {
    const auto seed = static_cast<std::uint64_t>(s);
    with += error_after(84, seed, active) / studies;
    without += error_after(84, seed, random) / studies;
    twice += error_after(168, seed, random) / studies;
  }
  std::printf("error: 84 active %.3f, 84 random %.3f, 168 random %.3f\n", with, without, twice);
  EXPECT_LT(with, 0.85 * without);
}

}  // namespace
