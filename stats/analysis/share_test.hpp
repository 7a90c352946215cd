#pragma once
/// A preference that people answered about more than once: each person's share of one of the two, against one
/// half. Answers of one person need not be independent.

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

/// For print, as "exact binomial test".
inline constexpr const char* share_test_name = "exact permutation test of people's shares";

struct ShareTest {
  int participants = 0;
  double share = 0.5;  ///< mean of the shares
  std::array<double, 2>
      ci{};             ///< Student's t of the shares, within 0 to 1; Clopper-Pearson where all chose alike
  std::string ci_name;  ///< which of them, for print
  double p = 1;         ///< exact
};

/// The permutation test that turns each person's share less one half round: exact, and the exact binomial
/// test where everybody answered once. Refused: nobody, and numbers of answers whose common denominator is
/// too large.
Result<ShareTest> share_test(std::span<const PersonChoices> people, Alternative alternative,
                             double confidence);

}  // namespace stats
