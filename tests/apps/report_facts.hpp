#pragma once
/// The facts on which sentences of the report rest: changes of the results that begin and end each fact.

#include <functional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace report_facts {

using Json = base::Json;
using Change = std::function<void(Json&)>;

/// A fact and the changes of the results that begin and end it. A sentence rests on the fact if it is on the
/// page while the fact holds and not after its end. A clause before a semicolon counts as a sentence.
struct Fact {
  int sentences;     ///< number that rest on the fact; sentences that differ only in values count once
  std::string word;  ///< occurs in one of these sentences, and not in the text that replaces it
  Change ends;
  Change begins = [](Json&) {};  ///< applied to a study with a pilot and both tasks
};

inline Change set(const std::string& pointer, Json value) {
  return [pointer, value = std::move(value)](Json& json) { json[Json::json_pointer(pointer)] = value; };
}
inline Change none(const std::string& list) { return set(list, Json::array()); }
inline Change refused(const std::string& part) { return set(part, {{"refused", "no answer counts"}}); }
inline Change all(std::vector<Change> changes) {
  return [changes = std::move(changes)](Json& json) {
    for (const auto& change : changes) change(json);
  };
}
inline Change each(const std::string& list, const std::string& key, Json value) {
  return [list, key, value = std::move(value)](Json& json) {
    for (auto& one : json[Json::json_pointer(list)]) one[key] = value;
  };
}

/// Replaces the part by `other`; applied a second time, it restores the part.
inline Change exchange(const std::string& part, const Json& other) {
  return [=](Json& json) {
    const Json now = json[part];
    json[part] = json.value("aside", other);
    json["aside"] = now;
  };
}

inline std::vector<Fact> of_protocols() {
  const std::string list = "/study/protocols", test = list + "/0/test_data";
  const auto protocols = [&](const char* key, Json value) { return each(list, key, std::move(value)); };
  const Json no = Json::object();
  return {
      {10, "Parts", none(list)},
      {2, "Test data", set(test, false), set(test, true)},
      {2, "Simulated", protocols("simulated", 0)},
      {1, "planned for", protocols("participants_planned", nullptr)},
      {1, "", protocols("participants_planned", 9), protocols("participants_planned", nullptr)},
      {3, "gaze", protocols("gaze", no)},
      {1, "angle", protocols("angles", no)},
      {1, "blind", protocols("unblinded", no)},
      {1, "pictures", protocols("mixed_pictures", no),
       protocols("mixed_pictures", {{"a.toml: 640x360 px at 75 degrees by R and 64x36", 2}})},
      {1, "factor", protocols("effects", no),
       protocols("effects", {{"none", "no effects"}, {"foam", "keeps foam"}})},
      {1, "painted", protocols("overlay", nullptr), protocols("overlay", "temperature")},
      {1, "settings", protocols("settings", no),
       protocols("settings", {{"Ours iterations=6 (setting ab)", 3}})},
      {2, "Incomplete", set("/study/incomplete", nullptr), set("/study/incomplete", "2 sessions")},
      {1, "Computed", set("/date_utc", nullptr)},
      {1, "Note", none("/study/notes")},
      {1, "GNU Scientific Library", set("/versions", nullptr)},
  };
}

inline std::vector<Fact> of_rules() {
  const std::string rules = "/plan/exclusions/", lists = "/study/protocols";
  const Change act = each(lists, "rules",
                          {"timing", "min_catch_correct", "max_repeat_difference", "min_repeat_agreement",
                           "straight_lining_answers", "min_answered"}),
               none_acts = each(lists, "rules", Json::array()),
               pilots = all({none_acts, set(lists + "/0/rules", {"timing"})});
  const auto rule = [&](const char* word, const char* name, Json off, Json on) {
    return Fact{1, word, set(rules + name, std::move(off)), all({act, set(rules + name, std::move(on))})};
  };
  return {
      rule("was fail", "timing", "none", "fail"),
      rule("degraded or fail", "timing", "fail", "degraded"),
      rule("no trial", "timing", "fail", "none"),
      rule("catch", "min_catch_correct", nullptr, 0.5),
      rule("differed", "max_repeat_difference", nullptr, 2),
      rule("alike", "min_repeat_agreement", nullptr, 0.5),
      rule("throughout", "straight_lining_answers", 0, 8),
      rule("of the trials answered", "min_answered", 0, 0.5),
      {1, "No rule", act, none_acts},
      {2, "Pilot", none_acts, pilots},
      {2, "No rule of exclusion could act on Task 1", act, pilots},
      {3, "same rules", none_acts, act},
      {2, "neither", set("/plan/exclusions", nullptr)},
  };
}

/// The test of a pair over people, some of whom answered more than once.
inline Json by_person() {
  return {{"participants", 9}, {"share", 0.6}, {"ci", {0.4, 0.8}}, {"ci_name", "of people"}, {"p", 0.03}};
}

