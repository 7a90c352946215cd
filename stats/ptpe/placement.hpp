#pragma once
/// Adaptive placement for the PTPE: each setting, a mean and a standard deviation of the frame rate, is
/// chosen near the contour of just satisfactory settings that the ratings so far suggest: those of this
/// person and of the people before.
///
/// A rating says equally much about the contour wherever it lies on the scale, except near the scale's ends.
/// So the settings lie above, on and below the present estimate of the contour in turn. Those on it determine
/// the contour whatever the curvature of the ratings about it, the others their slope. The turns of
/// successive people begin at different places, so that all distances occur early and late. The estimate lies
/// a third of the way from that of all people to that of this person, because settings that follow each
/// person's own taste would hide how much people differ. Three of four trials use the smallest standard
/// deviation, the fourth the largest: there a and b are determined best. Some trials, spread over the
/// session, use the middle one of those between, where a contour of another form lies farthest from an
/// exponential. Choosing by expected entropy, as QUEST+ does, was no better than drawing settings at random
/// (docs/decisions.md).

#include <cstddef>
#include <span>
#include <vector>

#include "stats/adaptive/quest_plus.hpp"

namespace stats {

/// A mean and a standard deviation of the frame rate that can be shown, frames/s.
struct PlacementSetting {
  double mu = 0;     ///< mean; above 0
  double delta = 0;  ///< standard deviation
};

/// The assumed rater and the prior of its parameters. A rating is
///
///   level + slope (mu - a exp(b delta)) + noise,
///
/// rounded to the nearest score of the scale. a and b are those of all people. All points of the grid have
/// equal weight.
struct PlacementPrior {
  std::vector<double> a, b;                   ///< grids, frames/s and s/frame
  std::vector<double> slope{0.1, 0.14, 0.2};  ///< grid, scores per frame/s
  double noise = 1;                           ///< standard deviation of one rating, scores
  int lowest = 1, highest = 7;                ///< scores at the ends of the scale
  double level = 4;                           ///< mean score on the contour
};

/// Grids of a and b. a runs from half the lowest mean of the settings to the highest mean, in equal ratios. b
/// runs from 0 to the value at which a contour rises from the lowest to the highest mean over the largest
/// delta, but at most to 0.1; it is 0 alone if every delta is 0. std::invalid_argument: fewer than two
/// settings, settings of one mean, or a mean that is not above 0.
PlacementPrior placement_prior(std::span<const PlacementSetting> settings);

/// Rules of one session.
struct PlacementRules {
  int trials = 10;  ///< planned number of trials of the session
  /// Number of trials, spread evenly over the session, that use the middle one of the standard deviations
  /// between the smallest and the largest. Without such trials the form of the contour, the just satisfactory
  /// mean frame rate over the standard deviation, cannot be checked, and estimate_direct() has no fit.
  int between = 2;
  /// Factor, above 1, between the estimated contour and the mean frame rates that are shown above and below
  /// it.
  double bracket = 1.42;
  int most_of_one = 1000000;  ///< largest number of times that a setting is shown in a session
};

/// A number of trials between the ends that suits a session: a fifth of its trials, but 2 at least.
int usual_between(int trials);

/// The placement of one session. Its state follows from the settings shown and the ratings given, so a
/// resumed session continues with the same settings.
///
///   stats::Placement placement(settings, stats::placement_prior(settings), {.trials = 10});
///   for (const auto& [setting, score] : earlier) placement.learn(setting, score);
///   placement.add(placement.next(), 5);
class Placement {
 public:
  /// std::invalid_argument: no setting, or rules out of range.
  Placement(std::vector<PlacementSetting> settings, const PlacementPrior& prior,
            const PlacementRules& rules = {});

  /// A number that rises by 1 from person to person; 0 before the first call. Turns of distances begin at
  /// another place for each number. std::invalid_argument: a negative number.
  void set_person(int person);
  /// Adds a rating of a setting by another person. std::invalid_argument if there is no such setting or the
  /// score is not on the scale.
  void learn(int setting, int score);
  /// As learn(), for a rating by this person: the trial counts as shown.
  void add(int setting, int score);
  /// Index of the next setting. std::logic_error if every setting was shown as often as the rules allow.
  int next() const;

  /// Summaries of the posterior of a and b given the ratings of all people.
  GridEstimate a() const;
  GridEstimate b() const;

 private:
  std::vector<PlacementSetting> settings_;
  PlacementRules rules_;
  std::vector<double> deltas_;  ///< distinct standard deviations of the frame rate in settings_, ascending
  int lowest_ = 1, person_ = 0;
  std::vector<double> a_values_, b_values_;  ///< value at each parameter point of quest_
  QuestPlus all_, own_;  ///< given the ratings of all people, and given this person's alone
  std::vector<int> shown_;
};

}  // namespace stats
