#pragma once
/// Task 1 from its answers to its results.

#include <string>
#include <vector>

#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/ordinal_effects.hpp"
#include "stats/analysis/task1.hpp"

namespace study {

/// A cumulative-link model of one question at one n_*.
struct OrdinalModel {
  std::string question;
  int n_star = 0;
  stats::Result<stats::OrdinalEffects> effects = stats::Refusal{"not computed"};
};

struct Task1Results {
  std::vector<stats::ScoreTable> tables;  ///< realism, sickness, sickness without unrealism
  std::vector<stats::ScoreAnalysis> analyses;
  std::vector<OrdinalModel> ordinal;
  std::vector<stats::Hypothesis> hypotheses;
  std::vector<stats::ShownClaims::LeftOut> left_out;  ///< hypotheses that are not tested
};

/// Realism and the cybersickness scores. A score is the mean of its items; a report that lacks an item has no
/// score. Scores with an item that is not asked are left out.
std::vector<stats::ScoreTable> score_tables(const TaskData& data, const stats::AnalysisPlan& plan);

/// A table's scores before scenes are averaged: one for each report; NaN for reports planned but not given.
std::vector<stats::MethodScore> report_scores(const TaskData& data, const std::vector<std::string>& items);

/// Analyses each score whose items are asked, and those of H1 to H3 whose methods the protocol shows; no
/// hypotheses if effects are a factor or an item of a score is not asked.
Task1Results analyse_task1(const TaskData& data, const stats::AnalysisPlan& plan);

/// Only H1 to H3, as far as the protocol shows their methods: for the sensitivity analysis.
std::vector<stats::Hypothesis> task1_verdicts(const TaskData& data, const stats::AnalysisPlan& plan);

}  // namespace study
