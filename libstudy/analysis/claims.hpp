#pragma once
/// Which hypotheses the shipped analyses can test for a protocol, known before there are data.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// Reasons why H1 to H3 or H4 to H6 do not apply to a protocol.
inline constexpr const char* methods_in_pairs = "methods are shown in pairs and not rated one by one";
inline constexpr const char* no_pairs = "no pairs of methods are shown";
inline constexpr const char* no_choice_of_pair =
    "no question of kind choice with exactly two anchors, one for each of a pair, is asked";

/// Items of the cybersickness score without unrealism.
inline const std::vector<std::string> items_without_unrealism{"disorientation", "dizziness", "confusion"};

/// Returns H1 to H3 if the protocol shows methods one by one and asks for realism and cybersickness, and H4
/// to H6 if it asks for a choice between pairs of methods. Hypotheses that need methods not shown are left
/// out, with the reason.
stats::ShownClaims hypotheses_of(const Protocol& protocol, const stats::AnalysisPlan& plan);

/// True if the protocol rates methods one by one and asks for realism and for these items: the margin of the
/// items' score then has an effect.
bool compares_scores(const Protocol& protocol, const std::vector<std::string>& items);

/// Names the questions that H1 to H3 need and the trials do not ask; empty if none is missing.
std::string missing_items(const std::vector<Question>& asked);

/// True if the question rates sickness; such questions have their own analysis.
bool is_sickness(const Question& question);

/// Scale questions that the trials ask at several frame rates, without questions on sickness: each gets a
/// curve.
std::vector<Question> curve_questions(const Protocol& protocol);

}  // namespace study
