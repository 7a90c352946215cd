#pragma once
/// How a pilot's participants used the scale: reverse coders, who rated higher frame rates lower; drift of
/// the scores over the session; and lapses, that is, answers at the lowest score whatever was shown.

#include <array>
#include <span>
#include <vector>

#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// The analysis plan's rules for reverse coders, drift and lapses, fixed before the data are seen. With all
/// rules off, reverse coders, drift and lapses are only reported, and the ratings stay unchanged.
struct PilotRules {
  bool exclude_reverse_coders = false;
  bool model_drift = false;   ///< subtract the mean drift from the scores
  bool model_lapses = false;  ///< replace scores y by (y - rate lowest) / (1 - rate), so that lapses do not
                              ///< shift means; rate and lowest are those of LapseCount
};

/// A participant's slope of the scores on log2 of the mean frame rate, among settings with equal standard
/// deviation of the frame rate.
struct PersonSlope {
  int participant = 0;  ///< PilotRating::participant
  double slope = 0;     ///< points of the scale for each doubling of the frame rate
  double t = 0;         ///< slope / its standard error; infinite without residuals
  int df = 0;
  double p = 1;           ///< one-sided, for a slope below zero
  bool reversed = false;  ///< reverse coder: p < reverse_level / number of slopes
};

/// Drift from the first to the last trial of a session, in points of the scale: t test of the participants'
/// slopes over position. A participant's slope is that of each score minus the mean of all other scores of
/// the same setting. Where the settings have fewer scores than half of the people, as under adaptive
/// placement: the coefficient of the position in a surface fitted to all scores with a mean for each
/// participant, with the jackknife over participants.
struct SessionDrift {
  double change = 0, t = 0, p = 1;
  int df = 0;
  std::array<double, 2> ci{};
  bool found() const;
};

/// Lapses: answers at the lowest score that are improbable (below lapse_tail, by a normal distribution) given
/// the expected score: the setting's median score plus the participant's own median distance from such
/// medians. Where the settings have fewer scores than half of the people, a surface fitted to all scores
/// stands in for the settings' medians. Reverse coders are left out.
struct LapseCount {
  int at_risk = 0;      ///< answers for which the lowest score is improbable
  int lapsed = 0;       ///< of these, answers at the lowest score
  double expected = 0;  ///< expected number of `lapsed` without lapses
  double p = 1;         ///< Poisson probability of `lapsed` or more such answers
  double rate = 0;      ///< share of answers that are lapses, 0 or more
  double lowest = 1;    ///< the lowest score given
  bool found() const;
};

/// Answers far from the expected score of LapseCount, above or below it, at any score: those that a normal
/// distribution makes improbable (below lapse_tail on their side). People who answer at random in a part of
/// the trials give more of them than expected. Reverse coders are left out.
struct FarAnswers {
  int answers = 0;      ///< answers looked at
  int far = 0;          ///< of these, answers far from the expected score
  double expected = 0;  ///< expected number of `far`
  double p = 1;         ///< Poisson probability of `far` or more such answers
  bool found() const;
};

/// Level of PersonSlope::reversed, divided by the number of participants with a slope (Bonferroni).
inline constexpr double reverse_level = 0.01;
inline constexpr double drift_level = 0.05;   ///< level of SessionDrift::found(), two-sided
inline constexpr double lapse_tail = 0.005;   ///< below this probability the lowest score is improbable
inline constexpr double lapse_level = 0.001;  ///< level of LapseCount::found()
inline constexpr double far_level = 0.01;     ///< level of FarAnswers::found()

struct PilotPeople {
  std::vector<PersonSlope> slopes;  ///< slopes of participants with at least three more ratings than rated
                                    ///< standard deviations of the frame rate
  Result<SessionDrift> drift = Refusal{"not computed"};
  Result<LapseCount> lapses = Refusal{"not computed"};
  Result<FarAnswers> far = Refusal{"not computed"};

  int reversed() const;
};

/// `drift` is refused, for example, if a trial's position is not known. `lapses` and `far` are refused, for
/// example, if the standard deviation about the expected scores cannot be estimated, or if the lowest score
/// is improbable at no setting.
PilotPeople pilot_people(std::span<const PilotRating> ratings, double confidence);

/// Applies the rules to the ratings; drift is subtracted relative to the middle of the session.
std::vector<PilotRating> apply_rules(std::span<const PilotRating> ratings, const PilotPeople& people,
                                     const PilotRules& rules);

}  // namespace stats
