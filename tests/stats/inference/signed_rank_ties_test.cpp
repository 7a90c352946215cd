/// The signed-rank test of differences with ties and zeros, held to every sign and every sample.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "stats/inference/wilcoxon.hpp"

namespace {

using stats::signed_rank;
using Values = std::vector<double>;

/// Sizes of the groups of equal |d|, in ascending order: bit i of `pattern` parts values i and i + 1.
Values tied_magnitudes(int n, std::size_t pattern) {
  Values out;
  double value = 1;
  for (int i = 0; i < n; ++i) {
    out.push_back(value);
    value += static_cast<double>(pattern >> i & 1);
  }
  return out;
}

/// Twice the midranks of ascending values, by counting.
std::vector<int> twice_midranks(const Values& ascending) {
  std::vector<int> out;
  for (const double value : ascending) {
    const auto below = std::count_if(ascending.begin(), ascending.end(), [&](double v) { return v < value; });
    const auto equal = std::count(ascending.begin(), ascending.end(), value);
    out.push_back(static_cast<int>(2 * below + equal + 1));
  }
  return out;
}

/// How many of the 2^n signs give each twice the sum of positive ranks.
std::vector<int> counts_of_sums(const std::vector<int>& twice) {
  std::vector<int> sums{0};
  for (const int rank : twice) {
    const auto half = sums.size();
    for (std::size_t i = 0; i < half; ++i) sums.push_back(sums[i] + rank);
  }
  std::vector<int> counts(static_cast<std::size_t>(sums.back()) + 1, 0);
  for (const int sum : sums) ++counts[static_cast<std::size_t>(sum)];
  return counts;
}

TEST(SignedRankTies, ThePReportedIsThatOfAllSignsWhateverTheTies) {
  std::mt19937_64 random(5);
  for (int n = 1; n <= 12; ++n) {
    for (std::size_t pattern = 0; pattern < (std::size_t{1} << (n - 1)); ++pattern) {
      const auto magnitudes = tied_magnitudes(n, pattern);
      const auto twice = twice_midranks(magnitudes);
      const auto counts = counts_of_sums(twice);
      for (int signs = 0; signs < 3; ++signs) {
        // All of one sign, then any; some zeros, which are dropped.
        Values d(static_cast<std::size_t>(signs), 0.0);
        std::size_t sum = 0;
        for (std::size_t i = 0; i < magnitudes.size(); ++i) {
          const bool positive = signs == 0 || random() % 2 == 0;
          d.push_back(positive ? magnitudes[i] : -magnitudes[i]);
          if (positive) sum += static_cast<std::size_t>(twice[i]);
        }
        int lower = 0, upper = 0;
        for (std::size_t i = 0; i < counts.size(); ++i) {
          lower += i <= sum ? counts[i] : 0;
          upper += i >= sum ? counts[i] : 0;
        }
        const auto got = signed_rank(d);
        ASSERT_TRUE(got);
        ASSERT_NEAR(got->p(), std::min(1.0, std::ldexp(2.0 * std::min(lower, upper), -n)), 1e-14)
            << n << " differences, ties " << pattern;
      }
    }
  }
  EXPECT_EQ(signed_rank(Values{1, 1, 2, 2, 3})->p(), 0.0625) << "no smaller one exists for five differences";
}

/// Number of orders of a sample with these counts.
double orders(const std::vector<int>& counts) {
  double log = 0;
  int n = 0;
  for (const int count : counts) {
    n += count;
    log -= std::lgamma(count + 1);
  }
  return std::exp(log + std::lgamma(n + 1));
}

// Every sample of -2, -1, 0, 1, 2 with symmetric chances: ties and zeros in nearly all of them.
TEST(SignedRankTies, TheIntervalHoldsTheCentreOfTiedValuesAtLeastAsOftenAsItsLevelSays) {
  for (const auto& chances : {std::vector{0.1, 0.2, 0.4, 0.2, 0.1}, std::vector{0.3, 0.2, 0.0, 0.2, 0.3},
                              std::vector{0.05, 0.05, 0.8, 0.05, 0.05}}) {
    for (const int n : {5, 6, 8, 10}) {
      double held = 0, all = 0, level = 1;
      std::vector<int> counts(5, 0);
      const std::function<void(std::size_t, int)> each = [&](std::size_t at, int left) {
        if (at + 1 < counts.size()) {
          for (counts[at] = 0; counts[at] <= left; ++counts[at]) each(at + 1, left - counts[at]);
          return;
        }
        counts[at] = left;
        Values d;
        double chance = orders(counts);
        for (std::size_t i = 0; i < counts.size(); ++i) {
          chance *= std::pow(chances[i], counts[i]);
          d.insert(d.end(), static_cast<std::size_t>(counts[i]), static_cast<double>(i) - 2);
        }
        all += chance;
        const auto got = signed_rank(d);
        if (!got) {  // all zero: the interval would be [0, 0]
          held += chance;
          return;
        }
        level = got->hodges_lehmann_level;
        held += (*got->hodges_lehmann_ci)[0] <= 0 && 0 <= (*got->hodges_lehmann_ci)[1] ? chance : 0;
      };
      each(0, n);
      EXPECT_NEAR(all, 1, 1e-12);
      EXPECT_GE(held, level - 1e-12) << n;
    }
  }
}

}  // namespace
