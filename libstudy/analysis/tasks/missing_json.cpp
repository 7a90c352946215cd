#include "libstudy/analysis/tasks/missing_json.hpp"

#include "stats/inference/distributions.hpp"

namespace study {

namespace {

using stats::ScoreTable;

Json contrast_json(const stats::MixedContrast& one) {
  return {{"estimate", one.estimate},    {"se", one.se}, {"df", one.df}, {"t", one.t},
          {"ci", json_interval(one.ci)}, {"p", one.p}};
}

/// Label of one term of the mixed model: "scene jet_impact", "position" or "period 2".
std::string term_label(const TaskData& data, const std::string& term) {
  const auto number = [&](std::size_t prefix) { return std::stoul(term.substr(prefix)); };
  if (term.starts_with("scene")) return "scene " + data.scenes[number(5)];
  if (term.starts_with("period")) return "period " + std::to_string(number(6) + 1);
  return term;
}

bool is_cell(const std::string& term) { return term.starts_with("n_star"); }

Json terms_json(const TaskData& data, const stats::LinearMixedFit& fit, double confidence) {
  Json list = Json::array();
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    if (is_cell(fit.terms[i])) continue;
    std::vector<double> weights(fit.terms.size());
    weights[i] = 1;
    Json term{{"term", term_label(data, fit.terms[i])}};
    term.update(contrast_json(fit.contrast(weights, confidence)));
    list.push_back(std::move(term));
  }
  return list;
}

Json answers_json(const stats::MissingAnswers& one) {
  return {{"missing", one.missing},
          {"worse_by", json_number(one.shift)},
          {"room", one.room},
          {"within_scale", one.within_scale()}};
}

/// Tipping point of a comparison: by how many points missing answers must be worse than expected before the
/// decision changes. The decision is by the paired t test, or by the exact sign test if all differences are
/// equal.
Json pair_tipping_json(const ScoreTable& table, const stats::MethodComparison& one, double alpha) {
  if (one.unanimous)
    return json_result(stats::no_tipping_point(table, one.n_star, one.a, one.b, *one.p() < alpha),
                       tipping_json);
  if (!one.t) return json_refused(one.t.reason());
  const double half = stats::student_upper_quantile(0.5 * alpha, one.t->df) * one.t->stderr_estimate;
  return json_result(stats::tipping_point_two_sided(table, one.n_star, one.a, one.b, one.t->estimate, half),
                     tipping_json);
}

}  // namespace

Json tipping_json(const stats::TippingPoint& tipping) {
  return {{"planned", tipping.planned},
          {"holds", tipping.holds},
          {"a", answers_json(tipping.a)},
          {"b", answers_json(tipping.b)},
          {"reason", tipping.reason}};
}

void add_missing_data(Json& comparison, const ScoreTable& table, const stats::MethodComparison& one,
                      double alpha) {
  comparison["mixed"] = json_result(one.mixed, [&](const stats::MixedContrast& contrast) {
    Json json = contrast_json(contrast);
    json["p_holm"] = json_number(one.mixed_p_holm);
    json["p_bh"] = json_number(one.mixed_p_bh);
    return json;
  });
  comparison["tipping"] = pair_tipping_json(table, one, alpha);
}

Json mixed_json(const TaskData& data, const ScoreTable& table, const stats::Result<stats::MixedScores>& model,
                double confidence) {
  Json json{{"score", table.scale().code}};
  if (!model) {
    json["refused"] = model.reason();
    return json;
  }
  const auto& fit = model->fit;
  json["n"] = fit.n;
  json["participants"] = fit.participants;
  json["criterion"] = fit.criterion;
  json["sd_participant"] = fit.sd_participant;
  json["sd_method"] = json_number(fit.sd_thing);
  json["sd_residual"] = fit.sd_residual;
  json["singular"] = fit.singular;
  json["terms"] = terms_json(data, fit, confidence);
  json["left_out"] = Json::array();
  for (const auto& term : fit.left_out) json["left_out"].push_back(term_label(data, term));
  return json;
}

Json people_json(const ScoreTable& table, const stats::PairPeople& people) {
  return {{"score", table.scale().code}, {"n_star", table.n_stars()[static_cast<std::size_t>(people.n_star)]},
          {"planned", people.planned},   {"any", people.any},
          {"all", people.all},           {"fewest", people.fewest},
          {"most", people.most},         {"differ", people.differ}};
}

}  // namespace study
