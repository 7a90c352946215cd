#include "libstudy/power/power_json.hpp"
#include "libstudy/analysis/claims.hpp"
#include "libstudy/protocol/method_claims.hpp"

#include <filesystem>

#include "stats/base/file.hpp"
#include "stats/base/program.hpp"

namespace study {

namespace {

void add_figure(Json& out, const std::string& name, const Estimated& figure) {
  out[name] = json_number(figure.value);
  out[name + "_se"] = json_number(figure.se);
}

Json power_notes(const PowerRequest& request, PowerKind kind) {
  Json notes =
      Json::array({"Every figure's *_se is its Monte-Carlo standard error; shares of k of n studies use (k + "
                   "1) / (n + 2).",
                   "No dropouts and no exclusions are simulated: add the share that you expect to lose."});
  const std::string ids = ids_with(claims_in_force(request.plan.plan), &stats::MethodClaim::needs_gaze);
  if (request.protocol.needs_gaze && kind != PowerKind::Pilot && request.protocol.design.effects.empty() &&
      !ids.empty())
    notes.push_back("Gaze is taken to be tracked: without it " + ids +
                    " are not testable whatever the power.");
  if (kind != PowerKind::Pilot)
    notes.push_back(
        "n_for_power is the first n from which the power is reached at every n that was asked "
        "for; with exact tests power is a saw over n.");
  return notes;
}

Json settings_json(const PowerRequest& request, PowerKind kind) {
  Json out{{"n", request.n}, {"studies", request.studies}, {"seed", request.seed}, {"power", request.power}};
  if (kind == PowerKind::Task1) {
    out["effect"] = json_number(request.effect);
    out["difference"] = json_number(request.difference);
    out["answers"] = request.answers == AnswerScale::Likert ? "likert" : "continuous";
    out["sd_realism"] = request.sd_realism;
    out["sd_sickness"] = request.sd_sickness;
    out["person_by_method_realism"] = request.person_by_method.realism;
    out["person_by_method_sickness"] = request.person_by_method.sickness;
  }
  if (kind == PowerKind::Task2) {
    out["effect"] = json_number(request.effect);
    out["interval_bias"] = request.interval_bias;
  }
  if (kind == PowerKind::Pilot) {
    const auto& truth = request.observer;
    out["observer"] = {{"a", truth.a},
                       {"b", truth.b},
                       {"slope", truth.slope},
                       {"noise", truth.noise},
                       {"participant_sd", truth.participant_sd}};
    out["question"] = rated_question(request).id;
    out["other_questions"] = Json::array();
    for (const auto& one : curve_questions(request.protocol))
      if (one.id != out["question"]) out["other_questions"].push_back(one.id);
    out["level"] = rated_level(request);
    out["precision_a"] = json_number(request.precision_a);
    out["precision_b"] = json_number(request.precision_b);
  }
  return out;
}

Json head_json(const PowerRequest& request, PowerKind kind) {
  const auto& protocol = request.protocol;
  return {{"schema", "vip-power/1"},
          {"versions", {{"vip_lab", base::version()}}},
          {"protocol",
           {{"name", protocol.name},
            {"version", protocol.version},
            {"file", std::filesystem::path(request.file).filename().string()},
            {"sha256", protocol.sha256},
            {"participants", protocol.participants},
            {"test_data", protocol.test_data}}},
          {"kind", power_kind_name(kind)},
          {"settings", settings_json(request, kind)},
          {"plan", plan_json(request.plan, {protocol.sha256})},
          {"notes", power_notes(request, kind)}};
}

Json test_power_json(const TestPower& test, const std::vector<int>& n) {
  Json out{{"label", test.label},
           {"score", test.score.empty() ? Json() : Json(test.score)},
           {"n_star", test.n_star.empty() ? Json() : Json(test.n_star)},
           {"a", test.a},
           {"b", test.b},
           {"truth", json_number(test.truth)},
           {"claim_true", test.claim_true},
           {"margin", json_number(test.margin)},
           {"n_for_power", test.n_for_power},
           {"curve", Json::array()}};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto& at = test.curve[i];
    Json point{{"n", n[i]}, {"participants", {at.participants_least, at.participants_most}}};
    add_figure(point, "holds", at.holds);
    add_figure(point, "uncorrected", at.uncorrected);
    point["closed_form"] = json_number(at.closed_form);
    add_figure(point, "against", at.against);
    add_figure(point, "refused", at.refused);
    point["mean_estimate"] = json_number(at.mean_estimate);
    out["curve"].push_back(std::move(point));
  }
  return out;
}

Json hypothesis_json(const HypothesisPower& hypothesis, const std::vector<int>& n) {
  Json out{{"id", hypothesis.id},
           {"title", hypothesis.title},
           {"kind", stats::kind_name(hypothesis.kind)},
           {"rule", hypothesis.rule},
           {"paper_rule", hypothesis.paper_rule},
           {"claims_true", hypothesis.claims_true},
           {"n_for_power", hypothesis.n_for_power},
           {"curve", Json::array()},
           {"tests", Json::array()}};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto& at = hypothesis.curve[i];
    Json point{{"n", n[i]}};
    add_figure(point, "supported", at.supported);
    add_figure(point, "any", at.any);
    add_figure(point, "any_false", at.any_false);
    if (!hypothesis.paper_rule.empty()) add_figure(point, "paper_rule", at.paper);
    out["curve"].push_back(std::move(point));
  }
  for (const auto& test : hypothesis.tests) out["tests"].push_back(test_power_json(test, n));
  return out;
}

