#pragma once
/// Trials as the exclusion rules may see them: without method, scene or setting.

#include "libstudy/store/read/task_answers.hpp"
#include "stats/analysis/exclusions.hpp"

namespace study {

/// The answer to a question; for a choice 1 or 2, the interval. NaN if unanswered.
double answer_to(const TaskTrial& trial, const Question& question);

/// `question`: the main question.
stats::TrialRecord record_of(const TaskSession& session, const TaskTrial& trial, const Question& question);

/// Applies the rules to all trials except practice, and to answered catch pages, of the sessions with
/// answers.
std::vector<stats::Exclusion> find_exclusions(const TaskProtocol& protocol, const Question& question,
                                              const stats::ExclusionRules& rules);

}  // namespace study
