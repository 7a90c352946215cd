#pragma once
/// Test of a preference that people answered more than once: each person's share of choices of one method
/// against one half. Answers of one person need not be independent.

#include <array>
#include <span>
#include <string>

#include "stats/inference/alternative.hpp"
#include "stats/result.hpp"

namespace stats {

/// Answers of one person, n > 0, of which k chose the method in question.
struct PersonChoices {
  int k = 0, n = 0;
};

/// Name for display, like "exact binomial test".
inline constexpr const char* share_test_name = "exact permutation test of people's shares";

struct ShareTest {
  int participants = 0;
  double share = 0.5;          ///< mean of the shares
  std::array<double, 2> ci{};  ///< Student's t of the shares, within 0 to 1; Clopper-Pearson if all always
                               ///< chose alike; [0, 1] if the shares are equal otherwise
  std::string ci_name;         ///< which interval it is, for display
  double p = 1;                ///< exact
};

/// The exact permutation test that flips the sign of each person's share minus one half. It equals the exact
/// binomial test if everybody answered once. Refused: no people, and counts of answers whose common
/// denominator is too large.
Result<ShareTest> share_test(std::span<const PersonChoices> people, Alternative alternative,
                             double confidence);

}  // namespace stats
