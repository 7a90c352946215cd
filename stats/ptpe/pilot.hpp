#pragma once
/// The PTPE pilot: ratings of settings (mu, delta) by participants, and a exp(b delta) fitted to their
/// contour.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "stats/bootstrap.hpp"
#include "stats/ptpe/score_grid.hpp"

namespace stats {

/// One answered trial.
struct PilotRating {
  int participant = 0;                ///< any number; equal numbers are one participant
  double mu = 0;                      ///< nominal mean frame rate of the setting, frames/s
  double delta = 0;                   ///< nominal standard deviation
  double realised_mu = 0;             ///< as shown, harmonic: N / sum(dt)
  double realised_mu_arithmetic = 0;  ///< as shown, mean of 1/dt
  double realised_delta = 0;
  double score = 0;
  int position = -1;  ///< of the trial in its session; -1: not known
};

/// A participant's mean score of one setting, where it was really shown.
struct PilotObservation {
  int participant = 0;  ///< 0, 1, ... in ascending order of PilotRating::participant
  double mu = 0, delta = 0;
  double score = 0;
  double nominal_delta = 0;  ///< of the setting: equal numbers are one column of the grid
  double nominal_mu = 0;     ///< and its row
};

/// Which realised mean is the coordinate mu of a setting.
enum class PilotMean { Harmonic, Arithmetic };

/// Ratings by participant and setting. A participant's repeated ratings of a setting are averaged first, so
/// that the participant stays the unit.
class PilotTable {
 public:
  /// Every number finite (std::invalid_argument).
  explicit PilotTable(std::span<const PilotRating> ratings);

  int participants() const { return participants_; }
  std::size_t settings() const;  ///< with at least one rating
  std::size_t ratings() const { return ratings_; }
  int incomplete_participants() const;  ///< who lack a setting that another one rated
  bool all_equal() const;               ///< one and the same score throughout

  /// Mean scores and places, participant i counted weights[i] times (empty = once each).
  ScoreGrid grid(PilotMean mean, std::span<const double> weights = {}) const;
  /// Mean score of each participant who rated the setting of a node of grid(), by its index.
  std::vector<double> scores(std::size_t node) const;
  /// One for each setting that each participant rated.
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
  std::vector<Entry> entries_;  ///< participant x cell, cells row-major
};

/// The product's point estimate: contour of the means along lines one frame/s apart, then least squares. The
/// dense lines weigh the curve evenly over delta, while edge crossings bunch up where it runs along a row and
/// are few (5 to 9 in the pilot), so a single one more or less moves b.
Result<ExponentialFit> estimate_contour(const ScoreGrid& grid, double level);

/// What resampling the participants says of a and b.
struct PilotSpread {
  std::array<double, 2> a_ci{}, b_ci{};  ///< expanded percentile intervals
  double a_se = 0, b_se = 0;             ///< standard deviations of the resampled estimates
  int resamples = 0;
  int failed = 0;         ///< resamples without a fit, left out
  bool extremes = false;  ///< so few participants that the interval's ends are the outermost resamples
};

/// Fewer participants have too few different resamples for any interval.
inline constexpr int least_participants = 4;
/// With a larger share of resamples without a fit, the rest is a selection and no interval is given.
inline constexpr double largest_failed_share = 0.05;

/// From resampled estimates of a and b, fewer than options.resamples where some had no fit. Refused beyond
/// largest_failed_share.
Result<PilotSpread> pilot_spread(std::span<const double> a, std::span<const double> b, int participants,
                                 const BootstrapOptions& options);

/// A contour, its curve, and how far the participants determine it.
struct PilotEstimate {
  Contour contour;
  Result<ExponentialFit> fit = Refusal{"not computed"};
  Result<PilotSpread> spread = Refusal{"not computed"};
};

/// Whole participants are resampled and the contour and its curve made anew each time. The fit's own standard
/// errors say nothing of the participants: the contour's points are interpolated from few means and far from
/// independent. `spread` is refused without a fit, with fewer than least_participants, and beyond
/// largest_failed_share.
PilotEstimate estimate_pilot(const PilotTable& table, PilotMean mean, double level,
                             const BootstrapOptions& options);

}  // namespace stats
