#pragma once
/// The facts on which the report's sentences about the pilot, Task 1, Task 2, sickness, the hypotheses and
/// the preregistration rest.

#include "tests/apps/report_facts.hpp"

namespace report_facts {

inline std::vector<Fact> of_the_pilot() {
  const Change failed = all({set("/pilot/status", "failed"), set("/pilot/reason", "no contour")});
  const Json raters{{"reverse_coders", {{"text", "no participant"}}},
                    {"drift", {{"text", "scores change by +0.1"}}},
                    {"lapses", {{"text", "0 of 100 answers"}}}},
      other_form{{"rejected", true},
                 {"text", "c = -0.2, it levels off"},
                 {"free_curve",
                  {{{"delta", 0}, {"mu", 24.5}, {"ci", {22.5, 26.5}}, {"simultaneous_ci", {21.5, 27.5}}},
                   {{"delta", 1}, {"mu", 25.5}, {"ci", {23.5, 27.5}}, {"simultaneous_ci", {22.5, 28.5}}}}}};
  const auto said = [&](const char* word, const std::string& part) {
    return Fact{1, word, set("/pilot/raters/" + part + "/text", ""), set("/pilot/raters", raters)};
  };
  return {
      {20, "ratings", failed},
      {1, "No fit", set("/pilot/status", "ok"), failed},
      {1, "For the solver", set("/pilot/doubts", {"a doubt"})},
      {1, "Not for a solver", none("/pilot/doubts"), set("/pilot/doubts", {"a doubt"})},
      {3, "Scores", none("/pilot/cells")},
      {1, "Estimates",
       all({none("/pilot/estimators"), set("/pilot/means", Json::object()), set("/pilot/a", nullptr)})},
      {1, "About", none("/pilot/flags")},
      {1, "Shape", refused("/pilot/lack_of_fit")},
      said("Direction", "reverse_coders"),
      said("Drift", "drift"),
      said("Lapses", "lapses"),
      {2, "Form", refused("/pilot/form"), set("/pilot/form", other_form)},
      {1, "free curve", set("/pilot/form/rejected", false), set("/pilot/form", other_form)},
      {1, "curve", none("/pilot/bands")},
      {2, "Model", set("/pilot/estimator", nullptr)},
      {1, "each score", none("/pilot/distributions")},
      {4, "each score", all({none("/pilot/distributions"), none("/task1/distributions")})},
  };
}

inline std::vector<Fact> of_task1() {
  const std::string pairs = "/task1/comparisons", model = "/task1/ordinal";
  // A significant comparison (one star) by a sign test, which has no statistic t.
  const Change alike = all({set(pairs + "/0/t", nullptr), set(pairs + "/0/stars", "*"),
                            set(pairs + "/0/test", "exact sign test")});
  const auto tipping = [&](const Json& one) {
    return all({each(pairs, "tipping", one), none("/hypotheses")});
  };
  const auto missing = [](int answers) {
    const Json side{{"missing", answers}, {"worse_by", nullptr}};
    return Json{{"planned", 16}, {"holds", false}, {"a", side}, {"b", side}, {"reason", ""}};
  };
  const auto no_time = [](Json& one) {
    one["median"] = nullptr;
    one["reason"] = "simulated participants take no time to answer";
  };
  const Change timed = each("/response_times", "median", 2.5),
               untested = exchange("hypotheses", Json::array()),
               no_answers = exchange("task1", {{"refused", "no answer counts"}});
  return {
      {59, "participants", refused("/task1")},
      {2, "Not given", no_answers, no_answers},
      {3, "describe the data.", untested, untested},
      {22, "Box", each("/task1/scores", "primary", false)},
      {1, "means", none("/task1/cells")},
      {7, "Pair", none(pairs)},
      {2, "APA", each(pairs, "stars", "")},
      {1, "all differences", each(pairs, "test", "paired t test"), alike},
      {1, "differs", each(pairs, "stars", "*"), each(pairs, "stars", "")},
      {1, "could be tested", each(pairs, "p", 0.5), each(pairs, "p", nullptr)},
      {3, "All methods", none("/task1/omnibus")},
      {3, "add up", each("/task1/people", "differ", false), each("/task1/people", "differ", true)},
      {15, "mixed model", none(pairs), none("/task1/mixed")},
      {1, "mixed models", none("/task1/mixed")},
      {9, "tipping point", none(pairs), none("/hypotheses")},
      {1, "lacks", each(pairs, "tipping", missing(1)), tipping(missing(0))},
      {1, "too few", each(pairs, "tipping", missing(1)), tipping({{"refused", "too few answers"}})},
      {2, "Cumulative", none(model)},
      {2, "penalised", each(model, "penalty", ""), each(model, "penalty", "log-F(1, 1)")},
      {5, "by scene", none("/task1/by_scene")},
      {1, "cut", each("/task1/by_scene", "ci", nullptr), set("/task1/by_scene/0/ci", {-3, 12})},
      {2, "each score", none("/task1/distributions")},
      {3, "depends", none("/task1/by_n_star")},
      {3, "Cronbach", none("/task1/reliability")},
      {1, "smallest difference", none("/task1/detectable")},
      {1, "Time from", none("/response_times")},
      {1, "Not given:", timed,
       [=](Json& json) {
         for (auto& one : json["response_times"]) no_time(one);
       }},
      {1, "other questions", timed, [=](Json& json) { no_time(json["response_times"][0]); }},
      {1, "Repeated", none("/task1/retest"), set("/task1/retest", {{{"score", "realism"}, {"pairs", 4}}})},
  };
}

inline std::vector<Fact> of_task2() {
  const std::string pairs = "/task2/pairs", bias = "/task2/interval_bias", model = "/task2/bradley_terry",
                    people = model + "/people", detectable = "/task2/detectable";
  const Change independent =
      all({set(people + "/errors", "independent answers"), set(people + "/why_independent", "too few")});
  return {
      {27, "participants", refused("/task2")},
      {2, "line", each(pairs, "wilson", nullptr)},
      {1, "Fig._10.", each(pairs, "wilson", {0.4, 0.6}), each(pairs, "wilson", nullptr)},
      {3, "Stars", each(pairs, "test", nullptr)},
      {1, "more than once", set("/task2/several_answers/participants", 0),
       set("/task2/several_answers/participants", 3)},
      {1, "over", each(pairs, "p", nullptr)},
      {3, "first of a pair", refused(bias)},
      {1, "Note", set(bias + "/warning", ""), set(bias + "/warning", "one answered all pairs alike")},
      {1, "mean share", refused(bias + "/by_participant")},
      {1, "every share", set(bias + "/by_participant/test", "t test"),
       set(bias + "/by_participant/test", "exact sign test")},
      {7, "Abilities", refused(model)},
      {1, "Firth", set(model + "/penalised", false), set(model + "/penalised", true)},
      {1, "likeness", independent},
      {1, "independent", set(people + "/errors", "people"), independent},
      {1, "All methods equal, if", set(model + "/overall", nullptr)},
      {1, "over people", set(people + "/equal", nullptr)},
      {1, "Lack of fit", set(model + "/fit", nullptr)},
      {1, "order", set(model + "/order", nullptr)},
      {3, "triads", refused("/task2/triads")},
      {1, "by scene", none("/task2/by_scene")},
      {1, "power", set(detectable, nullptr)},
      {1, "Not given", set(detectable, nullptr),
       set(detectable, {{"n", 5}, {"share", nullptr}, {"reason", "too few answers"}})},
      {1, "again", set("/task2/retest", nullptr), set("/task2/retest", {{"pairs", 4}, {"same", 0.5}})},
  };
}

inline std::vector<Fact> of_sickness() {
  const std::string one = "/sickness/0", ssq = one + "/ssq";
  return {
      {19, "participants", none("/sickness")},
      {1, "test data", set(one + "/test_data", false), set(one + "/test_data", true)},
      {1, "model", set(one + "/simulated", 0), set(one + "/simulated", 3)},
      {6, "SSQ", set(ssq, nullptr)},
      {1, "missing item", set(ssq + "/incomplete", 0), set(ssq + "/incomplete", 2)},
      {3, "both", set(ssq + "/pages_after", 0)},
      {1, "after the first trial", set(ssq + "/pages_after", 2), set(ssq + "/pages_after", 0)},
      {1, "before the first trial", set(ssq + "/pages_before", 2), set(ssq + "/pages_before", 0)},
      {11, "FMS", set(one + "/fms", nullptr)},
  };
}

inline std::vector<Fact> of_hypotheses() {
  const std::string first = "/hypotheses/0", method = first + "/tests/0/method";
  const Change untestable = all(
                   {set(first + "/status", "not testable"), set(first + "/status_if_testable", "supported")}),
               beside = [](Json&json) {
                 Json& h1 = json["hypotheses"][0];
                 h1["paired"] = {{"status", "supported"}, {"tests", h1["tests"]}};
               };
  return {
      {27, "Decision", none("/hypotheses")},
      {1, "Holm", each("/hypotheses", "p_claim_of_six", nullptr)},
      {1, "claim", each("/hypotheses", "p_claim", nullptr), each("/hypotheses", "p_claim_of_six", nullptr)},
      {1, "Were it testable", set(first + "/status", "supported"), untestable},
      {2, "paired", set(first + "/paired", nullptr), beside},
      {1, "in place", each("/hypotheses/3/tests", "method", "exact binomial test"),
       set("/hypotheses/3/tests/0/method", "exact permutation test of people's shares")},
      {1, "", set(method, "paired t test"), set(method, "exact sign test")},
      {1, "CI", each(first + "/tests", "method", "exact sign test")},
      {1, "share", each("/hypotheses", "kind", "difference")},
      {1, "no test", each(first + "/tests", "p", 0.5),
       all({each(first + "/tests", "p", nullptr), each(first + "/tests", "reason", "too few")})},
      {5, "other rules", none("/sensitivity")},
      {2, "ordinal", none("/task1/ordinal")},
  };
}

inline std::vector<Fact> of_the_preregistration() {
  const std::string bundle = "/preregistration", tasks = bundle + "/tasks";
  const Change without = set(bundle, nullptr),
               with = set(bundle, {{"sha256", "ab"},
                                   {"frozen_utc", "2026-01-01T00:00:00Z"},
                                   {"vip_lab", "0.1.0"},
                                   {"summary", "Everything is as it was fixed."},
                                   {"tasks", {{"task1", true}, {"task2", false}}},
                                   {"times", {{{"task", "task1"}, {"text", "Frozen first."}}}},
                                   {"differences", {"protocol task2 was not preregistered"}}}),
               whole = all({with, set(tasks + "/task2", true)});
  return {
      {3, "No preregistration", with},
      {5, "Bundle", without, with},
      {1, "clocks", none(bundle + "/times"), with},
      {1, "differs", none(bundle + "/differences"), with},
      {2, "Preregistered Hypotheses of Task 1", set(tasks + "/task1", false), with},
      {2, "Exploratory Hypotheses of Task 2", set(tasks + "/task2", true), with},
      {1, "Preregistered Hypotheses of Task 2", set(tasks + "/task2", false), whole},
      {5, "Exploratory Decision", whole},
  };
}

inline const std::vector<Fact>& facts() {
  static const std::vector<Fact> list = [] {
    std::vector<Fact> out;
    for (const auto& part :
         {of_protocols(), of_rules(), of_tests(), of_participants(), of_timing(), of_costs(), of_the_pilot(),
          of_task1(), of_task2(), of_sickness(), of_hypotheses(), of_the_preregistration()})
      out.insert(out.end(), part.begin(), part.end());
    return out;
  }();
  return list;
}

}  // namespace report_facts
