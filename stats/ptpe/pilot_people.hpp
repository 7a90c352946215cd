#pragma once
/// How the participants of a pilot used the scale: who rated higher frame rates lower, whether scores drift
/// over the session, and lapses: answers at the lowest score whatever was shown.

#include <array>
#include <span>
#include <vector>

#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace stats {

/// What the analysis plan makes of them, fixed before the data are seen. All off: they are reported only.
struct PilotRules {
  bool exclude_reverse_coders = false;
  bool model_drift = false;   ///< the mean drift is taken off the scores
  bool model_lapses = false;  ///< scores y become (y - rate lowest) / (1 - rate): lapses move no mean
};

/// A participant's slope of the scores on log2 of the mean frame rate, within each standard deviation.
struct PersonSlope {
  int participant = 0;  ///< PilotRating::participant
  double slope = 0;     ///< points for each doubling
  double t = 0;         ///< slope / its error; infinite without residuals
  int df = 0;
  double p = 1;           ///< one-sided, of a slope below zero
  bool reversed = false;  ///< p < reverse_level / participants
};

/// From the first to the last trial of a session, points of the scale: t test of the participants' slopes
/// over position. A slope is of a participant's scores less the others' mean of the same setting.
struct SessionDrift {
  double change = 0, t = 0, p = 1;
  int df = 0;
  std::array<double, 2> ci{};
  bool found() const;
};

/// Answers at the lowest score where the others' median of the setting, and the person's own median distance
/// from such medians, make it improbable (below lapse_tail, by a normal distribution). Reverse coders are
/// left out.
struct LapseCount {
  int at_risk = 0;      ///< answers at whose setting the lowest score is improbable
  int lapsed = 0;       ///< of them: at the lowest score
  double expected = 0;  ///< of them without lapses
  double p = 1;         ///< of so many or more, Poisson
  double rate = 0;      ///< share of answers that are lapses, 0 or more
  double lowest = 1;    ///< score
  bool found() const;
};

inline constexpr double reverse_level = 0.01;  ///< shared by the participants (Bonferroni)
inline constexpr double drift_level = 0.05;    ///< two-sided
inline constexpr double lapse_tail = 0.005;
inline constexpr double lapse_level = 0.001;

struct PilotPeople {
  std::vector<PersonSlope> slopes;  ///< of those with three ratings more than standard deviations
  Result<SessionDrift> drift = Refusal{"not computed"};
  Result<LapseCount> lapses = Refusal{"not computed"};

  int reversed() const;
};

/// Drift is refused where positions are not known. Lapses are refused where the answers do not tell how far
/// answers scatter about what is expected of them, or the lowest score is improbable nowhere.
PilotPeople pilot_people(std::span<const PilotRating> ratings, double confidence);

/// The ratings that the rules leave, drift taken off about the middle of the session.
std::vector<PilotRating> apply_rules(std::span<const PilotRating> ratings, const PilotPeople& people,
                                     const PilotRules& rules);

}  // namespace stats
