#pragma once
/// Scores of the Simulator Sickness Questionnaire (Kennedy, Lane, Berbaum and Lilienthal 1993, International
/// Journal of Aviation Psychology 3(3), table 4): a weighted sum of the items of each scale.

#include <array>
#include <optional>

namespace stats {

inline constexpr int ssq_item_count = 16;
inline constexpr int ssq_item_max = 3;

/// Answers to the items in Kennedy's order, each 0 (none) to 3 (severe); empty: left out.
using SsqAnswers = std::array<std::optional<int>, ssq_item_count>;

enum class SsqScale { Nausea, Oculomotor, Disorientation, Total };
inline constexpr std::array ssq_scales{SsqScale::Nausea, SsqScale::Oculomotor, SsqScale::Disorientation,
                                       SsqScale::Total};

/// "nausea", "oculomotor", "disorientation", "total".
const char* ssq_name(SsqScale scale);
/// 9.54, 7.58, 13.92; of the total 3.74, over the three sums before they are weighted.
double ssq_weight(SsqScale scale);
/// The sum before the weight; of the total the three sums together, so that items of two scales count twice.
/// Empty when an item of the scale was left out. std::invalid_argument for an answer outside 0 to 3.
std::optional<int> ssq_sum(SsqScale scale, const SsqAnswers& answers);
/// ssq_sum times ssq_weight, the double nearest to it: at most 200.34, 159.18, 292.32 and 235.62.
std::optional<double> ssq_score(SsqScale scale, const SsqAnswers& answers);

}  // namespace stats
