#pragma once
/// Least squares of y = a exp(b x), the form of the threshold curve (ViP-Fluid paper, Eq. 11: mu = a exp(b
/// delta)).

#include <array>
#include <optional>
#include <span>

#include "stats/result.hpp"

namespace stats {

/// Covariance of (a, b).
struct ExponentialCovariance {
  double aa = 0, ab = 0, bb = 0;
};

struct ExponentialFit {
  double a = 0, b = 0;
  int n = 0;       ///< pairs used
  double rss = 0;  ///< weighted residual sum of squares
  /// Empty with two pairs, which leave no degree of freedom.
  std::optional<ExponentialCovariance> covariance;
  /// 1 - rss / total sum of squares; empty with weights or when all y are equal.
  std::optional<double> r2;

  int df() const { return n - 2; }
  double value(double x) const;
};

/// Global minimum over a and b with the trust-region solver of GSL (gsl_multifit_nlinear,
/// Levenberg-Marquardt, analytic Jacobian) from several starts on centred and scaled data. The smallest
/// residual sum of squares is taken, but only if the residuals are orthogonal to the tangent plane (Bates and
/// Watts 1981, relative offset), since the driver may report success elsewhere. Pairs with a NaN in x, y or
/// weights are dropped. x, y and weights (empty = all 1) have equal length (std::invalid_argument). Refused:
/// fewer than two pairs, infinite values, a weight that is not positive, all x equal, all y zero, no finite
/// minimum, no convergence, a result beyond the range of double.
Result<ExponentialFit> fit_exponential(std::span<const double> x, std::span<const double> y,
                                       std::span<const double> weights = {});

/// Profile-likelihood intervals of a and b (Bates and Watts 1988, section 6.1). An interval ends where the
/// least sum of squares, with the parameter fixed at that value, exceeds the minimum by t^2 rss / df. An end
/// that is never reached is infinite.
struct ExponentialProfile {
  std::array<double, 2> a{}, b{};
};
/// Intervals around the fit_exponential() of the same data, at confidence `level`. Refused as
/// fit_exponential; also with two pairs or zero residuals.
Result<ExponentialProfile> profile_exponential(std::span<const double> x, std::span<const double> y,
                                               std::span<const double> weights = {}, double level = 0.95);

}  // namespace stats
