#pragma once
/// Reasons why a solver must not use the threshold curve mu = a exp(b delta) that was fitted to a pilot's
/// ratings.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/pilot.hpp"

namespace stats {

/// One reason not to use a pilot's fit.
struct PilotDoubt {
  std::string code;  ///< identifier in snake_case that does not change between versions
  std::string text;  ///< the reason in words and numbers
};

/// The rise of the mean score with the frame rate must be significant at this one-sided level.
inline constexpr double rise_level = 0.025;
/// Level at which a fall of the scores between two frame rates is significant. It is divided by the number of
/// pairs of frame rates (Bonferroni). A pilot whose scores never fall raises this doubt in at most one of a
/// hundred cases.
inline constexpr double fall_level = 0.01;
/// Smallest number of deltas (standard deviations of the frame rate) at which the curve must run through the
/// frame rates shown.
inline constexpr int least_deltas_in_reach = 3;

/// Returns these doubts, in this order and each at most once: the scores do not rise with the mean frame rate
/// ("no_rise": t-test of the participants' slopes over log2 of the frame rate within each delta); they fall
/// between two frame rates ("falls": paired t-tests over common deltas); the participants do not differ
/// ("no_spread"); the curve runs through the frame rates shown at fewer than three deltas ("few_deltas"); the
/// interval of b lies below zero ("b_below_zero"); the intervals of two estimators do not overlap
/// ("estimators_disagree"). A check whose input could not be computed raises no doubt, since the input is
/// refused elsewhere.
std::vector<PilotDoubt> pilot_doubts(const PilotTable& table, const DirectEstimate& direct,
                                     const PilotEstimate& contour, const OrdinalPilotEstimate& ordinal);

/// Code of the doubt that form_doubt() returns if the form test rejects an exponential. It is separate from
/// pilot_doubts(), since a lab may accept an exponential as an approximation.
inline constexpr const char* form_rejected = "form_rejected";
std::optional<PilotDoubt> form_doubt(const DirectEstimate& direct);

/// `band`: the curve by scale_end_curve() with its confidence band. Returns the doubt "no_band" if there is
/// no band; "curve_outside_band" if the direct curve, which the fluid solver reads, leaves the band at one of
/// the standard deviations `deltas`. In both cases a file for the solver cannot state where the curve is
/// valid. Empty without a doubt.
std::optional<PilotDoubt> band_doubt(const Curve& curve, const Result<CurveSpread>& band,
                                     std::span<const double> deltas);

/// One sentence on the form test: the bend c with its interval, how the curve differs from an exponential,
/// and the smallest detectable |c|.
std::string form_text(const FormTest& form);

}  // namespace stats
