#include "apps/common/claims.hpp"

#include <algorithm>
#include <string>

namespace apps {

namespace {

void add_once(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

/// Questions that the trials of the design ask.
std::vector<study::Question> asked_questions(const study::Protocol& protocol) {
  std::vector<study::Question> out;
  for (const auto& block : protocol.blocks) {
    if (block.kind != study::BlockKind::Stimulus) continue;
    for (const auto& step : block.steps) {
      for (const auto& [place, question] : study::all_questions(protocol)) {
        if (std::find(step.asks.begin(), step.asks.end(), question->id) != step.asks.end())
          out.push_back(*question);
      }
    }
  }
  return out;
}

bool asks_scale(const std::vector<study::Question>& asked, const std::string& id) {
  return std::any_of(asked.begin(), asked.end(), [&](const study::Question& one) {
    return one.id == id && one.kind == study::AnswerKind::Scale;
  });
}

/// Why neither H1 to H3 nor H4 to H6 are about this protocol, as far as its methods do not decide; empty:
/// they may be.
std::string why_none(const study::Protocol& protocol) {
  const auto asked = asked_questions(protocol);
  if (!protocol.design.effects.empty())
    return "effects are a factor, and H1 to H6 are about methods alone; what each level is worth is "
           "exploratory";
  if (protocol.design.timing == study::TimingSource::Settings)
    return curve_questions(protocol).empty() ? "no scale is asked about the frame rates"
                                             : "the study estimates a and b of mu = a exp(b delta)";
  if (protocol.design.pairs) {
    const bool chosen = std::any_of(asked.begin(), asked.end(), [](const study::Question& one) {
      return one.kind == study::AnswerKind::Choice && one.anchors.size() == 2;
    });
    return chosen ? "" : "no choice between the two of a pair is asked";
  }
  return missing_items(asked);
}

}  // namespace

std::string missing_items(const std::vector<study::Question>& asked) {
  std::vector<std::string> missing;
  for (const std::string id : {"realism", "disorientation", "unrealism", "dizziness", "confusion"})
    if (!asks_scale(asked, id)) missing.push_back("'" + id + "'");
  std::string out;
  for (std::size_t i = 0; i < missing.size(); ++i)
    out += (i == 0 ? "" : i + 1 == missing.size() ? " or " : ", ") + missing[i];
  return out.empty() ? "" : "the trials ask no question " + out + " on a scale";
}

bool is_sickness(const study::Question& question) {
  return question.id == "fms" || question.id.starts_with("ssq_");
}

std::vector<study::Question> curve_questions(const study::Protocol& protocol) {
  std::vector<study::Question> out;
  if (protocol.design.timing != study::TimingSource::Settings || protocol.design.pairs) return out;
  for (const auto& question : asked_questions(protocol))
    if (question.kind == study::AnswerKind::Scale && !is_sickness(question)) out.push_back(question);
  return out;
}

stats::ShownClaims hypotheses_of(const study::Protocol& protocol, const stats::AnalysisPlan& plan) {
  if (const std::string why = why_none(protocol); !why.empty()) return {{}, {{"H1 to H6", why}}};
  std::vector<std::string> methods, n_stars;
  for (const auto& cell : protocol.design.cells) {
    add_once(methods, cell.stimulus.method);
    add_once(n_stars, cell.stimulus.n_star);
  }
  if (!protocol.design.pairs) {
    stats::ScoreScale realism, sickness;
    realism.code = "realism";
    realism.margin = plan.margin_realism;
    sickness.code = "sickness";
    sickness.margin = plan.margin_sickness;
    sickness.max = 3;
    sickness.min = 0;
    sickness.higher_is_better = false;
    return stats::claims_about(stats::task1_hypotheses({realism, {}, 0, n_stars, methods},
                                                       {sickness, {}, 0, n_stars, methods}, plan, ""),
                               methods);
  }
  std::vector<stats::PairPreference> pairs;
  for (int a = 0; a < static_cast<int>(methods.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(methods.size()); ++b) {
      pairs.emplace_back();
      pairs.back().a = a;
      pairs.back().b = b;
      pairs.back().test = stats::Refusal{"no data"};
    }
  }
  return stats::claims_about(stats::task2_hypotheses(pairs, methods, plan, ""), methods);
}

}  // namespace apps
