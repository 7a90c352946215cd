#pragma once
/// Input of every ordinal fit: complete rows, numbered categories, predictors with mean 0 and sd 1.

#include <span>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"

namespace stats {

struct OrdinalRows {
  std::vector<double> levels;
  std::vector<int> category;           ///< index into levels, for each row
  std::vector<int> participant;        ///< 0, 1, ... ; empty without participants
  std::vector<std::vector<double>> x;  ///< standardised columns
  std::vector<double> centre, scale;   ///< mean and sd of each column before it was standardised
  int participants = 0;
  int n_missing = 0;

  std::size_t n() const { return category.size(); }
  int thresholds() const { return static_cast<int>(levels.size()) - 1; }
  /// x beta of the standardised columns.
  std::vector<double> location(std::span<const double> beta) const;
};

/// Selects the rows without a NaN, numbers their categories and standardises the predictors. Refused as
/// fit_cumulative_link(), except for separation.
Result<OrdinalRows> ordinal_rows(std::span<const double> ratings, std::span<const Predictor> predictors,
                                 std::span<const int> participants);

/// Thresholds of the ratings without predictors: link_quantile of the cumulative shares.
std::vector<double> marginal_thresholds(std::span<const int> category, int levels, Link link);

/// Sets thresholds, beta and covariance in the predictors' original units; `parameters` and `covariance` hold
/// thresholds and beta for the standardised predictors.
void set_original_units(OrdinalFit& fit, const OrdinalRows& rows, std::span<const double> parameters,
                        std::span<const double> covariance);

}  // namespace stats
