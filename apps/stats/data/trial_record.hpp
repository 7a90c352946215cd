#pragma once
/// Trials as the exclusion rules may see them: without method, scene or setting.

#include "libstudy/store/task_answers.hpp"
#include "stats/analysis/exclusions.hpp"

namespace apps {

/// The answer to a question; for a choice 1 or 2, the interval. NaN if unanswered.
double answer_to(const study::TaskTrial& trial, const study::Question& question);

/// `question`: the main question.
stats::TrialRecord record_of(const study::TaskSession& session, const study::TaskTrial& trial,
                             const study::Question& question);

/// Applies the rules to all trials except practice, and to answered catch pages, of the sessions with
/// answers.
std::vector<stats::Exclusion> find_exclusions(const study::TaskProtocol& protocol,
                                              const study::Question& question,
                                              const stats::ExclusionRules& rules);

}  // namespace apps
