#pragma once
/// The parts of Task 1's results about missing answers (docs/report.md): the mixed model of all answers, the
/// number of participants in each comparison, and tipping points. A tipping point is by how many points
/// missing answers must be worse than expected before a comparison's decision changes.

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/analysis/tipping.hpp"

namespace study {

/// Adds "mixed" (the comparison by the mixed model) and "tipping" (the tipping point at `alpha`) to one entry
/// of task1.comparisons.
void add_missing_data(Json& comparison, const stats::ScoreTable& table, const stats::MethodComparison& one,
                      double alpha);
/// One entry of task1.mixed: the fitted model of one score.
Json mixed_json(const TaskData& data, const stats::ScoreTable& table,
                const stats::Result<stats::MixedScores>& model, double confidence);
/// One entry of task1.people: the numbers of participants in the comparisons of one score at one n_*.
Json people_json(const stats::ScoreTable& table, const stats::PairPeople& people);
Json tipping_json(const stats::TippingPoint& tipping);

}  // namespace study
