#pragma once
/// Reasons why a pilot's fit, although it was computed, must not be used by a solver.

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
  std::string text;  ///< in words, with its figures
};

/// The rise of the mean score with the frame rate must be significant at this one-sided level.
inline constexpr double rise_level = 0.025;
/// A fall between two frame rates counts at this level, shared by all pairs of them (Bonferroni). A pilot
/// whose scores never fall raises this doubt in at most one of a hundred cases.
inline constexpr double fall_level = 0.01;
/// Smallest number of deltas at which the curve must run through the frame rates shown.
inline constexpr int least_deltas_in_reach = 3;

/// Returns these doubts, in this order and each at most once: the scores do not rise with the mean frame rate
/// ("no_rise": t-test of the participants' slopes on its log2 within each delta); they fall between two frame
/// rates ("falls": paired t-tests over common deltas); the participants do not differ ("no_spread"); the
/// curve is within the settings at fewer than three deltas ("few_deltas"); the interval of b lies below zero
/// ("b_below_zero"); the intervals of two estimators do not overlap ("estimators_disagree"). What cannot be
/// computed raises no doubt, since it is refused elsewhere.
std::vector<PilotDoubt> pilot_doubts(const PilotTable& table, const DirectEstimate& direct,
                                     const PilotEstimate& contour, const OrdinalPilotEstimate& ordinal);

/// "form_rejected" if the form test rejects an exponential. Separate from the others, since a lab may accept
/// an exponential as an approximation.
inline constexpr const char* form_rejected = "form_rejected";
std::optional<PilotDoubt> form_doubt(const DirectEstimate& direct);

/// "no_band" if the curve has no band; "curve_outside_band" if the direct curve, which the fluid solver
/// reads, leaves it at one of `deltas`. A file then cannot state where the curve is valid.
std::optional<PilotDoubt> band_doubt(const Curve& curve, const Result<CurveSpread>& band,
                                     std::span<const double> deltas);

/// One sentence on the form test: c with its interval, how the curve differs, and the smallest detectable
/// |c|.
std::string form_text(const FormTest& form);

}  // namespace stats
