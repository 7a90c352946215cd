#include "libstudy/analysis/claims.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "libstudy/protocol/method_claims.hpp"

namespace study {

namespace {

void add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

/// Questions that the steps of the stimulus block ask, in the order of the steps.
std::vector<Question> asked_questions(const Protocol& protocol) {
  std::vector<Question> out;
  for (const auto& block : protocol.blocks) {
    if (block.kind != BlockKind::Stimulus) continue;
    for (const auto& step : block.steps) {
      for (const auto& [place, question] : all_questions(protocol)) {
        if (std::find(step.asks.begin(), step.asks.end(), question->id) != step.asks.end())
          out.push_back(*question);
      }
    }
  }
  return out;
}

bool asks_scale(const std::vector<Question>& asked, const std::string& id) {
  return std::any_of(asked.begin(), asked.end(),
                     [&](const Question& one) { return one.id == id && traits_of(one.kind).rated(); });
}

/// The reason why no hypothesis about methods applies to the protocol; empty if some may apply.
std::string why_none(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (!protocol.design.effects.empty())
    return "effects are a factor, and " + ids_in_short(ids_of(claims_in_force(plan))) +
           " are about methods alone; what each level is worth is exploratory";
  if (varies_surface(protocol.design))
    return "the surface is a factor, and " + ids_in_short(ids_of(claims_in_force(plan))) +
           " are about methods alone";
  if (protocol.design.timing == TimingSource::Settings)
    return curve_questions(protocol).empty() ? "no scale is asked about the frame rates"
                                             : "the study estimates a and b of mu = a exp(b delta)";
  return "";
}

bool asks_choice_of_pair(const Protocol& protocol) {
  const auto asked = asked_questions(protocol);
  return std::any_of(asked.begin(), asked.end(), [](const Question& one) {
    return traits_of(one.kind).labelled && one.anchors.size() == 2;
  });
}

stats::ShownClaims all_left_out(const stats::AnalysisPlan& plan, std::optional<int> task,
                                const std::string& reason) {
  stats::ShownClaims out;
  leave_out(out.left_out, plan, task, reason);
  return out;
}

struct ShownMethods {
  std::vector<std::string> methods, n_stars;
};

ShownMethods shown_by(const Protocol& protocol) {
  ShownMethods out;
  for (const auto& cell : protocol.design.cells) {
    add_once(out.methods, cell.stimulus.method);
    add_once(out.n_stars, cell.stimulus.n_star);
  }
  return out;
}

stats::ShownClaims claims_of_ratings(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  const std::string missing =
      protocol.design.pairs ? methods_in_pairs : missing_items(asked_questions(protocol));
  if (!missing.empty()) return all_left_out(plan, 1, missing);
  const ShownMethods shown = shown_by(protocol);
  stats::ScoreScale realism, sickness;
  realism.code = "realism";
  realism.margin = plan.margin_realism;
  sickness.code = "sickness";
  sickness.margin = plan.margin_sickness;
  sickness.max = 3;
  sickness.min = 0;
  sickness.higher_is_better = false;
  return stats::claims_about(
      stats::task1_hypotheses(claims_in_force(plan), {realism, {}, 0, shown.n_stars, shown.methods},
                              {sickness, {}, 0, shown.n_stars, shown.methods}, plan, ""),
      shown.methods);
}

stats::ShownClaims claims_of_pairs(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (!protocol.design.pairs) return all_left_out(plan, 2, no_pairs);
  if (!asks_choice_of_pair(protocol)) return all_left_out(plan, 2, no_choice_of_pair);
  const auto methods = shown_by(protocol).methods;
  std::vector<stats::PairPreference> pairs;
  for (int a = 0; a < static_cast<int>(methods.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(methods.size()); ++b) {
      pairs.emplace_back();
      pairs.back().a = a;
      pairs.back().b = b;
      pairs.back().test = stats::Refusal{"no data"};
    }
  }
  return stats::claims_about(stats::task2_hypotheses(claims_in_force(plan), pairs, methods, plan, ""),
                             methods);
}

}  // namespace

void leave_out(std::vector<stats::ShownClaims::LeftOut>& left_out, const stats::AnalysisPlan& plan,
               std::optional<int> task, const std::string& reason) {
  const MethodClaims& all = claims_in_force(plan);
  const auto ids = ids_of(task ? claims_of_task(all, *task) : all);
  if (!ids.empty()) left_out.push_back({ids_in_short(ids), reason, ids});
}

std::string missing_items(const std::vector<Question>& asked) {
  std::vector<std::string> missing;
  for (const std::string id : {"realism", "disorientation", "unrealism", "dizziness", "confusion"})
    if (!asks_scale(asked, id)) missing.push_back("'" + id + "'");
  std::string out;
  for (std::size_t i = 0; i < missing.size(); ++i)
    out += (i == 0 ? "" : i + 1 == missing.size() ? " or " : ", ") + missing[i];
  return out.empty() ? "" : "the trials ask no question " + out + " on a scale";
}

bool is_sickness(const Question& question) { return question.id == "fms" || question.id.starts_with("ssq_"); }

std::vector<Question> curve_questions(const Protocol& protocol) {
  std::vector<Question> out;
  if (protocol.design.timing != TimingSource::Settings || protocol.design.pairs) return out;
  for (const auto& question : asked_questions(protocol))
    if (traits_of(question.kind).rated() && !is_sickness(question)) out.push_back(question);
  return out;
}

bool compares_scores(const Protocol& protocol, const std::vector<std::string>& items) {
  std::vector<std::string> treatments;
  for (const auto& cell : protocol.design.cells) add_once(treatments, treatment_name(cell.stimulus));
  const auto asked = asked_questions(protocol);
  return !protocol.design.pairs && treatments.size() > 1 && asks_scale(asked, "realism") &&
         std::all_of(items.begin(), items.end(),
                     [&](const std::string& item) { return asks_scale(asked, item); });
}

stats::ShownClaims hypotheses_of(const Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (const std::string why = why_none(protocol, plan); !why.empty()) return all_left_out(plan, {}, why);
  auto out = claims_of_ratings(protocol, plan);
  auto of_pairs = claims_of_pairs(protocol, plan);
  std::move(of_pairs.claims.begin(), of_pairs.claims.end(), std::back_inserter(out.claims));
  std::move(of_pairs.left_out.begin(), of_pairs.left_out.end(), std::back_inserter(out.left_out));
  return out;
}

}  // namespace study
