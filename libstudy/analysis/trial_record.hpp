#pragma once
/// Records of trials for the exclusion rules. They hold neither method, scene nor setting, so that no rule
/// can depend on what was shown.

#include "libstudy/store/read/task_answers.hpp"
#include "stats/analysis/exclusions.hpp"

namespace study {

/// Score of the trial's answer to the question. For a choice or yes-or-no question it is 1 for the first
/// anchor (in a pair the first interval) and 2 for any other. NaN if unanswered.
double answer_to(const TaskTrial& trial, const Question& question);

/// The trial's record. `question`: the analysed question.
stats::TrialRecord record_of(const TaskSession& session, const TaskTrial& trial, const Question& question);

/// Applies the rules to the trials (except practice) and the answered catch pages of all sessions with
/// answers. In a pilot, also excludes trials without recorded frames, unless they are imported.
std::vector<stats::Exclusion> find_exclusions(const TaskProtocol& protocol, const Question& question,
                                              const stats::ExclusionRules& rules);

}  // namespace study
