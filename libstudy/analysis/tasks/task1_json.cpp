#include "libstudy/analysis/tasks/task1_json.hpp"

#include <cmath>

#include "libstudy/analysis/tasks/exploration_json.hpp"
#include "libstudy/analysis/tasks/factors_json.hpp"
#include "libstudy/analysis/tasks/missing_json.hpp"

namespace study {

namespace {

using stats::ScoreTable;

Json score_rules_json() {
  return {
      {"averaging",
       "The reports of one participant at one n_* on one method are averaged over scenes before any paired "
       "test; a cybersickness score is the mean of its items, and a report that lacks an item has none."},
      {"missing",
       "A test of two methods uses the participants with both; Friedman's test and the analysis of variance "
       "those with every method; the ordinal and the mixed model every answer. A session that ended early "
       "counts with what it has."},
      {"outliers", "Values beyond 1.5 interquartile ranges are drawn and listed; none is left out."},
      {"tests",
       "Paired t tests, two-sided, within each n_*; Holm and Benjamini-Hochberg over the pairs of methods of "
       "one score at one n_*; Welch's test (as if groups were independent) and Wilcoxon's signed-rank test "
       "beside. The effects of an ordinal model are corrected in the same way over the methods of one "
       "question at "
       "one n_*. Stars mark uncorrected p as in the paper."}};
}

Json score_json(const stats::ScoreScale& scale) {
  return {{"code", scale.code},   {"label", scale.label},  {"primary", scale.primary},
          {"min", scale.min},     {"max", scale.max},      {"higher_is_better", scale.higher_is_better},
          {"items", scale.items}, {"margin", scale.margin}};
}

Json normality_json(const stats::Result<stats::ShapiroWilk>& test) {
  return json_result(test, [](const stats::ShapiroWilk& one) { return Json{{"w", one.w}, {"p", one.p}}; });
}

/// Adds the BCa interval; if it is refused, null and the reason.
void add_bootstrap(Json& json, const stats::Result<stats::BootstrapInterval>& bootstrap) {
  json["bca"] = bootstrap ? json_interval(bootstrap->bca.ci) : Json();
  if (!bootstrap) json["bca_reason"] = bootstrap.reason();
}

Json cell_json(const ScoreTable& table, const stats::MethodCell& cell) {
  Json json{{"score", table.scale().code},
            {"n_star", table.n_stars()[static_cast<std::size_t>(cell.n_star)]},
            {"method", table.methods()[static_cast<std::size_t>(cell.method)]},
            {"n", cell.values.size()},
            {"mean", cell.summary ? Json(cell.summary->mean) : Json()},
            {"sd", cell.summary ? json_number(cell.summary->sd) : Json()},
            {"ci", cell.mean ? json_interval(cell.mean->ci) : Json()}};
  add_bootstrap(json, cell.bootstrap);
  json["median"] = cell.box ? Json(cell.box->median) : Json();
  json["q1"] = cell.box ? Json(cell.box->q25) : Json();
  json["q3"] = cell.box ? Json(cell.box->q75) : Json();
  json["whisker_low"] = cell.box ? Json(cell.box->low_whisker) : Json();
  json["whisker_high"] = cell.box ? Json(cell.box->high_whisker) : Json();
  json["outliers"] = cell.outliers;
  json["values"] = cell.values;
  json["normality"] = normality_json(cell.normality);
  return json;
}

Json welch_json(const stats::Result<stats::IndependentTTest>& test) {
  return json_result(test, [](const stats::IndependentTTest& one) {
    return Json{{"t", one.t}, {"df", one.df}, {"p", one.p}};
  });
}

Json wilcoxon_json(const stats::MethodComparison& comparison) {
  return json_result(comparison.wilcoxon, [&](const stats::SignedRank& one) {
    Json json = signed_rank_json(one);
    json["p_holm"] = json_number(comparison.wilcoxon_p_holm);
    json["p_bh"] = json_number(comparison.wilcoxon_p_bh);
    return json;
  });
}

Json equivalence_json(const stats::Result<stats::EquivalenceTest>& test, double margin, double alpha) {
  return json_result(test, [&](const stats::EquivalenceTest& one) {
    return Json{{"margin", margin},
                {"p", one.p},
                {"ci", json_interval(one.ci)},
                {"ci_confidence", 1 - 2 * alpha},
                {"equivalent", one.p < alpha}};
  });
}

/// Adds the paired t test. If all differences are equal, the exact sign test gives p instead. The other
/// values are null if the t test is refused.
void add_t_test(Json& json, const stats::MethodComparison& comparison) {
  const bool ok = static_cast<bool>(comparison.t);
  const auto number = [&](double stats::PairedTTest::*field) {
    return ok ? json_number((*comparison.t).*field) : Json();
  };
  const std::optional<double> p = comparison.p();
  const auto& all = comparison.unanimous;
  json["test"] = ok ? Json("paired t test") : all ? Json("exact sign test") : Json();
  json["difference"] = ok ? json_number(comparison.t->estimate) : all ? Json(all->value) : Json();
  json["ci"] = ok ? json_interval(comparison.t->ci) : Json();
  json["t"] = ok ? json_number(comparison.t->t) : Json();
  json["df"] = ok ? json_number(comparison.t->df) : Json();
  json["p"] = json_number(p);
  json["stars"] = json_stars(p);
  json["p_holm"] = json_number(comparison.p_holm);
  json["p_bh"] = json_number(comparison.p_bh);
  json["stars_holm"] = json_stars(comparison.p_holm);
  json["sd_difference"] = number(&stats::PairedTTest::sd_difference);
  json["d_z"] = number(&stats::PairedTTest::cohen_dz);
  json["d_z_ci"] = ok ? json_interval(comparison.t->cohen_dz_ci) : Json();
  json["g"] = ok ? json_number(comparison.t->hedges_gz) : Json();
  json["g_ci"] = ok ? json_interval(comparison.t->hedges_gz_ci) : Json();
  json["reason"] = comparison.t.reason();
}

Json comparison_json(const ScoreTable& table, const stats::MethodComparison& one, double alpha) {
  Json json{{"score", table.scale().code},
            {"n_star", table.n_stars()[static_cast<std::size_t>(one.n_star)]},
            {"a", table.methods()[static_cast<std::size_t>(one.a)]},
            {"b", table.methods()[static_cast<std::size_t>(one.b)]},
            {"n", one.n},
            {"n_missing", one.n_missing},
            {"mean_a", json_number(one.mean_a)},
            {"mean_b", json_number(one.mean_b)}};
  add_t_test(json, one);
  add_bootstrap(json, one.bootstrap);
  json["normality"] = normality_json(one.normality);
  json["welch"] = welch_json(one.welch);
  json["wilcoxon"] = wilcoxon_json(one);
  json["tost"] = equivalence_json(one.equivalence, table.scale().margin, alpha);
  add_missing_data(json, table, one, alpha);
  return json;
}

Json friedman_json(const stats::Friedman& test) {
  return {{"chi2", test.chi2}, {"df", test.df}, {"p", test.p}, {"kendall_w", test.kendall_w}};
}

Json anova_json(const stats::RepeatedAnova& test) {
  return {{"f", test.f},
          {"df1", test.df1},
          {"df2", test.df2},
          {"p", test.p},
          {"epsilon_gg", test.epsilon_gg},
          {"p_gg", test.p_gg},
          {"epsilon_hf", json_number(test.epsilon_hf_capped())},
          {"epsilon_hf_uncapped", json_number(test.epsilon_hf)},
          {"p_hf", json_number(test.p_hf)},
          {"partial_eta2", test.partial_eta2},
          {"generalised_eta2", test.generalized_eta2}};
}

Json omnibus_json(const ScoreTable& table, const stats::Omnibus& one) {
  return {{"score", table.scale().code},
          {"n_star", table.n_stars()[static_cast<std::size_t>(one.n_star)]},
          {"n", one.n},
          {"n_incomplete", one.n_incomplete},
          {"friedman", json_result(one.friedman, friedman_json)},
          {"anova", json_result(one.anova, anova_json)}};
}

/// Each participant's mean of each score: one entry for each participant, n_* and method with a score.
Json participant_means_json(const TaskData& data, const std::vector<ScoreTable>& tables) {
  Json list = Json::array();
  for (std::size_t person = 0; person < data.participants.size(); ++person) {
    for (int n_star = 0; n_star < static_cast<int>(data.protocol.n_stars.size()); ++n_star) {
      for (int method = 0; method < static_cast<int>(data.protocol.methods.size()); ++method) {
        Json line{{"participant", data.participants[person]},
                  {"n_star", data.protocol.n_stars[static_cast<std::size_t>(n_star)]},
                  {"method", data.protocol.methods[static_cast<std::size_t>(method)]}};
        bool any = false;
        for (const ScoreTable& table : tables) {
          const double value = table.column(n_star, method)[person];
          line[table.scale().code] = json_number(value);
          any = any || !std::isnan(value);
        }
        if (any) list.push_back(std::move(line));
      }
    }
  }
  return list;
}

Json ordinal_effects_json(const stats::OrdinalEffects& effects, const std::vector<std::string>& methods) {
  Json list = Json::array();
  for (const auto& effect : effects.effects) {
    list.push_back({{"method", methods[static_cast<std::size_t>(effect.method)]},
                    {"estimate", effect.estimate},
                    {"se", effect.se},
                    {"ci", json_interval(effect.ci)},
                    {"z", effect.z},
                    {"p", effect.p},
                    {"p_holm", json_number(effect.p_holm)},
                    {"p_bh", json_number(effect.p_bh)},
                    {"odds_ratio", json_number(std::exp(effect.estimate))}});
  }
  return list;
}

Json ordinal_model_json(const TaskData& data, const OrdinalModel& model) {
  Json json{{"question", model.question},
            {"n_star", data.protocol.n_stars[static_cast<std::size_t>(model.n_star)]}};
  if (!model.effects) {
    json["refused"] = with_names(model.effects.reason(), data.protocol.methods);
    return json;
  }
  const auto& effects = *model.effects;
  json["link"] = stats::link_name(effects.fit.link);
  json["reference"] = data.protocol.methods[static_cast<std::size_t>(effects.reference)];
  json["n"] = effects.fit.n;
  json["participants"] = effects.fit.participants;
  json["participant_sd"] = effects.fit.sd_participant;
  json["log_likelihood"] = effects.fit.log_likelihood;
  json["penalty"] = effects.fit.why_penalised.empty() ? "" : "log-F(1, 1)";
  json["why_penalised"] = with_names(effects.fit.why_penalised, data.protocol.methods);
  json["thresholds"] = effects.fit.thresholds;
  json["effects"] = ordinal_effects_json(effects, data.protocol.methods);
  json["overall"] = json_result(effects.overall, [](const stats::LikelihoodRatio& ratio) {
    return Json{{"chi2", ratio.chi2}, {"df", ratio.df}, {"p", ratio.p}};
  });
  return json;
}

}  // namespace

Json signed_rank_json(const stats::SignedRank& test) {
  return {{"w", test.w_plus},
          {"p", test.p()},
          {"method", test.p_exact ? "exact" : "normal, with ties and continuity corrected"},
          {"p_exact", json_number(test.p_exact)},
          {"p_normal", test.p_normal},
          {"location", test.hodges_lehmann},
          {"ci", json_interval(test.hodges_lehmann_ci)},
          {"ci_level", test.hodges_lehmann_ci ? Json(test.hodges_lehmann_level) : Json()},
          {"ci_reason",
           test.hodges_lehmann_ci ? "" : "more differences than the exact distribution is computed for"},
          {"rank_biserial", test.rank_biserial},
          {"n_used", test.n_nonzero},
          {"n_zero", test.n - test.n_nonzero}};
}

Json task1_json(const TaskData& data, const Task1Results& results, const stats::AnalysisPlan& plan) {
  Json json{{"participants", data.participants.size()},
            {"reports", data.reports.size()},
            {"methods", data.protocol.methods},
            {"n_stars", data.protocol.n_stars},
            {"scenes", data.scenes},
            {"rules", score_rules_json()}};
  for (const char* list :
       {"scores", "cells", "by_scene", "people", "comparisons", "mixed", "omnibus", "ordinal"})
    json[list] = Json::array();
  for (std::size_t i = 0; i < results.tables.size(); ++i) {
    const ScoreTable& table = results.tables[i];
    const auto& analysis = results.analyses[i];
    json["scores"].push_back(score_json(table.scale()));
    for (const auto& cell : analysis.cells) json["cells"].push_back(cell_json(table, cell));
    for (const auto& line : score_by_scene_json(data, table, plan.confidence))
      json["by_scene"].push_back(line);
    for (const auto& one : analysis.comparisons)
      json["comparisons"].push_back(comparison_json(table, one, plan.alpha));
    for (const auto& one : analysis.omnibus) json["omnibus"].push_back(omnibus_json(table, one));
    json["mixed"].push_back(mixed_json(data, table, analysis.mixed, plan.confidence));
    for (const auto& one : analysis.people) json["people"].push_back(people_json(table, one));
  }
  for (const auto& model : results.ordinal) json["ordinal"].push_back(ordinal_model_json(data, model));
  json["participant_means"] = participant_means_json(data, results.tables);
  json["by_n_star"] = n_star_differences_json(results.tables, plan);
  json["distributions"] = distributions_json(data);
  json["reliability"] = reliability_json(data, results.tables, plan);
  json["detectable"] = detectable_scores_json(results.tables, results.analyses, plan);
  json["retest"] = rating_retest_json(data);
  if (Json factors = score_factors_json(data, results.tables, plan); !factors.empty())
    json["factors"] = factors;
  return json;
}

}  // namespace study
