/// The signed-rank test of differences with ties and zeros, against all signs and all samples.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "stats/inference/wilcoxon.hpp"

namespace {

using stats::signed_rank;
using Values = std::vector<double>;

/// Ascending |d| with ties: bit i of `pattern` separates values i and i + 1.
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

/// The rank sums of all 2^n choices of signs, listed one by one.
struct AllSigns {
  explicit AllSigns(const std::vector<int>& twice_ranks) : sums{0} {
    for (const int rank : twice_ranks) {
      const auto half = sums.size();
      for (std::size_t i = 0; i < half; ++i) sums.push_back(sums[i] + rank);
    }
    at_most.assign(static_cast<std::size_t>(sums.back()) + 1, 0);
    for (const int sum : sums) ++at_most[static_cast<std::size_t>(sum)];
    for (std::size_t i = 1; i < at_most.size(); ++i) at_most[i] += at_most[i - 1];
  }
  /// Shares of the signs whose sum is at most, and at least, the sum of `signs`.
  double lower(std::size_t signs) const { return share(at_most[place(signs)]); }
  double upper(std::size_t signs) const {
    const auto at = place(signs);
    return share(at_most.back() - (at > 0 ? at_most[at - 1] : 0));
  }
  double two_sided(std::size_t signs) const {
    return std::min(1.0, 2 * std::min(lower(signs), upper(signs)));
  }

  std::vector<int> sums;  ///< twice the sum of positive ranks; bit i of the index: value i is positive

 private:
  std::size_t place(std::size_t signs) const { return static_cast<std::size_t>(sums[signs]); }
  double share(int count) const { return static_cast<double>(count) / static_cast<double>(sums.size()); }
  std::vector<int> at_most;
};

/// One choice of signs for each sum of positive ranks that can occur.
std::vector<std::size_t> one_of_each_sum(const AllSigns& all) {
  std::vector<std::size_t> out;
  std::vector<bool> seen(static_cast<std::size_t>(all.sums.back()) + 1);
  for (std::size_t signs = 0; signs < all.sums.size(); ++signs) {
    const auto sum = static_cast<std::size_t>(all.sums[signs]);
    if (!seen[sum]) out.push_back(signs);
    seen[sum] = true;
  }
  return out;
}

/// Tests every sum of positive ranks that n differences with these ties can have, with 0 to 3 zeros in turn.
void expect_exact(int n, std::size_t pattern) {
  constexpr std::size_t most_zeros = 3;
  const auto magnitudes = tied_magnitudes(n, pattern);
  const auto twice = twice_midranks(magnitudes);
  const AllSigns all(twice);
  std::vector<AllSigns> with_zeros;  // Pratt: the zeros take the lowest ranks
  for (std::size_t zeros = 0; zeros <= most_zeros; ++zeros) {
    auto higher = twice;
    for (int& rank : higher) rank += 2 * static_cast<int>(zeros);
    with_zeros.emplace_back(higher);
  }
  std::size_t zeros = pattern % (most_zeros + 1);
  for (const std::size_t signs : one_of_each_sum(all)) {
    Values d(zeros, 0.0);
    for (std::size_t i = 0; i < magnitudes.size(); ++i)
      d.push_back(signs >> i & 1 ? magnitudes[i] : -magnitudes[i]);
    const auto got = signed_rank(d);
    ASSERT_TRUE(got);
    const auto where = ::testing::Message() << n << " differences, ties " << pattern << ", signs " << signs;
    ASSERT_NEAR(got->p(), all.two_sided(signs), 1e-14) << where;
    ASSERT_NEAR(*got->p_exact_less, all.lower(signs), 1e-14) << where;
    ASSERT_NEAR(*got->p_exact_greater, all.upper(signs), 1e-14) << where;
    ASSERT_NEAR(*got->pratt_p_exact, with_zeros[zeros].two_sided(signs), 1e-14) << where << ", " << zeros;
    zeros = (zeros + 1) % (most_zeros + 1);
  }
}

/// Tests all 2^(n - 1) patterns of ties of n magnitudes.
void expect_exact_whatever_the_ties(int n) {
  for (std::size_t pattern = 0; pattern < (std::size_t{1} << (n - 1)); ++pattern) expect_exact(n, pattern);
}

TEST(SignedRankTies, ThePReportedIsThatOfAllSignsWhateverTheTies) {
  for (int n = 1; n <= 9; ++n) expect_exact_whatever_the_ties(n);
  EXPECT_EQ(signed_rank(Values{1, 1, 2, 2, 3})->p(), 0.0625) << "no smaller one exists for five differences";
}

TEST(SignedRankTiesSlow, ThePReportedIsThatOfAllSignsUpTo12Differences) {
  for (int n = 10; n <= 12; ++n) expect_exact_whatever_the_ties(n);
}

/// Number of different orders of a sample that has each value as often as `counts` says.
double orders(const std::vector<int>& counts) {
  double log = 0;
  int n = 0;
  for (const int count : counts) {
    n += count;
    log -= std::lgamma(count + 1);
  }
  return std::exp(log + std::lgamma(n + 1));
}

// Every sample of -2, -1, 0, 1, 2 with symmetric probabilities: nearly all have ties and zeros.
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
