#include "libstudy/analysis/tasks/study_results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "libstudy/analysis/plan_hypotheses.hpp"
#include "libstudy/analysis/tasks/data_json.hpp"
#include "libstudy/analysis/tasks/station_timing.hpp"
#include "libstudy/analysis/tasks/study_tables.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/gsl_errors.hpp"

namespace study {

namespace {

using stats::DeclaredHypothesis;
using stats::TestKind;

constexpr const char* study_schema = "vip-study/1";

bool has_factors(const TaskProtocol& protocol) {
  return protocol.whole && !protocol.whole->design.factors.empty();
}

/// Mean over the participants with a value.
Json mean_json(const std::vector<stats::ExactMean>& values) {
  double sum = 0;
  int n = 0;
  for (const auto& one : values) {
    if (one.value() != one.value()) continue;
    sum += one.value();
    ++n;
  }
  return n > 0 ? Json(sum / n) : Json();
}

struct TestedHypothesis {
  const DeclaredHypothesis* declared = nullptr;
  OutcomeValue value = OutcomeValue::Mean;
  Json mean_a = {}, mean_b = {};
  stats::Result<stats::TestOutcome> outcome = stats::Refusal{"not computed"};
  double p_adjusted = std::numeric_limits<double>::quiet_NaN();  ///< NaN: refused
};

TestedHypothesis test_hypothesis(const TaskData& data, const DeclaredHypothesis& declared,
                                 const std::vector<PersonTrack>& tracks) {
  TestedHypothesis out{&declared};
  std::vector<CellAnswer> answers;
  const auto question = std::find_if(data.protocol.questions.begin(), data.protocol.questions.end(),
                                     [&](const Question& one) { return one.id == declared.outcome; });
  if (declared.outcome == stats::threshold_outcome && data.protocol.whole->design.procedure) {
    out.value = OutcomeValue::Threshold;
    answers = threshold_values(data, tracks);
  } else if (question != data.protocol.questions.end()) {
    out.value = value_of(data.protocol.whole->design, *question);
    answers = cell_answers(data, *question, declared.positive);
  }
  const ConditionValues values = condition_values(data, declared, answers);
  out.mean_a = mean_json(values.a);
  out.mean_b = declared.compare.size() > 1 ? mean_json(values.b) : Json();
  out.outcome = stats::of_answers(declared.test.kind)
                    ? stats::run_declared(declared.test, condition_rows(data, declared, answers))
                    : stats::run_declared(declared.test, values.a, values.b);
  return out;
}

/// Adjusts p within each family; a hypothesis without a family is adjusted alone. A refused test counts as p
/// = 1.
void adjust_families(std::vector<TestedHypothesis>& tested) {
  std::map<std::string, std::vector<std::size_t>> families;
  for (std::size_t i = 0; i < tested.size(); ++i) {
    const std::string& family = tested[i].declared->family;
    families[family.empty() ? "/" + std::to_string(i) : family].push_back(i);
  }
  for (const auto& [name, members] : families) {
    std::vector<double> p;
    for (const std::size_t i : members)
      p.push_back(tested[i].outcome ? tested[i].outcome->p : std::numeric_limits<double>::quiet_NaN());
    const auto adjusted = stats::adjust(p, tested[members.front()].declared->adjust, members.size());
    for (std::size_t k = 0; adjusted && k < members.size(); ++k)
      tested[members[k]].p_adjusted = adjusted->p[k];
  }
}

std::vector<TestedHypothesis> test_all(const TaskData& data, const stats::AnalysisPlan& plan) {
  const auto tracks = person_tracks(data);
  std::vector<TestedHypothesis> out;
  for (const DeclaredHypothesis& one : plan.hypotheses) out.push_back(test_hypothesis(data, one, tracks));
  adjust_families(out);
  return out;
}

/// Confidence of a hypothesis's interval. For TOST it is 2 c - 1 at confidence c, since each of its two tests
/// is one-sided.
double ci_confidence(const DeclaredHypothesis& one) {
  constexpr double digits = 1e12;  // rounds to 12 decimals: 2 x 0.95 - 1 gives 0.9, not 0.8999999999999999
  return one.test.kind == TestKind::Tost ? std::round((2 * one.test.confidence - 1) * digits) / digits
                                         : one.test.confidence;
}

Json tested_json(const TestedHypothesis& one, double alpha, bool preregistered) {
  Json json = declared_json(*one.declared);
  json["status"] = preregistered ? "preregistered" : "declared";
  json["value"] = outcome_word(one.value);
  json["test_name"] = test_title(*one.declared);
  json["a"] = condition_text(one.declared->compare.front());
  json["b"] = one.declared->compare.size() > 1 ? condition_text(one.declared->compare.back())
                                               : base::shortest(one.declared->against.value_or(0.5));
  json["mean_a"] = one.mean_a;
  json["mean_b"] = one.mean_b;
  json["alpha"] = alpha;
  json["ci_confidence"] = ci_confidence(*one.declared);
  if (!one.outcome) {
    for (const char* name :
         {"n_a", "n_b", "n_missing", "groups", "statistic", "statistic_value", "df", "p", "p_adjusted",
          "estimated", "estimate", "ci", "effect", "effect_size", "effect_ci"})
      json[name] = Json();
    json["holds"] = false;
    json["reason"] = one.outcome.reason();
    return json;
  }
  const stats::TestOutcome& got = *one.outcome;
  json["n_a"] = got.n_a;
  json["n_b"] = got.n_b;
  json["n_missing"] = got.n_missing;
  json["groups"] = got.groups;
  json["statistic"] = got.statistic;
  json["statistic_value"] = json_number(got.value);
  json["df"] = json_number(got.df);
  json["p"] = json_number(got.p);
  json["p_adjusted"] = json_number(one.p_adjusted);
  json["estimated"] = got.estimated;
  json["estimate"] = json_number(got.estimate);
  json["ci"] = json_interval(got.ci);
  json["effect"] = got.effect.empty() ? Json() : Json(got.effect);
  json["effect_size"] = json_number(got.effect_size);
  json["effect_ci"] = json_interval(got.effect_ci);
  json["holds"] = one.p_adjusted < alpha;
  json["reason"] = got.note;
  return json;
}

/// The hypotheses, tested without the plan's rules of exclusion. Trials that the experimenter excluded and
/// interrupted trials are still left out.
Json without_exclusions(const TaskStudy& study, const ChosenTask& chosen, const stats::AnalysisPlan& plan,
                        const std::vector<TestedHypothesis>& planned) {
  Json list = Json::array();
  const TaskData data =
      collect_task(study, chosen, {stats::TimingRule::None, std::nullopt, std::nullopt, std::nullopt, 0, 0});
  const auto tested = test_all(data, plan);
  for (std::size_t i = 0; i < tested.size(); ++i) {
    const bool holds = tested[i].p_adjusted < plan.alpha, held = planned[i].p_adjusted < plan.alpha;
    list.push_back({{"id", tested[i].declared->id},
                    {"variant", "without exclusions by rule"},
                    {"participants", data.flow.analysed},
                    {"estimate", tested[i].outcome ? json_number(tested[i].outcome->estimate) : Json()},
                    {"p_adjusted", json_number(tested[i].p_adjusted)},
                    {"holds", holds},
                    {"changed", holds != held}});
  }
  return list;
}

std::set<std::string> sessions_of(const Json& document, const std::string& sha256, const std::string& name) {
  if (!document.contains("schema") || document.at("schema") != study_schema)
    throw base::Error(name, std::string("is no result of schema ") + study_schema,
                      "give a file that vip-stats study --json wrote");
  if (document.at("study").at("protocols").at(0).at("sha256") != sha256)
    throw base::Error(name, "is about another protocol than this analysis, SHA-256 " + sha256.substr(0, 12),
                      "give an earlier result of vip-stats study --json about this protocol");
  std::set<std::string> out;
  for (const Json& person : document.at("participants"))
    for (const Json& session : person.at("sessions")) out.insert(session.at("uid").get<std::string>());
  return out;
}

/// Date and number of participants of the earlier document, and the number of present participants without a
/// session in that document.
Json since_json(const Json& participants, const Json& earlier, const std::string& file) {
  int fresh = 0;
  for (const Json& person : participants) fresh += person.at("new").get<bool>() ? 1 : 0;
  return {{"file", file},
          {"date_utc", earlier.at("date_utc")},
          {"participants", earlier.at("participants").size()},
          {"new", fresh}};
}

/// One line for each entry of the list `name` of each object: the object's other fields, then the entry's.
Json unfolded(const Json& list, const std::string& name) {
  Json out = Json::array();
  for (const Json& one : list) {
    Json head = one;
    head.erase(name);
    for (const Json& entry : one.at(name)) {
      Json line = head;
      line.update(entry);
      out.push_back(std::move(line));
    }
  }
  return out;
}

}  // namespace

const TaskProtocol& factor_protocol(const TaskStudy& study, const std::string& by,
                                    const std::string& database) {
  std::vector<const TaskProtocol*> all, real;
  for (const TaskProtocol& one : study.protocols) {
    if (!has_factors(one) || !is_meant(one, by)) continue;
    all.push_back(&one);
    if (has_real_answers(one)) real.push_back(&one);
  }
  const auto& chosen = real.empty() ? all : real;
  if (chosen.empty())
    throw base::Error(
        database, "holds no protocol with factors" + (by.empty() ? "" : " that is '" + by + "'"),
        "name a protocol of format 3 with --protocol, or use vip-stats report for other protocols");
  if (chosen.size() == 1) return *chosen.front();
  std::vector<std::string> names;
  for (const TaskProtocol* one : chosen) names.push_back(hashed_name(*one));
  throw base::Error(database, "holds several protocols with factors, which are never pooled",
                    "choose one with --protocol: " + base::joined(names));
}

Json factor_study_json(const TaskStudy& study, const TaskProtocol& protocol,
                       const FactorStudyRequest& request) {
  const stats::AnalysisPlan& plan = request.plan.plan;
  ChosenTask chosen{.protocol = protocol, .set_aside = {}, .question = {}, .own = true};
  if (!protocol.questions.empty()) chosen.question = protocol.questions.front();
  const TaskData data = collect_task(study, chosen, plan.exclusions);
  std::optional<std::set<std::string>> earlier;
  if (request.since) earlier = sessions_of(*request.since, protocol.sha256, request.since_file);

  Json json{{"schema", study_schema},
            {"versions", {{"vip_lab", base::version()}, {"gsl", stats::gsl_library_version()}}},
            {"date_utc", base::utc_now()},
            {"plan", plan_json(request.plan, {protocol.sha256})},
            {"study", study_json(request.database.filename().string(), {&data}, request.plan.plan)},
            {"design", design_json(protocol.whole->design)},
            {"flow", flow_json(data.flow)},
            {"exclusions", exclusions_json(data)}};
  json["study"]["protocols"][0]["rules"] = acting_rules_json(data, plan.exclusions);
  json["study"]["simulated_people"] = data.simulated.size();
  json["groups"] = groups_json(data);
  if (!study.lacking.empty()) json["study"]["incomplete"] = study.lacking;
  json["participants"] = participants_json(data, earlier ? &*earlier : nullptr);
  if (request.since) json["since"] = since_json(json["participants"], *request.since, request.since_file);

  const auto tested = test_all(data, plan);
  if (request.frozen) json["preregistration"] = preregistration_json(*request.frozen, data);
  const bool preregistered = request.frozen && json["preregistration"].at("preregistered").get<bool>();
  json["hypotheses"] = Json::array();
  std::vector<std::string> outcomes;
  for (const TestedHypothesis& one : tested) {
    json["hypotheses"].push_back(tested_json(one, plan.alpha, preregistered));
    outcomes.push_back(one.declared->outcome);
  }
  json["sensitivity"] = without_exclusions(study, chosen, plan, tested);
  json["descriptives"] = answers_by_cell_json(data, plan.confidence, outcomes);
  const bool by_threshold =
      std::count(outcomes.begin(), outcomes.end(), std::string(stats::threshold_outcome)) > 0;
  Json thresholds = thresholds_json(data, person_tracks(data), plan.confidence, by_threshold);
  if (!thresholds.is_null()) json["thresholds"] = std::move(thresholds);
  json["timing"] = timing_by_cell_json(data);
  Json stations = station_timing_json(data);
  if (!stations.empty()) json["timing_stations"] = std::move(stations);
  return json;
}

std::vector<std::pair<std::string, Json>> factor_study_tables(const Json& document) {
  const Json cells = unfolded(document.at("descriptives"), "cells");
  std::vector<std::pair<std::string, Json>> out{
      {"flow", Json::array({document.at("flow")})},
      {"participants", unfolded(document.at("participants"), "sessions")},
      {"exclusions", document.at("exclusions")},
      {"hypotheses", document.at("hypotheses")},
      {"sensitivity", document.at("sensitivity")},
      {"descriptives", cells},
      {"descriptives_answers", unfolded(cells, "counts")},
      {"timing", document.at("timing")}};
  if (document.contains("timing_stations"))
    out.emplace_back("timing_stations", document.at("timing_stations"));
  if (document.contains("thresholds")) {
    const Json& thresholds = document.at("thresholds");
    out.emplace_back("thresholds", thresholds.at("participants"));
    out.emplace_back("thresholds_mean", thresholds.at("tracks"));
    Json points = Json::array();
    for (const Json& track : thresholds.at("tracks"))
      points.push_back({{"track", track.at("track")}, {"points", track.at("points")}});
    out.emplace_back("psychometric", unfolded(points, "points"));
  }
  return out;
}

}  // namespace study
