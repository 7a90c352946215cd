#pragma once
/// What the shipped analyses can tell of a protocol, before there are data.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace apps {

/// Why hypotheses of the one kind or the other are not about a protocol.
inline constexpr const char* methods_in_pairs = "methods are shown in pairs and not rated one by one";
inline constexpr const char* no_pairs = "no pairs of methods are shown";
inline constexpr const char* no_choice_of_pair =
    "no question of kind choice with exactly two anchors, one for each of a pair, is asked";

/// Items of the cybersickness score that leaves unrealism out.
inline const std::vector<std::string> items_without_unrealism{"disorientation", "dizziness", "confusion"};

/// H1 to H3 for a protocol that shows methods one by one and asks for realism and cybersickness, H4 to H6 for
/// one that lets people choose of pairs, as far as it shows their methods; and why others are not tested.
stats::ShownClaims hypotheses_of(const study::Protocol& protocol, const stats::AnalysisPlan& plan);

/// Whether methods that are rated one by one are compared by realism, and by a score of these items beside
/// it: then the margin of that score acts.
bool compares_scores(const study::Protocol& protocol, const std::vector<std::string>& items);

/// Names the questions that H1 to H3 need and the trials do not ask; empty if they ask all of them.
std::string missing_items(const std::vector<study::Question>& asked);

/// Whether a question rates sickness; these have an analysis of their own.
bool is_sickness(const study::Question& question);

/// Questions that the trials ask on a scale under several frame rates, sickness aside: each has a curve.
std::vector<study::Question> curve_questions(const study::Protocol& protocol);

}  // namespace apps