inline std::vector<Fact> of_tests() {
  const std::string sides = "/plan/directional", decision = "/plan/decision", tests = "/plan/tests";
  const Change no_hypotheses = none("/hypotheses"), several = each("/task2/pairs", "by_person", by_person());
  const Json score_factor{
      {"score", "realism"}, {"n_star", "16k"},    {"factor", "effects"},       {"a", "none"},
      {"b", "foam"},        {"participants", 16}, {"test", "exact sign test"}, {"mean", -1},
      {"p", 0.0001},        {"p_holm", 0.0001}};
  const Json preference_factor{{"factor", "effects"}, {"a", "none"},      {"b", "foam"},
                               {"participants", 16},  {"n", 32},          {"k", 10},
                               {"share", 0.3125},     {"test", "t test"}, {"mean", 0.3125},
                               {"t", -2.5},           {"df", 15},         {"p", 0.024}};
  return {
      {1, "margins", each("/task1/scores", "code", "realism")},
      {1, "a margin", set("/task1/scores/0/code", "sickness"), each("/task1/scores", "code", "realism")},
      {1, "paired", set(tests, "mixed")},
      {2, "mixed model", set(tests, "paired"), set(tests, "mixed")},
      {3, "binomial", several},
      {3, "permutation", each("/task2/pairs", "by_person", nullptr), several},
      {5, "or by an exact", several, set("/task2/pairs/0/by_person", by_person())},
      {4, "level of a factor", none("/task1/factors"), set("/task1/factors", {score_factor})},
      {4, "level of a factor", none("/task2/factors"), set("/task2/factors", {preference_factor})},
      {1, "two-sided", set(sides, true)},
      {1, "one-sided, in", set(sides, false), set(sides, true)},
      {1, "one-sided for", set(sides, true), set(sides, "H2, H3 and H6")},
      {4, "intersection-union", set(decision, "holm")},
      {4, "errs at most", set(decision, "holm")},
      {3, "family of its own", set(decision, "intersection-union"), set(decision, "holm")},
      {3, "family-wise", set(decision, "intersection-union"), set(decision, "holm")},
      {1, "Intervals hold", set("/plan/confidence", nullptr)},
  };
}

inline std::vector<Fact> of_participants() {
  const std::string unanalysed = "/not_analysed", left_out = "/exclusions";
  const auto left_out_of = [&](const char* one, const char* other) {
    return set(left_out, {{{"task", one}}, {{"task", other}}});
  };
  return {
      {13, "begun", set("/flow", Json::object())},
      {4, "Pilot", set("/flow/pilot", nullptr)},
      {3, "database", set("/roster", nullptr)},
      {1, "Everybody", none("/roster/protocols")},
      {2, "cover", none(unanalysed),
       set(unanalysed, {{{"task", "task1"}, {"protocol", "task1"}, {"what", "H1"}, {"reason", "so"}}})},
      {5, "cell", none("/descriptives")},
      {5, "No answer", none("/descriptives"), each("/descriptives", "cells", Json::array())},
      {4, "by hand", none(left_out)},
      {1, "Nothing of Pilot and Task 2", set(left_out + "/0/task", "pilot")},
      {1, "Nothing of Pilot, Task 1 and Task 2", left_out_of("task1", "task1"), none(left_out)},
      {1, "Nothing of Task 1 and Task 2", left_out_of("task1", "task2"), left_out_of("pilot", "pilot")},
      {1, "Nothing of Pilot", left_out_of("pilot", "pilot"), left_out_of("task1", "task2")},
      {1, "nought", set(left_out + "/0/position", nullptr)},
      {4, "analysed participants", none("/people")},
  };
}

inline std::vector<Fact> of_timing() {
  const Change flawed = all({each("/timing", "fail", 1), each("/timing_totals", "flawed_cells", 1)}),
               pilots = all({set("/timing/0/fail", 1), set("/timing_totals/0/flawed_cells", 1)}),
               flawless = each("/timing_totals", "flawed_cells", 0);
  return {
      {9, "A photodiode, B display feedback, C compositor, D", none("/timing")},
      {1, "tolerance", all({each("/timing", "unjudged", 5), each("/timing", "showings", 5)})},
      {1, "schedule", each("/timing", "unjudged", 0), set("/timing/0/unjudged", 1)},
      {1, "solved", each("/timing", "active_fraction", 0.5)},
      {4, "by setting", flawless, pilots},
      {9, "by method", flawless, flawed},
  };
}

inline std::vector<Fact> of_costs() {
  const std::string rows = "/costs", made = "/costs/0/made_ms", shown = "/costs/0/shown_ms";
  const Json error{{"error", "centre_pct"}, {"mean", 0.25}, {"low", 0.2}, {"high", 0.3}},
      unknown{{"refused", "no setting file stands in the record"}},
      no_row{{"refused", "the sweep has no row of LoRes"}},
      price{{"machine", "a machine"},
            {"program", "0.1.0"},
            {"picture", "none"},
            {"seconds", 2},
            {"reference_n_star", 512},
            {"ms_mean", 3.5},
            {"ms_p95", 4.5},
            {"times_hires", 1.25},
            {"errors", {{"front_pct", {{"mean", 0.5}, {"low", 0.25}, {"high", 0.75}}}}}};
  const Change with = all({set("/sweep", {{"file", "sweep.db"},
                                          {"errors", {{"front_pct", "front, %"}}},
                                          {"left_out", {"Faucet has no reference"}}}),
                           each(rows, "sweep", Json::array({price}))}),
               lacks_one = all({with, set("/costs/0/sweep", no_row)});
  return {
      {7, "what frames cost", none(rows), set(made, 3.5)},
      {2, "No session", each(rows, "made_ms", 3.5)},
      {3, "Made", each(rows, "made_ms", nullptr), set(made, 3.5)},
      {2, "Shown", each(rows, "shown_ms", nullptr), set(shown, 3.5)},
      {2, "The error", each(rows, "error", unknown), set("/costs/0/error", error)},
      {1, "usual", each(rows, "setting", "several")},
      {2, "none was given", with},
      {4, "in the sweep on", each(rows, "sweep", no_row), with},
      {2, "not in the sweep", with, lacks_one},
      {1, "Not taken", none("/sweep/left_out"), with},
  };
}

}  // namespace report_facts
