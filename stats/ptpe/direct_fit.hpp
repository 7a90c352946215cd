#pragma once
/// The direct estimate of the curve mu = a exp(b delta) of mean frame rates mu over standard deviations delta
/// (curve.hpp): a and b are fitted directly to the ratings, without the contour of their means.
///
///   E[score] = level + k u + m u delta + q u^2,   u = log mu - log a - b delta
///
/// is the general quadratic in (log mu, delta) whose contour at `level` is mu = a exp(b delta) exactly: m
/// lets the slope of the score change along the curve, q lets it change across the curve. m = q = 0 is the
/// straight form, a plane in (log mu, delta).

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ptpe/curve.hpp"
#include "stats/ptpe/form_test.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/ptpe/term_sums.hpp"
#include "stats/result.hpp"

namespace stats {

/// The unit in which the fits measure delta, the standard deviation of the frame rate, in frames/s. With it
/// every coefficient is of order 1.
constexpr double delta_unit = 10;

struct DirectFit {
  Curve curve;
  double level = 4;
  double k = 0;  ///< rise of the score with log mu, the log of the mean frame rate, on the curve at delta = 0
  double m = 0;  ///< change of k with delta, per frame/s
  double q = 0;  ///< coefficient of (log mu - log mu(delta))^2, mu(delta) being the curve
  double rss = 0;
  double n = 0;  ///< sum of the weights of the observations

  double score(double mu, double delta) const;
};

/// Least squares with any weights of the participants, from sums of monomials that are computed once.
class DirectModel {
 public:
  /// `observations`: those of PilotTable::observations(); every mu > 0 (std::invalid_argument).
  DirectModel(std::span<const PilotObservation> observations, double level);

  int participants() const { return static_cast<int>(sums_.size()); }

  /// Least squares: the smallest minimum that the Levenberg-Marquardt method reaches from several starts.
  /// With `start`, an estimate from the same ratings with other weights, it starts from `start` and from the
  /// straight form only. The fitted surface may equal the level on two lines; the curve is the line at which
  /// the score rises with mu. Refused: settings that do not determine the surface; scores that are equal or
  /// do not depend on the mean frame rate; scores that do not rise with the frame rate all along the curve; a
  /// curve outside the settings shown ("no contour").
  Result<DirectFit> fit(std::span<const double> weights = {}, const DirectFit* start = nullptr) const;

  /// Fits the straight form m = q = 0, a plane: ordinary least squares of the score on the log of the mean
  /// frame rate and on the standard deviation.
  Result<DirectFit> fit_straight(std::span<const double> weights = {}) const;

 private:
  static constexpr std::size_t terms = 6;  ///< 1, x, d, x d, x^2, d^2 with centred x = log mu and d = delta /
                                           ///< delta_unit
  using Sums = TermSums<terms>;
  struct Place;
  Sums weighted(std::span<const double> weights) const;
  std::optional<Place> straight(const Sums& sums) const;
  static Refusal no_slope(const Sums& sums, const std::string& surface);
  Result<DirectFit> checked(const Sums& sums, const Place& at) const;
  Result<DirectFit> described(const Sums& sums, const Place& at) const;

