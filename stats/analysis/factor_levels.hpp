#pragma once
/// Effects of one factor: compares two of its levels over treatments that differ in that factor alone, pooled
/// over the other factors within each participant.

#include <optional>
#include <span>
#include <vector>

#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/inference/unanimous.hpp"
#include "stats/result.hpp"

namespace stats {

/// Position of a treatment in a factorial design: its level of the factor, and the index of its combination
/// of all other factors. ScoreTable and PairChoice call a treatment a method.
struct FactorPlace {
  int level = 0, rest = 0;
};

/// Task 2 (choices between two treatments): preference for level a over level b, from pairs that differ only
/// in the factor.
struct LevelPreference {
  int a = 0, b = 0;
  int n = 0, k = 0;  ///< answers, and how many of them chose a
  int participants = 0;
  /// t test of each participant's share of choices of a against one half.
  Result<OneSampleTTest> shares = Refusal{"not computed"};
  /// Set if all shares are equal, which leaves no t: the exact sign test that replaces the t test.
  std::optional<Unanimous> all_alike;
  std::optional<double> p_holm;  ///< p after Holm over the pairs of levels of the factor

  std::optional<double> p() const;
};

/// Task 1 (ratings): mean score of level a minus that of level b at one n_* (nominal number of particles).
struct LevelDifference {
  int n_star = 0, a = 0, b = 0;
  std::size_t participants = 0;  ///< participants who judged all treatments of both levels
  /// t test against zero of each participant's difference, averaged over the other factors.
  Result<OneSampleTTest> difference = Refusal{"not computed"};
  std::optional<Unanimous> all_alike;
  std::optional<double> p_holm;  ///< p after Holm over the pairs of levels at this n_*

  std::optional<double> p() const;
};

/// Compares every pair of levels, a before b. `places` has one entry for each treatment.
std::vector<LevelPreference> level_preferences(std::span<const PairChoice> choices,
                                               std::span<const FactorPlace> places, int levels,
                                               const AnalysisPlan& plan);
std::vector<LevelDifference> level_differences(const ScoreTable& table, std::span<const FactorPlace> places,
                                               int levels, const AnalysisPlan& plan);

}  // namespace stats
