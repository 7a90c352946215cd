#pragma once
/// The tests of H1 to H3. Each compares two methods at one size n_* of the water, by a paired t test (an
/// exact sign test if all differences are equal) or by the mixed model.

#include <optional>
#include <string>

#include "stats/analysis/hypothesis_family.hpp"
#include "stats/analysis/mixed_scores.hpp"
#include "stats/inference/alternative.hpp"
#include "stats/inference/unanimous.hpp"

namespace stats {

/// a - b with its standard error.
struct ScoreDifference {
  double estimate = 0, se = 0, df = 0;
  double t(double null = 0) const { return (estimate - null) / se; }
  double p(Alternative side, double null = 0) const;
};

/// The input of a test.
struct ScoreContrast {
  HypothesisTest test;  ///< fields that need no difference, and the reason if there is none
  std::optional<ScoreDifference> difference;
  std::optional<Unanimous> unanimous;  ///< if all paired differences are equal: the exact sign test
  bool higher_is_better = true;
  double margin = 0;
};

/// `model`: the mixed model of all answers of the table; null: paired test.
ScoreContrast score_contrast(const ScoreTable& table, const Result<MixedScores>* model, int n_star,
                             const std::string& a, const std::string& b);

/// Tests the claim that a is better than b.
FamilyTest superiority(ScoreContrast contrast, const Family& family);
/// Tests the claim that a and b differ by less than the margin: two one-sided tests.
FamilyTest equivalence(ScoreContrast contrast, const Family& family);
/// Tests the claim that a is not worse than b by the margin.
FamilyTest non_inferiority(ScoreContrast contrast, const Family& family);

}  // namespace stats
