#pragma once
/// Adaptive placement for the PTPE: the next setting is the one whose rating is expected to say most about a
/// and b.

#include <cstddef>
#include <span>
#include <vector>

#include "stats/adaptive/quest_plus.hpp"
#include "stats/ptpe/curve.hpp"

namespace stats {

/// A frame rate that can be shown, frames/s.
struct PlacementSetting {
  double mu = 0;     ///< mean; above 0
  double delta = 0;  ///< standard deviation
};

/// The rater that the placement assumes, with its prior. A rating is
///
///   m + slope (mu - a exp(b delta)) + person + noise,
///
/// rounded to the nearest score; m is the level of the contour. a and b are of interest, slope and person are
/// not. Each grid gets equal weights, person those of a normal distribution.
struct PlacementPrior {
  std::vector<double> a, b;                         ///< grids, frames/s and s/frame
  std::vector<double> slope{0.07, 0.14, 0.28};      ///< scores per frame/s
  std::vector<double> person{-1, -0.5, 0, 0.5, 1};  ///< scores
  double person_sd = 0.5;                           ///< scores
  double noise = 1;                                 ///< standard deviation of one rating, scores
  int lowest = 1, highest = 7;                      ///< of the scale
  double level = 4;                                 ///< score on the contour
};

/// Grids of a and b that cover every contour that crosses the range of the settings: a from half the lowest
/// to the highest mean, in equal ratios; b from 0 to the value at which the contour of the lowest mean
/// reaches the highest one at the largest delta, at most 0.1. std::invalid_argument: fewer than two settings,
/// settings of one mean only, or a mean that is not above 0.
PlacementPrior placement_prior(std::span<const PlacementSetting> settings);

/// Rules that keep enough variety in a session to check the model with its ratings.
struct PlacementGuards {
  /// The first trials show these settings, in this order (indices): a fixed part for the checks of the model.
  std::vector<int> fixed;
  int most_of_one = 3;  ///< largest number of times that a session shows a setting, with the fixed part
  /// While the settings shown so far span less than this share of the range of delta, the next setting has
  /// another delta than the last one, if the guards leave one.
  double least_spread = 0.5;
};

/// The placement of one session. Its state follows from the settings shown and the ratings given, so a
/// resumed session continues with the same settings.
class Placement {
 public:
  /// std::invalid_argument if a fixed index does not exist.
  Placement(std::vector<PlacementSetting> settings, const PlacementPrior& prior, PlacementGuards guards = {});

  /// Index of the next setting. std::logic_error when the guards leave none.
  int next() const;
  /// A rating of the setting; std::invalid_argument outside the scale.
  void add(int setting, int score);

  GridEstimate a() const;
  GridEstimate b() const;

 private:
  std::vector<PlacementSetting> settings_;
  PlacementGuards guards_;
  int lowest_ = 1;
  std::vector<double> a_values_, b_values_;  ///< by parameter point
  QuestPlus quest_;
  std::vector<int> shown_;
};

}  // namespace stats
