#pragma once
/// The parts of Task 1's results about missing answers (docs/report.md): the mixed model of all answers, the
/// participants of pairs, tipping points.

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/analysis/tipping.hpp"

namespace study {

/// Adds "mixed" and "tipping" to one entry of task1.comparisons.
void add_missing_data(Json& comparison, const stats::ScoreTable& table, const stats::MethodComparison& one,
                      double alpha);
/// One entry of task1.mixed.
Json mixed_json(const TaskData& data, const stats::ScoreTable& table,
                const stats::Result<stats::MixedScores>& model, double confidence);
/// One entry of task1.people.
Json people_json(const stats::ScoreTable& table, const stats::PairPeople& people);
Json tipping_json(const stats::TippingPoint& tipping);

}  // namespace study
