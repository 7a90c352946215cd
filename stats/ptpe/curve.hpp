#pragma once
/// The threshold curve mu(delta) = a exp(b delta): the mean frame rate mu that is just satisfactory at a
/// standard deviation delta of the frame rate. This header also has the curve's intervals and bands over
/// participants.

#include <array>
#include <span>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// The threshold curve as log mu(delta) = log a + b delta, where mu is the just satisfactory mean frame rate
/// at a standard deviation delta of the frame rate.
struct Curve {
  double log_a = 0, b = 0;  ///< a in frames/s, b in s/frame

  double a() const;
  double mu(double delta) const;
};

/// The threshold frame rate mu(delta) at a standard deviation delta, with intervals for it, all in frames/s.
struct BandPoint {
  double delta = 0, mu = 0;
  std::array<double, 2> pointwise{};     ///< covers the true mu(delta) at this delta
  std::array<double, 2> simultaneous{};  ///< covers the whole true curve at once
};

/// A curve with its uncertainty by the jackknife over participants (Tukey 1958), which leaves out each
/// participant in turn.
struct CurveSpread {
  Curve curve;
  double var_log_a = 0, cov = 0, var_b = 0;
  int participants = 0;
  double confidence = 0.95;
  std::array<double, 2> a_ci{}, b_ci{};  ///< exp(log a -+ t se), b -+ t se with participants - 1 df

  double a_se() const;  ///< standard error of a: a times the standard error of log a
  double b_se() const;
  /// The band of the threshold frame rate at one standard deviation delta. The pointwise interval uses
  /// Student's t; the simultaneous one, after Working and Hotelling (1929), uses Hotelling's T^2 for the two
  /// coefficients.
  BandPoint band(double delta) const;
  /// Largest half width of the pointwise band over `deltas`, as a share of mu(delta): the relative
  /// uncertainty of the threshold frame rate.
  double largest_relative_half_width(std::span<const double> deltas) const;
};

/// Jackknife over participants: from the estimate with all participants, and the estimates that leave out one
/// participant each. Needs at least four participants (std::invalid_argument). `confidence` in (0, 1).
CurveSpread jackknife_curve(const Curve& estimate, std::span<const Curve> without_one, double confidence);

/// (n-1)/n sum (x_i - mean)(y_i - mean): the jackknife's covariance of two estimates, where x_i and y_i are
/// the estimates without participant i of n.
double jackknife_covariance(std::span<const double> x, std::span<const double> y);

}  // namespace stats
