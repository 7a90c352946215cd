#pragma once
/// Descriptive and exploratory results of a part (docs/report.md: distributions, response_times,
/// reliability, by_n_star, detectable, retest).

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/analysis/task2.hpp"

namespace study {

/// Counts of each score by question, n_* and method; for the pilot by setting. Empty for pairs.
Json distributions_json(const TaskData& data);

/// One entry for each answered question about trials; null times were not recorded.
Json response_times_json(const TaskData& data);

/// One entry for each score of several items and each n_*: Cronbach's alpha of participants' means of each
/// item over their reports.
Json reliability_json(const TaskData& data, const std::vector<stats::ScoreTable>& tables,
                      const stats::AnalysisPlan& plan);

/// Single reports of one score by n_*, scene and method; the interval is of participants' means.
Json score_by_scene_json(const TaskData& data, const stats::ScoreTable& table, double confidence);

/// Tests if the difference of two methods depends on n_*: for each score, pair of n_* and pair of methods.
Json n_star_differences_json(const std::vector<stats::ScoreTable>& tables, const stats::AnalysisPlan& plan);

/// The smallest effects are those that the tests of the given number of people detect with this power.
inline constexpr double detectable_power = 0.8;
Json detectable_scores_json(const std::vector<stats::ScoreTable>& tables,
                            const std::vector<stats::ScoreAnalysis>& analyses,
                            const stats::AnalysisPlan& plan);
Json detectable_preference_json(const stats::PreferenceAnalysis& analysis, const stats::AnalysisPlan& plan);

/// Task 1: a list with one entry for each question asked about repeated showings; empty without repeats.
Json rating_retest_json(const TaskData& data);
/// Task 2: number of pairs and share of equal choices; null without repeats.
Json choice_retest_json(const TaskData& data);

}  // namespace study
