#pragma once
/// Scores of the Simulator Sickness Questionnaire (Kennedy, Lane, Berbaum and Lilienthal 1993, International
/// Journal of Aviation Psychology 3(3), table 4): a weighted sum of the items of each scale.

#include <array>
#include <optional>

namespace stats {

inline constexpr int ssq_item_count = 16;
inline constexpr int ssq_item_max = 3;

/// Answers to the items in Kennedy's order, each 0 (none) to 3 (severe); empty: not answered.
using SsqAnswers = std::array<std::optional<int>, ssq_item_count>;

enum class SsqScale { Nausea, Oculomotor, Disorientation, Total };
inline constexpr std::array ssq_scales{SsqScale::Nausea, SsqScale::Oculomotor, SsqScale::Disorientation,
                                       SsqScale::Total};

/// Name of the scale: "nausea", "oculomotor", "disorientation", "total".
const char* ssq_name(SsqScale scale);
/// Weight of the scale: 9.54, 7.58, 13.92, and 3.74 for the total, which is applied to the sum of the three
/// unweighted sums.
double ssq_weight(SsqScale scale);
/// The unweighted sum. For the total it is the three sums together, so items of two scales count twice. Empty
/// if an item of the scale is missing. std::invalid_argument for an answer outside 0 to 3.
std::optional<int> ssq_sum(SsqScale scale, const SsqAnswers& answers);
/// ssq_sum times ssq_weight, rounded to the nearest double: at most 200.34, 159.18, 292.32 and 235.62.
std::optional<double> ssq_score(SsqScale scale, const SsqAnswers& answers);

}  // namespace stats
