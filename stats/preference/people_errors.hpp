#pragma once
/// Errors that allow for dependence between the answers of one person.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/preference/logit_fit.hpp"
#include "stats/preference/trials.hpp"
#include "stats/result.hpp"

namespace stats {

/// A covariance of coefficients and the distribution that goes with its errors.
struct CoefficientErrors {
  std::vector<double> covariance;  ///< coefficients by coefficients, row after row
  std::optional<double> df;        ///< Student's t; empty: normal

  double variance(std::size_t i, std::size_t j, std::size_t size) const { return covariance[i * size + j]; }
  double quantile(double confidence) const;  ///< two-sided
  double p(double t) const;                  ///< two-sided
};

/// Errors as if answers were independent: the inverse information.
CoefficientErrors independent_errors(const LogitFit& fit);

/// The sandwich estimator with each person's answers as a cluster (Liang and Zeger 1986), times people /
/// (people - 1), with Student's t of people - 1 degrees of freedom. `rows` as they were fitted, one for each
/// of `trials`. Refused: no more people than coefficients, since their answers then do not span the
/// coefficients; people whose answers leave a coefficient without error.
Result<CoefficientErrors> people_errors(const LogitFit& fit, std::span<const LogitRow> rows,
                                        std::span<const Comparison> trials);

}  // namespace stats
