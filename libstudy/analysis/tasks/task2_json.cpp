#include "libstudy/analysis/tasks/task2_json.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "libstudy/analysis/tasks/exploration_json.hpp"
#include "libstudy/analysis/tasks/factors_json.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "stats/analysis/hypotheses.hpp"

namespace study {

namespace {

using Names = std::vector<std::string>;

const std::string& name(const Names& methods, int index) { return methods[static_cast<std::size_t>(index)]; }

const char* repeated_rule(stats::RepeatedPairs rule) {
  switch (rule) {
    case stats::RepeatedPairs::Refuse:
      return "A pair that a participant answered more than once is not tested: answers of one person are not "
             "independent.";
    case stats::RepeatedPairs::Warn:
      return "A pair that a participant answered more than once is tested with a warning: answers of one "
             "person are not independent.";
    case stats::RepeatedPairs::First:
      return "Of a pair that a participant answered more than once, the first answer counts.";
    case stats::RepeatedPairs::Share:
      break;
  }
  return "Of a pair that a participant answered more than once, each person's share is tested against one "
         "half, by an exact test over people.";
}

/// Number of people who answered a pair more than once ("participants"), of all people ("of"), and the most
/// answers of one person to one pair.
Json several_answers_json(const TaskData& data) {
  std::map<std::tuple<int, int, int>, int> answers;
  for (const auto& one : data.choices)
    ++answers[{one.participant, std::min(one.first, one.second), std::max(one.first, one.second)}];
  std::set<int> people;
  int most = 0;
  for (const auto& [key, n] : answers) {
    most = std::max(most, n);
    if (n > 1) people.insert(std::get<0>(key));
  }
  return {{"participants", people.size()}, {"of", data.participants.size()}, {"most", most}};
}

/// Sentences that name the tests used and the rules of the plan that had an effect on the answers.
Json preference_rules_json(const stats::PreferenceAnalysis& analysis, const stats::AnalysisPlan& plan,
                           bool several) {
  const auto& pairs = analysis.pairs;
  const bool shares = std::any_of(pairs.begin(), pairs.end(), [](const auto& one) { return !!one.shares; });
  const bool binomial = std::any_of(pairs.begin(), pairs.end(), [](const auto& one) { return !!one.test; });
  std::string tests;
  if (binomial)
    tests = "Exact binomial test against one half, two-sided; Clopper-Pearson and Wilson intervals. ";
  if (shares)
    tests += "Exact permutation test of people's shares against one half, two-sided" +
             std::string(binomial ? ", of pairs that a person answered more than once. " : ". ");
  Json rules{{"tests", tests +
                           "Holm and Benjamini-Hochberg over all pairs. Stars mark uncorrected p as in the "
                           "paper."}};
  if (several) rules["more_than_one_trial"] = repeated_rule(plan.repeated_pairs);
  rules["missing"] =
      "A pair counts those who answered it, also in sessions that ended early; circular triads those who "
      "answered every pair once.";
  return rules;
}

Json pair_json(const stats::PairPreference& pair, const Names& methods) {
  const bool ok = static_cast<bool>(pair.test);
  const auto p = pair.p();
  Json json{{"a", name(methods, pair.a)},
            {"b", name(methods, pair.b)},
            {"n", pair.n},
            {"participants", pair.participants},
            {"k", pair.k},
            {"test", pair.shares ? Json(stats::share_test_name)
                     : ok        ? Json("exact binomial test")
                                 : Json()},
            {"share", pair.n > 0 ? Json(1.0 * pair.k / pair.n) : Json()},
            {"p", json_number(p)},
            {"stars", json_stars(p)},
            {"p_holm", json_number(pair.p_holm)},
            {"p_bh", json_number(pair.p_bh)},
            {"stars_holm", json_stars(pair.p_holm)},
            {"p_mid", ok ? Json(pair.test->p_mid) : Json()},
            {"clopper_pearson", ok ? json_interval(pair.test->clopper_pearson) : Json()},
            {"wilson", ok ? json_interval(pair.test->wilson) : Json()},
            {"cohen_g", ok ? Json(pair.test->cohen_g) : Json()},
            {"a_first", pair.a_first},
            {"first_chosen", pair.first_chosen},
            {"max_per_participant", pair.max_per_participant},
            {"several", pair.several},
            {"reason", pair.shares ? "" : pair.test.reason()},
            {"warning", pair.warning},
            {"paper", stats::compares_pair(shipped_claims(), name(methods, pair.a), name(methods, pair.b))}};
  if (pair.shares)
    json["by_person"] = {{"participants", pair.shares->participants},
                         {"share", pair.shares->share},
                         {"ci", json_interval(pair.shares->ci)},
                         {"ci_name", pair.shares->ci_name},
                         {"p", pair.shares->p}};
  return json;
}

Json order_term_json(const stats::OrderTerm& term) {
  return {{"estimate", term.estimate},    {"se", term.se},    {"se_independent", term.se_independent},
          {"ci", json_interval(term.ci)}, {"p", term.p_wald}, {"people_df", json_number(term.df)},
          {"chi2", term.lrt_chi2},        {"df", 1},          {"p_independent", term.lrt_p}};
}

Json by_participant_json(const stats::IntervalBias& bias) {
  if (bias.all_alike)
    return {{"test", "exact sign test"},
            {"mean_share", bias.all_alike->value},
            {"ci", Json()},
            {"n", bias.all_alike->n},
            {"t", Json()},
            {"df", Json()},
            {"p", bias.all_alike->p(stats::Alternative::TwoSided, 0.5)}};
  return json_result(bias.by_participant, [](const stats::OneSampleTTest& test) {
    return Json{{"test", "t test"},
                {"mean_share", test.mean},
                {"ci", json_interval(test.ci)},
                {"n", test.n},
                {"t", test.t},
                {"df", test.df},
                {"p", test.p}};
  });
}

Json interval_json(const stats::IntervalBias& bias) {
  const bool ok = static_cast<bool>(bias.test);
  return {{"n", bias.n},
          {"first_chosen", bias.first_chosen},
          {"share", bias.n > 0 ? Json(1.0 * bias.first_chosen / bias.n) : Json()},
          {"p", ok ? Json(bias.test->p) : Json()},
          {"clopper_pearson", ok ? json_interval(bias.test->clopper_pearson) : Json()},
          {"wilson", ok ? json_interval(bias.test->wilson) : Json()},
          {"warning",
           "this test takes all answers as independent; the one over participants' shares holds whatever the "
           "answers of one person have in common"},
          {"by_participant", by_participant_json(bias)}};
}

/// Bias towards the first or second interval, and its drift over the session, as terms of the Bradley-Terry
/// model.
Json order_json(const stats::Result<stats::OrderBias>& model, const Names& methods) {
  if (!model) return json_refused(with_names(model.reason(), methods));
  return json_result(model, [](const stats::OrderBias& bias) {
    Json json = order_term_json(bias.interval);
    json["first_probability"] = bias.first_probability;
    json["first_probability_ci"] = json_interval(bias.first_probability_ci);
    json["drift"] = bias.drift ? order_term_json(*bias.drift) : Json();
    return json;
  });
}

Json abilities_json(const stats::BradleyTerry& model, const Names& methods) {
  Json list = Json::array();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    list.push_back({{"method", methods[i]},
                    {"estimate", model.lambda_sum0[i]},
                    {"se", model.se_sum0[i]},
                    {"se_independent", model.se_sum0_independent[i]},
                    {"ci", json_interval(model.ci_sum0[i])},
                    {"worth", model.worth[i]}});
  }
  return list;
}

Json differences_json(const stats::BradleyTerry& model, const Names& methods) {
  Json list = Json::array();
  for (const auto& pair : model.pairs) {
    list.push_back({{"a", name(methods, pair.i)},
                    {"b", name(methods, pair.j)},
                    {"estimate", pair.difference},
                    {"se", pair.se},
                    {"se_independent", pair.se_independent},
                    {"ci", json_interval(pair.ci)},
                    {"p", pair.p},
                    {"probability", pair.probability},
                    {"probability_ci", json_interval(pair.probability_ci)}});
  }
  return list;
}

/// How the model's standard errors were computed (over people, or as if answers were independent), and Wald's
/// test over people that all methods are equal.
Json people_json(const stats::BradleyTerry& model) {
  const auto& test = model.equal_over_people;
  return {{"errors", model.people_df ? "people" : "independent answers"},
          {"people_df", json_number(model.people_df)},
          {"why_independent", model.why_independent},
          {"equal",
           test ? Json{{"f", test->f}, {"df1", test->df1}, {"df2", test->df2}, {"p", test->p}} : Json()}};
}

Json bradley_terry_json(const stats::PreferenceAnalysis& analysis, const Names& methods) {
  Json json = json_result(analysis.bradley_terry, [&](const stats::BradleyTerry& model) {
    return Json{
        {"penalised", model.bias_reduced},
        {"why_penalised", with_names(model.why_bias_reduced, methods)},
        {"people", people_json(model)},
        {"abilities", abilities_json(model, methods)},
        {"differences", differences_json(model, methods)},
        {"overall", {{"chi2", model.lrt_chi2}, {"df", model.lrt_df}, {"p", model.lrt_p}}},
        {"fit", {{"chi2", model.gof_deviance}, {"df", model.gof_df}, {"p", json_number(model.gof_p)}}}};
  });
  if (json.contains("refused")) json["refused"] = with_names(analysis.bradley_terry.reason(), methods);
  json["order"] = order_json(analysis.interval.model, methods);
  return json;
}

Json triads_json(const TaskData& data, const stats::PreferenceAnalysis& analysis) {
  Json people = Json::array();
  int incomplete = 0;
  for (const auto& one : analysis.triads) {
    if (!one.triads) {
      ++incomplete;
      continue;
    }
    people.push_back({{"participant", data.participants[static_cast<std::size_t>(one.participant)]},
                      {"circular", one.triads->triads},
                      {"consistency", one.triads->zeta},
                      {"p", one.triads->p}});
  }
  Json json{{"participants", people}, {"incomplete", incomplete}, {"n", people.size()}};
  if (!analysis.group_triads) {
    json["refused"] = analysis.group_triads.reason();
    return json;
  }
  const auto& group = *analysis.group_triads;
  json["mean"] = 1.0 * group.triads / group.participants;
  json["mean_consistency"] = group.mean_zeta;
  json["expected"] = group.expected / group.participants;
  json["p"] = group.p;
  return json;
}

Json by_scene_json(const TaskData& data) {
  std::map<std::tuple<int, int, int>, std::pair<int, int>> cells;  // answers, choices of a
  for (const auto& choice : data.choices) {
    const int a = std::min(choice.first, choice.second), b = std::max(choice.first, choice.second);
    auto& [n, k] = cells[{choice.scene, a, b}];
    ++n;
    k += choice.first_chosen == (choice.first == a) ? 1 : 0;
  }
  Json list = Json::array();
  for (const auto& [key, counts] : cells) {
    const auto& [scene, a, b] = key;
    list.push_back({{"scene", data.scenes[static_cast<std::size_t>(scene)]},
                    {"a", name(data.protocol.methods, a)},
                    {"b", name(data.protocol.methods, b)},
                    {"n", counts.first},
                    {"k", counts.second}});
  }
  return list;
}

Json choices_json(const TaskData& data) {
  Json list = Json::array();
  for (const auto& choice : data.choices) {
    list.push_back(
        {{"participant", data.participants[static_cast<std::size_t>(choice.participant)]},
         {"scene", data.scenes[static_cast<std::size_t>(choice.scene)]},
         {"position", choice.position},
         {"first", name(data.protocol.methods, choice.first)},
         {"second", name(data.protocol.methods, choice.second)},
         {"chosen", name(data.protocol.methods, choice.first_chosen ? choice.first : choice.second)}});
  }
  return list;
}

}  // namespace

Json task2_json(const TaskData& data, const stats::PreferenceAnalysis& analysis,
                const stats::AnalysisPlan& plan) {
  const Names& methods = data.protocol.methods;
  Json pairs = Json::array();
  for (const auto& pair : analysis.pairs) pairs.push_back(pair_json(pair, methods));
  const Json several = several_answers_json(data);
  const bool any_several = several.at("participants") > 0;
  Json json{{"participants", data.participants.size()},
            {"answers", data.choices.size()},
            {"question", data.question.id},
            {"methods", methods},
            {"n_stars", data.protocol.n_stars},
            {"scenes", data.scenes},
            {"rules", preference_rules_json(analysis, plan, any_several)},
            {"several_answers", several},
            {"pairs", pairs},
            {"interval_bias", interval_json(analysis.interval)},
            {"bradley_terry", bradley_terry_json(analysis, methods)},
            {"triads", triads_json(data, analysis)},
            {"by_scene", by_scene_json(data)},
            {"choices", choices_json(data)},
            {"detectable", detectable_preference_json(analysis, plan)},
            {"retest", choice_retest_json(data)}};
  if (Json factors = preference_factors_json(data, plan); !factors.empty()) json["factors"] = factors;
  return json;
}

}  // namespace study
