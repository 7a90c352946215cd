#pragma once
/// A smooth surface of scores over the mean and the standard deviation of the frame rate, with a mean for
/// each participant and a change over the session. It says which score to expect where people rated settings
/// of their own, so that a setting has few scores.
///
/// The terms are x, e, x e, x^2, e^2 and the place in the session, where x is log2 of the mean frame rate
/// about its mean and e the standard deviation by the largest one.

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "stats/ptpe/pilot.hpp"

namespace stats {

/// First and last position of each participant's trials.
std::map<int, std::pair<double, double>> sessions_of(std::span<const PilotRating> ratings);

/// Position of a trial in its session, from -1/2 (first trial) to 1/2 (last trial).
double place_of(const PilotRating& rating, const std::pair<double, double>& session);

/// The score that the surface predicts for each rating, without the change over the session and up to a
/// constant for each participant. Scores far from the surface weigh less (Huber's weights).
std::vector<double> surface_scores(std::span<const PilotRating> ratings);

/// The jackknife's pseudo-values over participants of the surface's coefficient of the place. Their mean is
/// the change over the session, and their spread holds the uncertainty of the whole surface.
std::vector<double> surface_changes(std::span<const PilotRating> ratings);

}  // namespace stats
