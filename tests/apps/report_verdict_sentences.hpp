#pragma once
/// The report's sentences about sickness, hypotheses, the bundle and the source of the numbers.

#include "tests/apps/report_sentence.hpp"

namespace report_sentences {

inline std::vector<Case> sickness() {
  const std::string ssq = "/sickness/0/ssq";
  const Change none = set("/sickness", Json::array()), no_ssq = set(ssq, nullptr),
               no_fms = set("/sickness/0/fms", nullptr);
  return {
      {"Exploratory # participants.", none},
      {"Exploratory # participants, test data.", set("/sickness/0/test_data", false),
       set("/sickness/0/test_data", true)},
      {"Exploratory # participants, all answered by a model.", set("/sickness/0/simulated", 0),
       set("/sickness/0/simulated", 3)},
      {"Sessions that ended early and those left out elsewhere count here.", none},
      {"Simulator Sickness Questionnaire with the weights of Kennedy et al.", no_ssq},
      {"(1993): before is the last page ahead of the first trial, after the last page behind it.", no_ssq},
      {"A missing item empties its scale and the total: # of # pages lack some.", set(ssq + "/incomplete", 0),
       set(ssq + "/incomplete", 2)},
      {"Changes are of the participants with both; signed-rank tests are two-sided and not corrected.",
       no_ssq},
      {"No session answered the questionnaire after the first trial, so there are no changes.",
       set(ssq + "/pages_after", 2), set(ssq + "/pages_after", 0)},
      {"No session answered the questionnaire before the first trial, so there are no changes.",
       set(ssq + "/pages_before", 2), set(ssq + "/pages_before", 0)},
      {"# SSQ scores before and after", no_ssq},
      {"# Changes of the SSQ scores, after less before", no_ssq},
      {"# Fast Motion Sickness scale at each asking.", no_fms},
      {"Band: quartiles; line: median; X: mean; circle: largest.", no_fms},
      {"Sessions that ended early are missing from later askings.", no_fms},
      {"Quartiles, median, mean and largest score of all sessions at each asking.", no_fms},
      {"The table below holds the numbers.", no_fms},
      {"# FMS: mean and peak of each participant", no_fms},
      {"# FMS over the session", no_fms},
      {"# Change of the FMS from the first answer to the last", no_fms},
  };
}

inline std::vector<Case> hypotheses() {
  const Change none = set("/hypotheses", Json::array());
  const Change untestable = all(
      {set("/hypotheses/0/status", "not testable"), set("/hypotheses/0/status_if_testable", "supported")});
  const Change by_pairs = set("/hypotheses/0/paired", nullptr), by_model = [](Json&json) {
    Json& h1 = json["hypotheses"][0];
    h1["paired"] = {{"status", "supported"}, {"tests", h1["tests"]}};
  };
  return {
      {"# Decisions on the hypotheses", none},
      {"Exploratory Decision: #.",
       all({set("/preregistration", bundle()), set("/preregistration/tasks/task2", true)})},
      {"Preregistered Decision: #.", set("/preregistration", nullptr), set("/preregistration", bundle())},
      {"Each hypothesis claims all of its tests: it is supported where every one is significant at \u03b1 "
       "without correction (an intersection-union test), which errs at most at \u03b1.",
       by_holm},
      {"Where not all are, those that hold after Holm's step-down correction within the hypothesis may be "
       "claimed one by one.",
       by_holm},
      {"Each hypothesis is a family of its own; Holm's step-down correction holds the family's error rate.",
       set("/plan/decision", "intersection-union"), by_holm},
      {"The claims of H1 to H6 are not corrected for one another; what Holm makes of them stands beside.",
       none},
      {"The claim as a whole: p *, after Holm over the claims of H1 to H6 p *.",
       in_each("/hypotheses", "p_claim_of_six", nullptr)},
      {"The claim as a whole: p *.", in_each("/hypotheses", "p_claim", nullptr)},
      {"Stars: [*] p < .05, [*][*] p < .01, [*][*][*] p < .001.", none},
      {"Were it testable, the tests below would read: #.", set("/hypotheses/0/status", "supported"),
       untestable},
      {"Rule: # (tests in the family: #, \u03b1 = #).", none},
      {"# #: tests of the family", none},
      {"By paired t tests, which the plan does not decide by: #.", by_pairs, by_model},
      {"# #: paired tests beside", by_pairs, by_model},
      {"# The same p in larger families", none},
      {"#: Mdiff = #, # CI [[]#, #]*, p *, pHolm *", none},
      {"#: *share = #, #, # CI [[]#, #], p *, pHolm *", none},
      {"Where a person answered a pair more than once, the test is the #, in place of the binomial test.",
       in_each("/hypotheses/3/tests", "method", "exact binomial test"),
       set("/hypotheses/3/tests/0/method", "exact permutation test of people's shares")},
      {"#: Mdiff = #, #, *p *, pHolm *", set("/hypotheses/0/tests/0/method", "paired t test"),
       set("/hypotheses/0/tests/0/method", "exact sign test")},
      {"#: no test, #", in_each("/hypotheses/0/tests", "p", 0.5),
       all({in_each("/hypotheses/0/tests", "p", nullptr),
            in_each("/hypotheses/0/tests", "reason", "too few")})},
      {"The paper's own procedure on these data (#): #.", none},
      {"# Of its own data the paper said: #.", none},
      {"Exploratory The hypotheses again under other rules of exclusion and averaging.",
       set("/sensitivity", Json::array())},
      {"None of these replaces a decision above.", set("/sensitivity", Json::array())},
      {"# The decisions under other rules", set("/sensitivity", Json::array())},
      {"# Every test under other rules", set("/sensitivity", Json::array())},
  };
}

inline std::vector<Case> bundle_and_provenance() {
  const Change with = set("/preregistration", bundle()), without = set("/preregistration", nullptr);
  return {
      {"No preregistration was given: every analysis of this page is exploratory.", with},
      {"Rules in force: #.", with},
      {"Bundle, SHA-256 #, frozen # by ViP-Lab #.", without, with},
      {"# These dates are what the clocks of the computers said: only a hash that was deposited elsewhere "
       "proves "
       "its date.",
       set("/preregistration/times", Json::array()), with},
      {"What differs from the preregistration", set("/preregistration/differences", Json::array()), with},
      {"Preregistered Hypotheses of Task 1: the tests of each family with their margins, corrections and "
       "exclusions.",
       set("/preregistration/tasks/task1", false), with},
      {"Exploratory Hypotheses of Task 2: the tests of each family with their margins, corrections and "
       "exclusions.",
       set("/preregistration/tasks/task2", true), with},
      {"Exploratory Hypotheses of Task 1: *", with},
      {"Exploratory Hypotheses of Task [12]: *", set("/hypotheses", Json::array())},
      {"Preregistered Hypotheses of Task 2: *", set("/preregistration/tasks/task2", false),
       all({with, set("/preregistration/tasks/task2", true)})},
      {"Exploratory All but the hypotheses: tables and tests of Pilot, tables and tests of Task 1, tables "
       "and tests "
       "of "
       "Task 2, answers by cell, "
       "ordinal models, the Bradley-Terry model and sensitivity.",
       set("/task1/ordinal", Json::array())},
      {"Exploratory All of it: *",
       all({refused("/task1"), refused("/task2"), refused("/pilot"), set("/descriptives", Json::array()),
            set("/sensitivity", Json::array())}),
       set("/hypotheses", Json::array())},
      {"Exploratory All but the hypotheses: *",
       all({refused("/task1"), refused("/task2"), refused("/pilot"), set("/sensitivity", Json::array()),
            set("/descriptives", Json::array())})},
      {"# Where the numbers come from",
       [](Json& json) {
         json = {{"schema", "none"}};
       }},
      {"Every number of this page is read from the results' JSON, schema #; the attribute data-field names "
       "its "
       "place there.",
       [](Json& json) {
         json = {{"schema", "none"}};
       }},
  };
}

}  // namespace report_sentences
