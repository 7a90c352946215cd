#pragma once
/// Why the fit of a pilot must not steer a solver, although numbers came out of it.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot.hpp"

namespace stats {

/// One reason.
struct PilotDoubt {
  std::string code;  ///< stable, snake_case
  std::string text;  ///< with the figures that it rests on
};

/// A rise of the mean score with the frame rate must be told from none at this one-sided level.
inline constexpr double rise_level = 0.025;
/// A fall between two frame rates counts at this level, shared by all pairs of them (Bonferroni): a pilot
/// whose scores rise or stay is doubted for it in at most one of a hundred.
inline constexpr double fall_level = 0.01;
/// Fewer deltas at which the curve runs through the frame rates shown do not carry a curve.
inline constexpr int least_deltas_in_reach = 3;

/// In this order, each at most once: the scores do not rise with the mean frame rate ("no_rise": slope on
/// log2 of it within each delta, one for each participant, t-test); they fall between two frame rates
/// ("falls": paired t-tests over common deltas); the participants do not differ ("no_spread"); the curve
/// leaves the settings at all but two deltas ("few_deltas"); the interval of b lies below zero
/// ("b_below_zero"); the intervals of two estimators have nothing in common ("estimators_disagree").
/// What cannot be computed raises no doubt: it is refused elsewhere.
std::vector<PilotDoubt> pilot_doubts(const PilotTable& table, const DirectEstimate& direct,
                                     const PilotEstimate& contour, const OrdinalPilotEstimate& ordinal);

/// "form_rejected" where the test of the form says that the threshold is no exponential. Apart from the
/// others, since a lab may accept another form as an approximation.
inline constexpr const char* form_rejected = "form_rejected";
std::optional<PilotDoubt> form_doubt(const DirectEstimate& direct);

/// "no_band" where there is no band of the curve; "curve_outside_band" where the curve that the solver gets
/// leaves its band at one of `deltas`. A file cannot say then where it holds.
std::optional<PilotDoubt> band_doubt(const Curve& curve, const Result<CurveSpread>& band,
                                     std::span<const double> deltas);

/// One sentence on the form test: c with its interval, how the curve differs, and the smallest |c|
/// detectable.
std::string form_text(const FormTest& form);

}  // namespace stats
