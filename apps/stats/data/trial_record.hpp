#pragma once
/// Trials as the rules of exclusion may see them: neither method, scene nor setting.

#include "libstudy/store/task_answers.hpp"
#include "stats/analysis/exclusions.hpp"

namespace apps {

/// The answer to a question; for a choice 1 or 2, the interval. NaN: none.
double answer_to(const study::TaskTrial& trial, const study::Question& question);

/// `question`: the main one.
stats::TrialRecord record_of(const study::TaskSession& session, const study::TaskTrial& trial,
                             const study::Question& question);

/// Trials but practice, and answered catch pages, of the sessions that have answers; then the rules.
std::vector<stats::Exclusion> find_exclusions(const study::TaskProtocol& protocol,
                                              const study::Question& question,
                                              const stats::ExclusionRules& rules);

}  // namespace apps
