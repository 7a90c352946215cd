#pragma once
/// The pilot study for the PTPE (ptpe.hpp): ratings of settings (mu, delta), which are the mean and the
/// standard deviation of the frame rate, and the fit of mu = a exp(b delta) to a contour of the mean ratings.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stats/bootstrap.hpp"
#include "stats/ptpe/score_grid.hpp"

namespace stats {

/// One answered trial.
struct PilotRating {
  int participant = 0;                ///< any number; equal numbers are one participant
  double mu = 0;                      ///< nominal mean frame rate of the setting, frames/s
  double delta = 0;                   ///< nominal standard deviation of the frame rate, frames/s
  double realised_mu = 0;             ///< harmonic mean frame rate as shown, N / sum(dt), frames/s
  double realised_mu_arithmetic = 0;  ///< arithmetic mean frame rate as shown, the mean of 1/dt, frames/s
  double realised_delta = 0;
  double score = 0;
  int position = -1;  ///< position of the trial in its session; -1: not known
};

/// A participant's mean score of one setting, at the frame rates really shown.
struct PilotObservation {
  int participant = 0;  ///< 0, 1, ... in ascending order of PilotRating::participant
  double mu = 0, delta = 0;
  double score = 0;
  double nominal_delta = 0;  ///< nominal standard deviation; equal ones form one column of the grid
  double nominal_mu = 0;     ///< nominal mean; equal ones form one row of the grid
};

/// The mean of the frame rates shown that is used as mu of a setting.
enum class PilotMean { Harmonic, Arithmetic };

/// Ratings by participant and setting. A participant's repeated ratings of a setting are averaged first, so
/// that each participant counts once at each setting.
class PilotTable {
 public:
  /// std::invalid_argument unless every number of every rating is finite.
  explicit PilotTable(std::span<const PilotRating> ratings);

  int participants() const { return participants_; }
  std::size_t settings() const;  ///< number of settings with at least one rating
  std::size_t ratings() const { return ratings_; }
  int incomplete_participants() const;  ///< participants who lack a setting that another participant rated
  bool all_equal() const;               ///< true if all scores are equal

  /// Mean scores and realised frame rates, with participant i counted weights[i] times (empty = once each).
  ScoreGrid grid(PilotMean mean, std::span<const double> weights = {}) const;
  /// The mean score of each participant who rated the setting of node `node` of grid().
  std::vector<double> scores(std::size_t node) const;
  /// One observation for each setting that each participant rated.
  std::vector<PilotObservation> observations(PilotMean mean) const;

 private:
  struct Entry {
    double n = 0, score = 0, mu_harmonic = 0, mu_arithmetic = 0, delta = 0;
  };
  const Entry& entry(int participant, std::size_t cell) const;

  int participants_ = 0;
  std::size_t ratings_ = 0;
  bool all_equal_ = true;
  std::vector<double> mu_, delta_;
  std::vector<Entry> entries_;  ///< participant x cell (setting), the cells row-major over mu_ x delta_
};

/// The contour estimate: the contour of the mean scores is sampled along lines of constant delta one frame/s
/// apart, then a exp(b delta) is fitted by least squares. The lines give all deltas equal weight. The
/// contour's crossings with the grid's edges are not used instead: they are few and lie close together where
/// the curve runs along a row, so that one crossing more or less would change b.
Result<ExponentialFit> estimate_contour(const ScoreGrid& grid, double level);

/// Uncertainty of a and b from resampling the participants.
struct PilotSpread {
  std::array<double, 2> a_ci{}, b_ci{};  ///< expanded percentile intervals
  double a_se = 0, b_se = 0;             ///< standard deviations of the resampled estimates
  int resamples = 0;
  int failed = 0;         ///< resamples without a fit, which are excluded
  bool extremes = false;  ///< true with so few participants that the interval's ends are the outermost
                          ///< resamples
};

/// Smallest number of participants for an interval; fewer participants have too few different resamples.
inline constexpr int least_participants = 4;
/// Largest share of resamples without a fit. Above this share, the resamples with a fit are a biased
/// selection, so no interval is given.
inline constexpr double largest_failed_share = 0.05;

/// Consecutive resamples: those with the numbers first to first + count - 1.
struct ResampleRange {
  int first = 0, count = 0;
};
/// a and b of the curve of each resample, in the order of the resamples; empty where a resample has no fit.
using ResampledCurves = std::vector<std::optional<std::array<double, 2>>>;

/// Summarises resampled curves. Refused if those without a fit are more than largest_failed_share of all, or
/// if fewer than two resamples have a fit.
Result<PilotSpread> pilot_spread(const ResampledCurves& curves, int participants, double confidence);

/// A contour of the mean scores, the curve a exp(b delta) fitted to it, and the curve's uncertainty over
/// participants.
struct PilotEstimate {
  Contour contour;
  Result<ExponentialFit> fit = Refusal{"not computed"};
  Result<PilotSpread> spread = Refusal{"not computed"};
};

/// Resamples whole participants and computes the contour and its curve anew each time. The fit's own standard
/// errors do not reflect differences between participants: the contour's points are interpolated from few
/// means and far from independent. `spread` is refused without a fit, with fewer than least_participants, and
/// if more than largest_failed_share of the resamples have no fit. `drawn`: the curves of all
/// options.resamples resamples, if resample_pilot() has computed them (std::invalid_argument for another
/// number); none: they are computed here.
PilotEstimate estimate_pilot(const PilotTable& table, PilotMean mean, double level,
                             const BootstrapOptions& options, const ResampledCurves* drawn = nullptr);

/// The curves of some of the resamples of estimate_pilot(). options.resamples is not used. Empty if
/// estimate_pilot() gives no intervals, for lack of a fit or of participants.
ResampledCurves resample_pilot(const PilotTable& table, PilotMean mean, double level,
                               const BootstrapOptions& options, ResampleRange range);

}  // namespace stats
