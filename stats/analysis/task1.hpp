#pragma once
/// Task 1 (ratings): summaries of each method's scores, comparisons of all pairs of methods within each n_*
/// (nominal number of particles), and omnibus tests.

#include <optional>
#include <string>
#include <vector>

#include "stats/analysis/mixed_scores.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/inference/bootstrap_interval.hpp"
#include "stats/inference/describe.hpp"
#include "stats/inference/equivalence.hpp"
#include "stats/inference/friedman.hpp"
#include "stats/inference/normality.hpp"
#include "stats/inference/repeated_anova.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/inference/unanimous.hpp"
#include "stats/inference/wilcoxon.hpp"
#include "stats/result.hpp"

namespace stats {

/// One box of the box plots (ViP-Fluid paper, Fig. 9). Indices are those of the ScoreTable.
struct MethodCell {
  int n_star = 0, method = 0;
  std::vector<double> values;    ///< participants' means, without missing ones
  std::vector<double> outliers;  ///< values more than 1.5 interquartile ranges from the box: drawn in the
                                 ///< plot and included in all statistics
  Result<Description> summary = Refusal{"not computed"};
  Result<BoxPlot> box = Refusal{"not computed"};
  Result<OneSampleTTest> mean = Refusal{"not computed"};  ///< t test against 0, for the interval of the mean
  Result<BootstrapInterval> bootstrap = Refusal{"not computed"};
  Result<ShapiroWilk> normality = Refusal{"not computed"};
};

/// Comparison of two methods at one n_* (nominal number of particles): difference a - b over participants who
/// judged both.
struct MethodComparison {
  int n_star = 0, a = 0, b = 0;
  std::size_t n = 0;                     ///< participants who judged both methods
  std::size_t n_missing = 0;             ///< participants who judged only one of them
  std::optional<double> mean_a, mean_b;  ///< means of the participants with both methods
  Result<PairedTTest> t = Refusal{"not computed"};
  std::optional<Unanimous> unanimous;  ///< set if all differences are equal: the exact test that replaces `t`
  Result<IndependentTTest> welch = Refusal{"not computed"};  ///< treats the pairs as independent groups
  Result<SignedRank> wilcoxon = Refusal{"not computed"};
  Result<EquivalenceTest> equivalence = Refusal{"not computed"};
  Result<ShapiroWilk> normality = Refusal{"not computed"};        ///< test of the differences' normality
  Result<BootstrapInterval> bootstrap = Refusal{"not computed"};  ///< interval of the mean difference
  Result<MixedContrast> mixed = Refusal{"not computed"};          ///< difference by the mixed model of all
                                                                  ///< answers
  /// p of `t`, or of the exact sign test that replaces it.
  std::optional<double> p() const;
  /// Corrected over the pairs of this score and n_*; a refused test counts as not significant.
  std::optional<double> p_holm, p_bh, wilcoxon_p_holm, wilcoxon_p_bh, mixed_p_holm, mixed_p_bh;
};

/// Numbers of participants in the comparisons at one n_* (nominal number of particles).
struct PairPeople {
  int n_star = 0;
  std::size_t planned = 0;           ///< participants with a planned trial of any method
  std::size_t any = 0, all = 0;      ///< participants who judged any method, and every method
  std::size_t fewest = 0, most = 0;  ///< smallest and largest number with both methods of a pair
  bool differ = false;               ///< true if a participant counts in one pair and not in another
};

struct Omnibus {
  int n_star = 0;
  int n = 0;             ///< participants with all methods
  int n_incomplete = 0;  ///< participants who judged some methods, but not all
  Result<Friedman> friedman = Refusal{"not computed"};
  Result<RepeatedAnova> anova = Refusal{"not computed"};
};

struct ScoreAnalysis {
  std::vector<MethodCell> cells;              ///< ordered by n_* (number of particles), then by method
  std::vector<MethodComparison> comparisons;  ///< ordered by n_*, then by pair, a before b
  std::vector<Omnibus> omnibus;
  std::vector<PairPeople> people;  ///< ordered by n_*
  Result<MixedScores> mixed = Refusal{"not computed"};
};

ScoreAnalysis analyse_scores(const ScoreTable& table, const AnalysisPlan& plan);

/// Values of the participants with both methods; x[i] and y[i] are of one participant.
struct PairedValues {
  std::vector<double> x, y;
  std::vector<double> differences() const;
};
PairedValues complete_pairs(std::span<const double> x, std::span<const double> y);

}  // namespace stats
