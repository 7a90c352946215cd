#pragma once
/// Test that the threshold frame rate mu is an exponential of the frame rate's standard deviation delta: log
/// mu = log a + b delta is tested against a curve with one more parameter c.
///
///   log mu(delta) = log a + b delta + c (e^2 - 1/2),   e = (delta - middle) / half
///
/// where middle and half are the middle and half width of the range of the nominal standard deviations that
/// the test uses: 10 and 10 for 0 to 20 frames/s. At c > 0 the curve lies c / 2 above an exponential at both
/// ends, as a share of mu, and c / 2 below it in the middle. At c < 0 it levels off.

#include <array>
#include <span>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// The threshold frame rate mu at a standard deviation delta: log mu(delta) = level + slope e + bend e^2,
/// with the jackknife's covariance of the three coefficients.
struct FreeCurve {
  double middle = 10, half = 10;       ///< frames/s; e = (delta - middle) / half has no unit
  std::array<double, 3> at{};          ///< level, slope, bend
  std::array<double, 9> covariance{};  ///< covariance of `at`, row-major
  int participants = 0;
  double confidence = 0.95;

  double mu(double delta) const;
  /// The band at one delta: pointwise with Student's t, simultaneous with Hotelling's T^2 for the three
  /// coefficients.
  BandPoint band(double delta) const;
};

/// The test of c = 0, where c is the coefficient `bend` of FreeCurve: with c = 0 the threshold frame rate is
/// an exponential of the frame rate's standard deviation. Jackknife over participants with Student's t.
struct FormTest {
  double c = 0, se = 0, t = 0;
  int df = 0;
  double p = 1;                ///< two-sided
  std::array<double, 2> ci{};  ///< interval of c with the confidence `curve.confidence`
  double detectable = 0;  ///< the smallest |c| that this test detects with form_power if `se` is its standard
                          ///< error
  FreeCurve curve;

  bool rejected() const;
};

/// Two-sided level of the test, and the power of FormTest::detectable.
inline constexpr double form_level = 0.05;
inline constexpr double form_power = 0.80;

/// Settings whose frame rate times this factor is below the curve are excluded from the test. Near the bottom
/// of the scale the scores level off, and a surface fitted to them has a bent curve, so the test would reject
/// true exponentials too often.
inline constexpr double far_below_factor = 2.46;

/// Least squares of ratings as for the direct estimate, E[score] = level + k u + m u e + q u^2. Here u is log
/// mu minus log mu(delta) of the free curve, e is delta scaled to -1 .. 1 as in FreeCurve, and k, m and q are
/// coefficients. `observations` must be within reach (direct_fit.hpp); `curve` is the direct estimate.
/// Excludes settings far below the curve, and standard deviations at which the curve lies above the frame
/// rates shown. Refused: fewer than least_participants; fewer than three standard deviations left; settings
/// that do not determine the surface; scores that do not rise with the frame rate along the curve, for all
/// participants or without one of them; participants whose estimates are all equal.
Result<FormTest> form_test(std::span<const PilotObservation> observations, const Curve& curve, double level,
                           double confidence);

}  // namespace stats
