#pragma once
/// Finds the hypotheses that the built-in analyses can test for a protocol. No data are needed.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

/// Reasons why hypotheses on ratings or on pairs do not apply to a protocol.
inline constexpr const char* methods_in_pairs = "methods are shown in pairs and not rated one by one";
inline constexpr const char* no_pairs = "no pairs of methods are shown";
inline constexpr const char* no_choice_of_pair =
    "no question of kind choice with exactly two anchors, one for each of a pair, is asked";

/// Ids of the questions on cybersickness other than 'unrealism'; their mean is a score of its own.
inline const std::vector<std::string> items_without_unrealism{"disorientation", "dizziness", "confusion"};

/// Returns the plan's hypotheses of Task 1 if the protocol shows methods one by one and asks for realism and
/// cybersickness, and those of Task 2 if it asks for a choice between pairs of methods. Every hypothesis that
/// is not returned is listed in `left_out` with the reason, such as a method that the protocol does not show.
/// None is returned if effects or frame rates vary.
stats::ShownClaims hypotheses_of(const Protocol& protocol, const stats::AnalysisPlan& plan);

/// Adds one entry with all hypotheses of a task (1 or 2; empty: both) to `left_out`. Adds no entry if the
/// plan has no hypothesis of this task.
void leave_out(std::vector<stats::ShownClaims::LeftOut>& left_out, const stats::AnalysisPlan& plan,
               std::optional<int> task, const std::string& reason);

/// True if participants rate several treatments (methods, or methods with levels of effects) one by one, for
/// realism and for each of `items`. If false, the analysis plan's margin for the mean of `items` (without
/// items: for realism) has no effect.
bool compares_scores(const Protocol& protocol, const std::vector<std::string>& items);

/// A sentence that names the questions that hypotheses of Task 1 need but that are missing from `asked`;
/// empty if none is missing.
std::string missing_items(const std::vector<Question>& asked);

/// True if the question belongs to the FMS or the SSQ. Sickness questions have their own analysis.
bool is_sickness(const Question& question);

/// The scale questions, except those on sickness, of a study that varies the frame rate and shows no pairs;
/// empty for any other study. A pilot fits one curve mu = a exp(b delta) to the answers to each question: the
/// mean frame rate mu that is just satisfactory at a standard deviation delta of the frame rate.
std::vector<Question> curve_questions(const Protocol& protocol);

}  // namespace study
