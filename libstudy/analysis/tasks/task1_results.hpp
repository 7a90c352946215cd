#pragma once
/// Analyses Task 1: scores, their comparisons, and the hypotheses about them.

#include <string>
#include <vector>

#include "libstudy/analysis/task_data.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/ordinal_effects.hpp"
#include "stats/analysis/task1.hpp"

namespace study {

/// A cumulative-link model of the answers to one question at one n_*.
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
  std::vector<stats::ShownClaims::LeftOut> left_out;  ///< hypotheses that are not tested, with reasons
};

/// One table for each of realism, cybersickness, and cybersickness without unrealism. A score is the mean of
/// its items; a report (the answers about one trial) that lacks an item has no score. A score is left out if
/// the trials do not ask for one of its items.
std::vector<stats::ScoreTable> score_tables(const TaskData& data, const stats::AnalysisPlan& plan);

/// One value for each report (the answers about one trial) and each planned trial without a report, before
/// scenes are averaged: the sum of the answers to `items`; NaN if one is unanswered.
std::vector<stats::MethodScore> report_scores(const TaskData& data, const std::vector<std::string>& items);

/// Analyses each score whose items are asked, and tests the hypotheses whose methods the protocol shows.
/// No hypothesis is tested if effects are a factor, or if an item of realism or cybersickness is not asked.
Task1Results analyse_task1(const TaskData& data, const stats::AnalysisPlan& plan);

/// Tests the hypotheses whose methods the protocol shows, and computes nothing else. Used by the sensitivity
/// analysis.
std::vector<stats::Hypothesis> task1_verdicts(const TaskData& data, const stats::AnalysisPlan& plan);

}  // namespace study
