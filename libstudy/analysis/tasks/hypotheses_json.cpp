#include "libstudy/analysis/tasks/hypotheses_json.hpp"

#include "libstudy/analysis/tasks/missing_json.hpp"

namespace study {

namespace {

Json test_json(const stats::HypothesisTest& test, bool has_paper) {
  Json json{{"label", test.label}};
  if (!test.score.empty()) {
    json["score"] = test.score;
    json["n_star"] = test.n_star;
  }
  json["method"] = test.method;
  json["a"] = test.a;
  json["b"] = test.b;
  json["n"] = test.n;
  if (test.k) json["k"] = *test.k;
  json["estimate"] = json_number(test.estimate);
  json["ci"] = json_interval(test.ci);
  json["ci_confidence"] = test.ci_confidence;
  json["margin"] = json_number(test.margin);
  if (test.t) {
    json["t"] = *test.t;
    json["df"] = json_number(test.df);
    json["d_z"] = json_number(test.d_z);
  }
  json["p"] = json_number(test.p);
  json["p_holm"] = json_number(test.p_holm);
  json["stars"] = json_stars(test.p);
  json["stars_holm"] = json_stars(test.p_holm);
  json["holds"] = test.holds;
  json["holds_holm"] = test.holds_holm;
  json["against"] = test.against;
  json["reason"] = test.reason;
  json["paper_p"] = json_number(test.paper_p);
  json["paper_holds"] = has_paper ? Json(test.paper_holds) : Json();
  if (test.p_holm_of_five) json["p_holm_of_five"] = *test.p_holm_of_five;
  if (test.p_holm_of_ten) json["p_holm_of_ten"] = *test.p_holm_of_ten;
  if (test.tipping) json["tipping"] = json_result(*test.tipping, tipping_json);
  return json;
}

/// `has_paper`: the hypothesis has a verdict by the paper's rule.
Json tests_json(const std::vector<stats::HypothesisTest>& tests, bool has_paper) {
  Json list = Json::array();
  for (const auto& test : tests) list.push_back(test_json(test, has_paper));
  return list;
}

}  // namespace

Json hypothesis_json(const stats::Hypothesis& one) {
  Json json{{"id", one.id},
            {"title", one.title},
            {"task", one.task == 1 ? "task1" : "task2"},
            {"kind", stats::kind_name(one.kind)},
            {"family", one.tests.size()},
            {"alpha", one.alpha},
            {"one_sided", one.one_sided},
            {"rule", one.rule},
            {"status", stats::status_name(one.status)},
            {"status_text", one.status_text},
            {"confirmed", one.confirmed},
            {"confirmed_holm", one.confirmed_holm},
            {"p_claim", json_number(one.p_claim)},
            {"p_claim_of_six", json_number(one.p_claim_of_six)},
            {"tests", tests_json(one.tests, !one.paper_rule.empty())}};
  if (!one.paper_rule.empty())
    json["paper"] = {{"rule", one.paper_rule},
                     {"status", one.paper_supported ? "supported" : "not supported"},
                     {"text", one.paper_text},
                     {"published", one.paper_published}};
  if (one.status == stats::HypothesisStatus::NotTestable)
    json["status_if_testable"] = stats::status_name(one.status_if_testable);
  if (one.paired)
    json["paired"] = {{"status", stats::status_name(one.paired->status)},
                      {"confirmed", one.paired->confirmed},
                      {"tests", tests_json(one.paired->tests, !one.paper_rule.empty())}};
  return json;
}

Json hypothesis_outline_json(const stats::Hypothesis& one) {
  Json tests = Json::array();
  for (const auto& test : one.tests) {
    tests.push_back({{"label", test.label},
                     {"n", test.n},
                     {"estimate", json_number(test.estimate)},
                     {"p", json_number(test.p)},
                     {"p_holm", json_number(test.p_holm)},
                     {"holds", test.holds},
                     {"holds_holm", test.holds_holm}});
  }
  return {{"id", one.id},
          {"status", stats::status_name(one.status)},
          {"status_if_testable", stats::status_name(one.status_if_testable)},
          {"confirmed", one.confirmed},
          {"tests", tests}};
}

}  // namespace study
