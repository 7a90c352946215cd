#include "libstudy/analysis/tasks/task1_results.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "libstudy/analysis/claims.hpp"
#include "libstudy/protocol/method_claims.hpp"

namespace study {

namespace {

using stats::ScoreScale;

const std::vector<std::string> sickness_items{"disorientation", "unrealism", "dizziness", "confusion"};

std::vector<ScoreScale> score_scales(const stats::AnalysisPlan& plan) {
  return {{"realism", "Realism", true, 1, 7, true, {"realism"}, plan.margin_realism},
          {"sickness", "Cybersickness (mean of four items)", true, 0, 3, false, sickness_items,
           plan.margin_sickness},
          {"sickness_without_unrealism", "Cybersickness without unrealism (mean of three items)", false, 0, 3,
           false, items_without_unrealism, plan.margin_sickness}};
}

const Question* find_question(const TaskData& data, const std::string& id) {
  for (const auto& question : data.protocol.questions) {
    if (question.id == id && traits_of(question.kind).rated()) return &question;
  }
  return nullptr;
}

/// Sets the scale's range to that of its items' questions. Returns false if the trials do not ask for an
/// item.
bool fit_scale(ScoreScale& scale, const TaskData& data) {
  for (const std::string& item : scale.items) {
    const Question* question = find_question(data, item);
    if (!question) return false;
    scale.min = question->scale_min;
    scale.max = question->scale_max;
  }
  return true;
}

double sum_of_items(const Report& report, const std::vector<std::string>& items) {
  double sum = 0;
  for (const std::string& item : items) {
    const auto answer = report.answers.find(item);
    if (answer == report.answers.end()) return std::numeric_limits<double>::quiet_NaN();
    sum += answer->second;
  }
  return sum;
}

std::vector<OrdinalModel> fit_ordinal(const TaskData& data, const stats::AnalysisPlan& plan) {
  std::vector<OrdinalModel> out;
  const auto& methods = data.protocol.methods;
  const auto hi_res = static_cast<int>(std::find(methods.begin(), methods.end(), "HiRes") - methods.begin());
  const int reference = hi_res < static_cast<int>(methods.size()) ? hi_res : 0;
  std::vector<std::string> questions{"realism"};
  questions.insert(questions.end(), sickness_items.begin(), sickness_items.end());
  for (const std::string& question : questions) {
    if (!find_question(data, question)) continue;
    const auto scores = report_scores(data, {question});
    for (int n_star = 0; n_star < static_cast<int>(data.protocol.n_stars.size()); ++n_star) {
      std::vector<stats::MethodScore> block;
      std::copy_if(scores.begin(), scores.end(), std::back_inserter(block),
                   [&](const stats::MethodScore& score) { return score.n_star == n_star; });
      out.push_back(
          {question, n_star,
           stats::ordinal_effects(block, reference, static_cast<int>(methods.size()), plan.confidence)});
    }
  }
  return out;
}

const stats::ScoreTable* find_table(const std::vector<stats::ScoreTable>& tables, const std::string& code) {
  for (const auto& table : tables) {
    if (table.scale().code == code) return &table;
  }
  return nullptr;
}

/// Tests the claims of Task 1. They need both realism and cybersickness; if one was not asked, they are left
/// out with the reason.
stats::ShownClaims shown_claims(const std::vector<stats::ScoreTable>& tables, const TaskData& data,
                                const stats::AnalysisPlan& plan) {
  const auto* realism = find_table(tables, "realism");
  const auto* sickness = find_table(tables, "sickness");
  if (!realism || !sickness) {
    stats::ShownClaims out;
    leave_out(out.left_out, plan, 1, missing_items(data.protocol.questions));
    return out;
  }
  return stats::claims_about(
      stats::task1_hypotheses(claims_in_force(plan), *realism, *sickness, plan, data.gaze_problem()),
      data.protocol.methods);
}

}  // namespace

std::vector<stats::MethodScore> report_scores(const TaskData& data, const std::vector<std::string>& items) {
  std::vector<stats::MethodScore> out;
  for (const auto* list : {&data.reports, &data.unanswered}) {
    for (const Report& report : *list)
      out.push_back({report.participant, report.scene, report.n_star, report.method,
                     sum_of_items(report, items), static_cast<int>(items.size()), report.position,
                     report.period});
  }
  return out;
}

std::vector<stats::ScoreTable> score_tables(const TaskData& data, const stats::AnalysisPlan& plan) {
  std::vector<stats::ScoreTable> out;
  for (ScoreScale scale : score_scales(plan)) {
    if (!fit_scale(scale, data)) continue;
    const auto scores = report_scores(data, scale.items);
    out.emplace_back(scale, scores, static_cast<int>(data.participants.size()), data.protocol.n_stars,
                     data.protocol.methods);
  }
  return out;
}

std::vector<stats::Hypothesis> task1_verdicts(const TaskData& data, const stats::AnalysisPlan& plan) {
  return shown_claims(score_tables(data, plan), data, plan).claims;
}

Task1Results analyse_task1(const TaskData& data, const stats::AnalysisPlan& plan) {
  Task1Results out;
  out.tables = score_tables(data, plan);
  // The plan's hypotheses compare methods, so they are not tested if effects vary.
  if (data.protocol.effects.empty()) {
    auto hypotheses = shown_claims(out.tables, data, plan);
    out.hypotheses = std::move(hypotheses.claims);
    out.left_out = std::move(hypotheses.left_out);
    stats::add_tipping_points(out.hypotheses, out.tables);
  }
  for (const auto& table : out.tables) out.analyses.push_back(stats::analyse_scores(table, plan));
  out.ordinal = fit_ordinal(data, plan);
  return out;
}

}  // namespace study
