#pragma once
/// Thresholds of a cumulative probit model that are held so that the expected rating has a given level at
/// location 0. The location is then 0 on the contour of this level.

#include <span>
#include <vector>

namespace stats {

/// Thresholds theta_j = c + t_j. The log gaps give t_j. c is chosen so that the expected rating E over a
/// normal effect of the person (sd; 0: of one person) equals the level at location 0.
struct LevelThresholds {
  std::vector<double> theta;   ///< ascending, one fewer than levels
  std::vector<double> weight;  ///< -dE/dtheta_j
  double total = 0;            ///< sum of the weights
  double by_sd = 0;            ///< dc / d sd

  /// From the derivatives of a function for each threshold, writes those for each log gap to `out`. Returns
  /// the derivative for a shift of all thresholds.
  double by_gaps(std::span<const double> log_gaps, std::span<const double> thresholds,
                 std::span<double> out) const;
};

/// `levels`: the scores that occur, ascending, two more than log_gaps; lowest < level < highest.
LevelThresholds level_thresholds(std::span<const double> log_gaps, double sd, std::span<const double> levels,
                                 double level);

}  // namespace stats
