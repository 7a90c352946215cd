#pragma once
/// What every ordinal fit starts from: whole rows, numbered categories, predictors of mean 0 and sd 1.

#include <span>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"

namespace stats {

struct OrdinalRows {
  std::vector<double> levels;
  std::vector<int> category;           ///< index into levels, for each row
  std::vector<int> participant;        ///< 0, 1, ... ; empty without participants
  std::vector<std::vector<double>> x;  ///< standardised columns
  std::vector<double> centre, scale;   ///< of the columns
  int participants = 0;
  int n_missing = 0;

  std::size_t n() const { return category.size(); }
  int thresholds() const { return static_cast<int>(levels.size()) - 1; }
  /// x beta of the standardised columns.
  std::vector<double> location(std::span<const double> beta) const;
};

/// Refusals of fit_cumulative_link but separation.
Result<OrdinalRows> ordinal_rows(std::span<const double> ratings, std::span<const Predictor> predictors,
                                 std::span<const int> participants);

/// Thresholds of the ratings without predictors: link_quantile of the cumulative shares.
std::vector<double> marginal_thresholds(std::span<const int> category, int levels, Link link);

/// Thresholds, beta and covariance for the predictors' own units; `parameters` and `covariance` hold
/// thresholds and beta of the standardised ones.
void set_original_units(OrdinalFit& fit, const OrdinalRows& rows, std::span<const double> parameters,
                        std::span<const double> covariance);

}  // namespace stats
