#pragma once
/// Descriptive and exploratory results of one analysis (docs/report.md: distributions, response_times,
/// reliability, by_n_star, detectable, retest).

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/analysis/task2.hpp"

namespace study {

/// Counts of each score (on a visual analogue scale, of each tenth): for Task 1 by rated question, n_* and
/// method, for a pilot by frame-rate setting. Empty for other tasks.
Json distributions_json(const TaskData& data);

/// One entry for each question with recorded response times in s. The times are null if a participant was
/// simulated.
Json response_times_json(const TaskData& data);

/// Cronbach's alpha of each score that has several items, at each n_*. It is computed from each participant's
/// mean answer to each item.
Json reliability_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                      const stats::AnalysisPlan& plan);

/// Mean and SD of one score over single reports (a participant's answers about one trial), by n_*, scene and
/// method. The confidence interval is that of the mean over participants' means.
Json score_by_scene_json(const TaskData& data, const stats::ScoreTable& table, double confidence);

/// Tests if the difference of two methods depends on n_*. One entry for each score, pair of n_* and pair of
/// methods.
Json n_star_differences_json(const std::vector<stats::ScoreTable>& tables, const stats::AnalysisPlan& plan);

/// The power at which detectable_scores_json() and detectable_preference_json() give the smallest effect that
/// a test detects.
inline constexpr double detectable_power = 0.8;
Json detectable_scores_json(const std::vector<stats::ScoreTable>& tables,
                            const std::vector<stats::ScoreAnalysis>& analyses,
                            const stats::AnalysisPlan& plan);
Json detectable_preference_json(const stats::PreferenceAnalysis& analysis, const stats::AnalysisPlan& plan);

/// Task 1: a list with one entry for each question answered in a trial and in its repeat; empty without
/// repeats.
Json rating_retest_json(const TaskData& data);
/// Task 2: number of repeated pairs and the share in which both choices agree; null without repeats.
Json choice_retest_json(const TaskData& data);

}  // namespace study
