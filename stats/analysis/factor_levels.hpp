#pragma once
/// What a level of one factor is worth over another, the other factors alike: treatments that differ in that
/// factor alone, pooled over the rest within each participant.

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

/// A treatment (what tables and choices call a method) as levels of one factor and of the others together.
struct FactorPlace {
  int level = 0, rest = 0;
};

/// Task 2: level a over level b, from pairs that differ in nothing else.
struct LevelPreference {
  int a = 0, b = 0;
  int n = 0, k = 0;  ///< answers, and those of them that chose a
  int participants = 0;
  /// Of each participant's share of choosing a, against one half.
  Result<OneSampleTTest> shares = Refusal{"not computed"};
  std::optional<Unanimous> all_alike;  ///< every participant has the same share: tested in place of t
  std::optional<double> p_holm;        ///< over the pairs of levels of the factor

  std::optional<double> p() const;
};

/// Task 1: mean score of level a less that of level b at one n_*.
struct LevelDifference {
  int n_star = 0, a = 0, b = 0;
  std::size_t participants = 0;  ///< who judged all treatments of both levels
  /// Of each participant's difference, averaged over the other factors, against nought.
  Result<OneSampleTTest> difference = Refusal{"not computed"};
  std::optional<Unanimous> all_alike;
  std::optional<double> p_holm;  ///< over the pairs of levels at this n_*

  std::optional<double> p() const;
};

/// places: of each treatment. Every pair of levels, a before b.
std::vector<LevelPreference> level_preferences(std::span<const PairChoice> choices,
                                               std::span<const FactorPlace> places, int levels,
                                               const AnalysisPlan& plan);
std::vector<LevelDifference> level_differences(const ScoreTable& table, std::span<const FactorPlace> places,
                                               int levels, const AnalysisPlan& plan);

}  // namespace stats