Json coefficient_json(const std::optional<CoefficientPoint>& at) {
  if (!at) return json_refused("fewer than two simulated pilots have an interval");
  Json out = Json::object();
  add_figure(out, "mean", at->mean);
  add_figure(out, "sd", at->sd);
  add_figure(out, "stated_se", at->se);
  add_figure(out, "half_width", at->half_width);
  add_figure(out, "half_width_wished", at->half_width_wished);
  add_figure(out, "coverage", at->coverage);
  if (at->reached) add_figure(out, "reached", *at->reached);
  return out;
}

/// A JSON value as a CSV field; texts are quoted.
std::string field(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string out = "\"";
  for (const char c : value.get<std::string>()) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

/// Adds CSV lines for one point of a curve: one for each value that has a standard error, and one each for
/// "closed_form" and "mean_estimate".
void add_lines(std::string& out, const std::string& lead, const Json& point, const Json& n) {
  for (const auto& [name, value] : point.items()) {
    const bool figure = point.contains(name + "_se");
    if (!figure && name != "closed_form" && name != "mean_estimate") continue;
    out += lead + ',' + n.dump() + ',' + name + ',' + field(value) + ',' +
           (figure ? field(point.at(name + "_se")) : "") + '\n';
  }
}

}  // namespace

Json studies_json(const PowerRequest& request) {
  const auto kind = power_kind(request.protocol, request.plan.plan);
  Json out{{"program", base::program_words()},
           {"protocol", request.protocol.sha256},
           {"plan", format_plan(request.plan.plan, {})},
           {"worlds", request.worlds}};
  out.update(settings_json(request, kind));
  for (const char* name : {"n", "studies", "power", "precision_a", "precision_b"}) out.erase(name);
  return out;
}

Json power_json(const PowerRequest& request, const std::vector<WorldPower>& worlds) {
  Json out = head_json(request, power_kind(request.protocol, request.plan.plan));
  out["worlds"] = Json::array();
  for (const auto& world : worlds) {
    Json one{{"id", world.id}, {"words", world.words}, {"hypotheses", Json::array()}};
    for (const auto& hypothesis : world.hypotheses)
      one["hypotheses"].push_back(hypothesis_json(hypothesis, request.n));
    out["worlds"].push_back(std::move(one));
  }
  return out;
}

Json power_json(const PowerRequest& request, const PilotPower& pilot) {
  Json out = head_json(request, PowerKind::Pilot);
  Json& precision = out["precision"];
  precision = {{"estimator", "direct estimate, jackknife-t interval over participants"},
               {"confidence", request.plan.plan.confidence},
               {"n_for_a", pilot.n_for_a},
               {"n_for_b", pilot.n_for_b},
               {"n_for_both", pilot.n_for_both},
               {"n_for_a_median", pilot.n_for_a_median},
               {"n_for_b_median", pilot.n_for_b_median},
               {"curve", Json::array()}};
  for (std::size_t i = 0; i < request.n.size(); ++i) {
    const auto& at = pilot.curve[i];
    Json point{{"n", request.n[i]}};
    add_figure(point, "fitted", at.fitted);
    add_figure(point, "interval", at.interval);
    point["a"] = coefficient_json(at.a);
    point["b"] = coefficient_json(at.b);
    precision["curve"].push_back(std::move(point));
  }
  return out;
}

std::string power_csv(const Json& json) {
  std::string out = "world,hypothesis,test,claim_true,n,figure,value,se\n";
  if (json.contains("precision")) {
    for (const auto& point : json.at("precision").at("curve")) {
      add_lines(out, "observer,,,", point, point.at("n"));
      for (const char* name : {"a", "b"})
        add_lines(out, "observer,," + std::string(name) + ',', point.at(name), point.at("n"));
    }
    return out;
  }
  for (const auto& world : json.at("worlds")) {
    for (const auto& hypothesis : world.at("hypotheses")) {
      const std::string lead = field(world.at("id")) + ',' + field(hypothesis.at("id")) + ',';
      const bool all = hypothesis.at("claims_true").get<std::size_t>() == hypothesis.at("tests").size();
      for (const auto& point : hypothesis.at("curve"))
        add_lines(out, lead + ',' + (all ? "true" : "false"), point, point.at("n"));
      for (const auto& test : hypothesis.at("tests")) {
        for (const auto& point : test.at("curve"))
          add_lines(out, lead + field(test.at("label")) + ',' + test.at("claim_true").dump(), point,
                    point.at("n"));
      }
    }
  }
  return out;
}

}  // namespace study
