#include "stats/inference/unanimous.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace {

using stats::Alternative;
using stats::unanimous;
using Values = std::vector<double>;

/// The permutation test by enumeration: share of all signs of n equal values with sums at least as extreme as
/// the observed one.
double by_enumeration(double value, int n, Alternative side) {
  const double seen = value * n;
  int as_far = 0;
  for (int signs = 0; signs < 1 << n; ++signs) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += signs >> i & 1 ? value : -value;
    as_far += side == Alternative::Greater ? sum >= seen
              : side == Alternative::Less  ? sum <= seen
                                           : std::abs(sum) >= std::abs(seen);
  }
  return std::ldexp(as_far, -n);
}

TEST(Unanimous, IsThePermutationTestOfEqualValues) {
  for (const double value : {-2.0, 0.0, 0.5}) {
    for (const int n : {2, 3, 7, 10}) {
      const auto all = unanimous(Values(static_cast<std::size_t>(n), value));
      ASSERT_TRUE(all);
      for (const auto side : {Alternative::TwoSided, Alternative::Less, Alternative::Greater})
        EXPECT_EQ(all->p(side), by_enumeration(value, n, side)) << value << ", " << n;
    }
  }
}

TEST(Unanimous, TestsAgainstAnyNull) {
  const auto all = unanimous(Values(8, 0.25));
  EXPECT_EQ(all->p(Alternative::Greater, -0.5), std::ldexp(1, -8));
  EXPECT_EQ(all->p(Alternative::Less, 0.5), std::ldexp(1, -8));
  EXPECT_EQ(all->p(Alternative::Less, -0.5), 1);
  EXPECT_EQ(all->p(Alternative::TwoSided, 0.25), 1);
}

TEST(Unanimous, OnlyWhereAllAgreeAndNobodyIsAlone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(unanimous(Values{1, 1, 2}));
  EXPECT_FALSE(unanimous(Values{1}));
  EXPECT_FALSE(unanimous(Values{1, nan}));
  EXPECT_EQ(unanimous(Values{1, nan, 1})->n, 2u);
  // Means of thirds: equal as fractions, but not as doubles.
  const std::vector<stats::ExactMean> x{{3, 3}, {4, 3}}, y{{2, 3}, {6, 6}};
  const auto exact = stats::exact_differences(x, y);
  EXPECT_EQ(unanimous(*exact)->value, 1 / 3.0);
}

}  // namespace
