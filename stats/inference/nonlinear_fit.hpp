#pragma once
/// Nonlinear least squares that does not believe the solver's word.

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// Residuals model - observed and their derivatives. Both write into the span given; they must not throw, and
/// may give values that are not finite outside the model's domain.
struct NonlinearModel {
  std::size_t n_parameters = 0, n_points = 0;
  /// (parameters, residuals[n_points])
  std::function<void(std::span<const double>, std::span<double>)> residuals;
  /// (parameters, jacobian[n_points * n_parameters], row by row)
  std::function<void(std::span<const double>, std::span<double>)> jacobian;
};

struct NonlinearFit {
  std::vector<double> parameters;
  std::vector<double> standard_errors;  ///< empty without a degree of freedom
  double rss = 0;
  double df = 0;
  std::optional<double> residual_sd;
  double relative_offset = 0;  ///< tangential over total length of the residuals (Bates and Watts 1981)
  std::size_t runs = 0;        ///< solver runs from this start
};

/// From one start: the trust-region methods of GSL (Levenberg-Marquardt, with acceleration, dogleg, double
/// dogleg, subspace) under three scalings each; the least sum of squares at which the residuals are
/// orthogonal to the tangent plane wins, and is then polished by Gauss-Newton steps. A minimum may be local:
/// give several starts. std::invalid_argument when the sizes do not fit. Refused: fewer points than
/// parameters, residuals not finite at the start, no convergence.
Result<NonlinearFit> fit_nonlinear(const NonlinearModel& model, std::span<const double> start);
/// The best over several starts.
Result<NonlinearFit> fit_nonlinear(const NonlinearModel& model, std::span<const std::vector<double>> starts);

}  // namespace stats