  std::vector<Sums> sums_;
  double level_;
  double log_mu_centre_ = 0, delta_centre_ = 0;
  std::array<double, 2> log_mu_range_{}, delta_range_{};  ///< smallest and largest value
};

/// Test of m = q = 0, the coefficients of DirectFit by which the slope of the score changes along and across
/// the curve. It decides if the straight form, a plane in (log mu, delta), may be used: Hotelling's T^2 of
/// (m, q) with the jackknife's covariance over participants.
struct LackOfFit {
  double m = 0, q = 0;
  double f = 0;  ///< T^2 (n-2) / (2 (n-1)), F(2, n-2) under the null
  int df1 = 2, df2 = 0;
  double p = 1;
};

/// The direct estimate with its uncertainty over participants and its tests. A setting is a pair of nominal
/// mean mu and standard deviation delta of the frame rate.
struct DirectEstimate {
  Result<DirectFit> fit = Refusal{"not computed"};
  std::vector<double> out_of_reach;  ///< nominal deltas whose settings are excluded, ascending
  int far_above = 0;  ///< number of further settings excluded: their mu is above far_factor times the curve
  int in_reach = 0;   ///< number of nominal deltas at which the curve is within reach_margin
  Result<CurveSpread> jackknife = Refusal{"not computed"};  ///< the recommended intervals
                                                            ///< (docs/statistics.md)
  Result<PilotSpread> bootstrap = Refusal{"not computed"};
  Result<LackOfFit> lack_of_fit = Refusal{"not computed"};
  Result<FormTest> form =
      Refusal{"not computed"};  ///< test that the curve is an exponential (form_test.hpp); where the
                                ///< exponential has no fit, from the straight form's curve
  Result<DirectFit> straight = Refusal{"not computed"};
  Result<CurveSpread> straight_jackknife = Refusal{"not computed"};

  /// The nominal deltas of `deltas` (ascending) that are not out_of_reach. At the excluded deltas the curve
  /// is extrapolated.
  std::vector<double> in_reach_of(std::span<const double> deltas) const;
};

/// A curve is within reach at a delta (standard deviation of the frame rate) if it lies at most this factor
/// above the highest or below the lowest frame rate shown. Without the margin, chance would decide if a curve
/// that passes through the outermost frame rate is within reach.
inline constexpr double reach_margin = 1.15;
/// Settings whose mean frame rate is above this multiple of the curve are excluded. Near the top of the scale
/// the scores level off, and a quadratic fitted to these scores misses the level. In simulated pilots with a
/// = 18 frames/s and b = 0.01 s/frame the bias of a was -1.4 frames/s with and -0.5 without these settings
/// (docs/statistics.md).
inline constexpr double far_factor = 2.46;

/// The settings that within_reach() keeps, and what it excludes.
struct Reach {
  std::vector<PilotObservation> kept;
  std::vector<double> left_out;  ///< nominal deltas, ascending
  int in_reach = 0;              ///< number of nominal deltas at which the curve is within reach_margin
  int far_above = 0;             ///< number of settings above far_factor times the curve
};

/// Selects the settings that determine the curve. At a delta (standard deviation of the frame rate) where the
/// curve fitted to all settings lies outside the frame rates shown by more than reach_margin, the settings do
/// not determine the curve and only bias it: with them the intervals held b in 67 % of simulated pilots with
/// a = 31 frames/s, b = 0.035 s/frame (docs/statistics.md). Such deltas are excluded. If fewer than three
/// deltas are within reach, those with the smallest distance between curve and frame rates are kept as well,
/// to make up three, so that a fit remains. Then the settings far above the curve fitted to the remaining
/// settings are excluded, unless no fit is possible without them. If the fit to all settings is refused,
/// everything is kept.
Reach within_reach(std::span<const PilotObservation> observations, double level);

/// Fits the settings that within_reach() keeps, with a jackknife-t and an expanded percentile bootstrap over
/// whole participants (options.resamples = 0: no bootstrap). The intervals and tests are refused with fewer
/// than least_participants and if there is no fit without one of the participants; the bootstrap also if more
/// than largest_failed_share of the resamples have no fit. `drawn`: the curves of all options.resamples
/// resamples, if resample_direct() has computed them (std::invalid_argument for another number); none: they
/// are computed here.
DirectEstimate estimate_direct(std::span<const PilotObservation> observations, double level,
                               const BootstrapOptions& options, const ResampledCurves* drawn = nullptr);

/// The curves of some of the resamples of estimate_direct(). options.resamples is not used. Empty if there is
/// no fit.
ResampledCurves resample_direct(std::span<const PilotObservation> observations, double level,
                                const BootstrapOptions& options, ResampleRange range);

}  // namespace stats
