#pragma once
/// The sentences of the report.

#include "tests/apps/report_sentence.hpp"
#include "tests/apps/report_task_sentences.hpp"
#include "tests/apps/report_verdict_sentences.hpp"

namespace report_sentences {

inline std::vector<Case> head_and_methods() {
  const Change no_protocols = set("/study/protocols", Json::array()), no_flow = set("/flow", Json::object());
  const std::string rules = "/plan/exclusions/";
  const Change all_act = in_each("/study/protocols", "rules",
                                 {"timing", "min_catch_correct", "max_repeat_difference",
                                  "min_repeat_agreement", "straight_lining_answers", "min_answered"});
  const Change none_acts = in_each("/study/protocols", "rules", Json::array());
  return {
      {"Parts: # (#, version #), # (#, version #), # (#, version #).", no_protocols},
      {"Computed #.", set("/date_utc", nullptr)},
      {"Test data.", in_each("/study/protocols", "test_data", false),
       set("/study/protocols/0/test_data", true)},
      {"There are no other data of # (#, version #): these results say nothing about people.",
       in_each("/study/protocols", "test_data", false), set("/study/protocols/0/test_data", true)},
      {"Simulated participants: # (#).", in_each("/study/protocols", "simulated", 0)},
      {"All answers of # (#, version #) come from a model: they say nothing about people.",
       in_each("/study/protocols", "simulated", 0)},
      {"The protocol of # was # version # (SHA-256 #), planned for # participants.",
       in_each("/study/protocols", "participants_planned", nullptr)},
      {"The protocol of # was # version # (SHA-256 #).", no_protocols,
       in_each("/study/protocols", "participants_planned", nullptr)},
      {"Sessions of # with analysed answers by source of gaze: *#; by display: *#.",
       in_each("/study/protocols", "gaze", Json::object())},
      {"Sessions of # with analysed answers by vertical angle: *#.",
       in_each("/study/protocols", "angles", Json::object())},
      {"Sessions of # with analysed answers to which the experimenter was not blind: *#.",
       in_each("/study/protocols", "unblinded", Json::object())},
      {"Sessions of # with analysed answers in which pictures of one scene were compared though they differ "
       "in renderer, size or angle, as the protocol accepts: *#.",
       in_each("/study/protocols", "mixed_pictures", Json::object()),
       in_each("/study/protocols", "mixed_pictures",
               {{"a.toml: 640x360 px at 75 degrees by R and 64x36", 2}})},
      {"Effects were a factor of # with the levels *#*.",
       in_each("/study/protocols", "effects", Json::object()),
       in_each("/study/protocols", "effects", {{"none", "no effects"}, {"foam", "keeps foam"}})},
      {"Over the water of every stimulus of # # was painted.",
       in_each("/study/protocols", "overlay", nullptr),
       in_each("/study/protocols", "overlay", "temperature")},
      {"Pilot was begun in # sessions, of which # were completed; of # participants # gave no answer to "
       "analyse, # who had answered were left out and # analysed, with # of # planned trials (# answered "
       "ones left "
       "out).",
       no_flow},
      {"Task [12] was begun in # sessions, of which # were completed; of # participants # gave no answer "
       "to analyse, # who had answered were left out and # analysed, with # of # planned trials (# answered "
       "ones "
       "left out).",
       no_flow},
      {"The same rules of exclusion held for *Task 1 and Task 2: trials whose timing verdict was fail "
       "were left out*",
       set(rules + "timing", "none")},
      {"*: trials whose timing verdict was degraded or fail were left out*", set(rules + "timing", "fail"),
       set(rules + "timing", "degraded")},
      {"*: no trial was left out for its timing verdict*", set(rules + "timing", "fail"),
       set(rules + "timing", "none")},
      {"*; visits with fewer than # of the catch pages right were left out*",
       set(rules + "min_catch_correct", nullptr), all_act},
      {"*; visits whose repeated ratings differed by more than # points on average were left out*",
       set(rules + "max_repeat_difference", nullptr), all_act},
      {"*; visits with less than # of repeated pairs answered alike were left out*", none_acts,
       all({all_act, set(rules + "min_repeat_agreement", 0.5)})},
      {"*; visits with one and the same answer throughout (# answers or more) were left out*",
       set(rules + "straight_lining_answers", 0), set(rules + "straight_lining_answers", 8)},
      {"*; visits with less than # of the trials answered were left out*", set(rules + "min_answered", 0),
       set(rules + "min_answered", 0.5)},
      {"No rule of exclusion could act on Pilot, Task 1 and Task 2.", all_act, none_acts},
      {"Rules of exclusion for Pilot: trials whose timing verdict was fail were left out.", no_flow,
       all({none_acts, set("/study/protocols/0/rules", {"timing"})})},
      {"No rule of exclusion could act on Task 1 and Task 2.", all_act,
       all({none_acts, set("/study/protocols/0/rules", {"timing"})})},
      {"The rules see neither method, scene nor frame rate.", no_flow},
      {"The pilot's curve * was estimated by least squares of all ratings (the model stands under Pilot); "
       "its "
       "intervals by #.",
       set("/pilot/status", "failed")},
      {"Answers of Task 1 were averaged over scenes within each participant, n[*] and method before any "
       "paired "
       "test; methods were compared by paired t tests, with Wilcoxon's signed-rank and Welch's tests beside "
       "them.",
       refused("/task1")},
      {"Equivalence was tested by two one-sided tests with margins of # points on realism and # on "
       "cybersickness.",
       in_each("/task1/scores", "code", "realism")},
      {"Equivalence was tested by two one-sided tests with a margin of # points on realism.",
       refused("/task1"), in_each("/task1/scores", "code", "realism")},
      {"Bootstrap intervals of Task 1 use # resamples with seed #.", refused("/task1")},
      {"H1 to H3 were tested by paired t tests.", set("/plan/tests", "mixed")},
      {"H1 to H3 were tested by paired t tests.", set("/hypotheses", Json::array())},
      {"H1 to H3 were tested by the mixed model of all answers with Satterthwaite's degrees of freedom; "
       "paired "
       "t tests stand beside.",
       set("/plan/tests", "paired"), set("/plan/tests", "mixed")},
      {"Each pair of Task 2 was tested by an exact two-sided binomial test.",
       in_each("/task2/pairs", "by_person", by_person())},
      {"Each pair of Task 2 was tested by an exact two-sided permutation test of people's shares against one "
       "half, since people answered it several times.",
       refused("/task2"), in_each("/task2/pairs", "by_person", by_person())},
      {"Each pair of Task 2 was tested by an exact two-sided binomial test, or by an exact two-sided "
       "permutation test of people's shares against one half, since people answered it several times.",
       refused("/task2"), set("/task2/pairs/0/by_person", by_person())},
      {"What each level of a factor is worth over another was tested within participants by one-sample t "
       "tests, and by exact sign tests where all participants are alike.",
       set("/task1/factors", Json::array()), set("/task1/factors", {score_factor()})},
      {"Tests of the hypotheses were two-sided.", set("/plan/directional", true)},
      {"Tests of the hypotheses were one-sided, in the direction claimed.", set("/plan/directional", false),
       set("/plan/directional", true)},
      {"Tests of the hypotheses were two-sided, but one-sided for #.", set("/plan/directional", true),
       set("/plan/directional", "H2, H3 and H6")},
      {"A hypothesis needed every one of its tests, each significant without correction (intersection-union) "
       "at # (tests in each family: *).",
       by_holm},
      {"Single tests were claimed after Holm's correction within their hypothesis.", by_holm},
      {"Within each hypothesis Holm's correction held the family-wise error rate at # (tests in each family: "
       "*).",
       set("/plan/decision", "intersection-union"), by_holm},
      {"Intervals hold # unless another share stands beside them.", set("/plan/confidence", nullptr)},
      {"The analysis was made with ViP-Lab # and the GNU Scientific Library #.", set("/versions", nullptr)},
      {"Note: #", set("/study/notes", Json::array())},
  };
}

inline std::vector<Case> participants_and_timing() {
  const Change nothing_excluded = set("/exclusions", Json::array()),
               no_timing = set("/timing", Json::array());
  const Change no_answers = set("/descriptives", Json::array());
  const Change all_analysed = set("/not_analysed", Json::array()),
               h1_is_not =
                   set("/not_analysed",
                       {{{"task", "task1"}, {"protocol", "task1"}, {"what", "H1"}, {"reason", "so"}}});
  const Change one_flawed = all({set("/timing/0/fail", 1), set("/timing_totals/0/flawed_cells", 1)}),
               all_flawed =
                   all({in_each("/timing", "fail", 1), in_each("/timing_totals", "flawed_cells", 1)}),
               none_flawed = in_each("/timing_totals", "flawed_cells", 0);
  return {
      {"The database holds # sessions of # participants; # withdrew, of whom nothing is kept.",
       set("/roster", nullptr)},
      {"# Everybody in the database", set("/roster/protocols", Json::array())},
      {"The shipped analyses do not cover these parts of the study:", all_analysed, h1_is_not},
      {"# of # (not analysed): #.", all_analysed, h1_is_not},
      {"Every answer to a trial that is analysed, whatever else is computed from it.", no_answers},
      {"A cell is what was shown in one scene at one n[*]; n counts answers.", no_answers},
      {"# Answers to #*", no_answers},
      {"No answer to # is analysed.", set("/descriptives", Json::array()),
       in_each("/descriptives", "cells", Json::array())},
      {"# What became of those who began: Pilot.", set("/flow/pilot", nullptr)},
      {"# What became of those who began: Task [12].", set("/flow", Json::object())},
      {"Answers count whether or not their session was completed.", set("/flow", Json::object())},
      {"Boxes from top to bottom: sessions started, sessions completed, participants analysed; beside them "
       "those "
       "who left in between, with the reason, and what is counted apart.",
       set("/flow", Json::object())},
      {"# All that was left out by rule or by hand", nothing_excluded},
      {"Answers lost are scores, choices and numbers that were given, those about repeated showings with "
       "them.",
       nothing_excluded},
      {"Nothing of Pilot and Task 2 was left out by rule or by hand.", set("/exclusions/0/task", "pilot")},
      {"Nothing of Pilot* was left out by rule or by hand.",
       set("/exclusions", {{{"task", "task1"}}, {{"task", "pilot"}}})},
      {"Nothing of Pilot, Task 1 and Task 2 was left out by rule or by hand.",
       set("/exclusions", {{{"task", "task1"}}}), nothing_excluded},
      {"Nothing of Task [12]* was left out by rule or by hand.",
       set("/exclusions", {{{"task", "task1"}}, {{"task", "task2"}}}),
       set("/exclusions", {{{"task", "pilot"}}})},
      {"Trials are counted from nought, in the order of showing.", set("/exclusions/0/position", nullptr)},
      {"Every showing that was played is counted, practice aside, also those of trials left out.", no_timing},
      {"Its frames were judged against the protocol's tolerance.",
       all({in_each("/timing", "unjudged", 5), in_each("/timing", "showings", 5)})},
      {"Without a schedule there is nothing to judge by.", in_each("/timing", "unjudged", 0),
       set("/timing/0/unjudged", 1)},
      {"Grades of evidence: A photodiode, B display feedback, C compositor, D submission by the program.",
       no_timing},
      {"# Timing certificate, *", no_timing},
      {"Of # showings # passed, # were degraded, # failed and # could not be judged.", no_timing},
      {"In # of # cells a showing was degraded or failed.", no_timing},
      {"No showing measured the share of particles that was solved.",
       in_each("/timing", "active_fraction", 0.5)},
      {"# Pilot: verdicts by setting, where a showing was degraded or failed.", none_flawed, one_flawed},
      {"# Pilot: cells in which a showing was degraded or failed", none_flawed, one_flawed},
      {"# Task [12]: verdicts by method and n[*], where a showing was degraded or failed.", none_flawed,
       all_flawed},
      {"# Task [12]: cells in which a showing was degraded or failed", none_flawed, all_flawed},
      {"A bar for each setting, mean and SD in frames/s, in which a showing was degraded or failed: the "
       "shares "
       "of its showings whose timing passed, was degraded, failed or could not be judged.",
       none_flawed, one_flawed},
      {"A bar for each method and n[*], over scenes, in which a showing was degraded or failed: the shares "
       "of "
       "its showings whose timing passed, was degraded, failed or could not be judged.",
       none_flawed, all_flawed},
      {"The table below holds the counts of each cell.", none_flawed, one_flawed},
      {"# What the analysed participants answered on pages outside the trials",
       set("/people", Json::array())},
      {"No single person is shown: groups of fewer than # people are taken together with the next smallest; "
       "a "
       "number that fewer than # people gave has no summary; ranges go to whole fives.",
       set("/people", Json::array())},
  };
}

inline std::vector<Case> costs() {
  const Change none = set("/costs", Json::array());
  const Json no_row{{"refused", "the sweep has no row of LoRes"}};
  const Json error{{"error", "centre_pct"}, {"mean", 0.25}, {"low", 0.2}, {"high", 0.3}};
  return {
      {"Live fluid of # ran at these settings of the solver instead of the usual, by sessions with analysed "
       "answers: *#.",
       in_each("/study/protocols", "settings", Json::object()),
       in_each("/study/protocols", "settings", {{"Ours iterations=6 (setting ab)", 3}})},
      {"# Task [12]: what frames cost, what error they carried, what people said", none,
       set("/costs/0/made_ms", 3.5)},
      {"No session of Task [12] holds what a frame costs: it is measured before live sessions on the real "
       "clock.",
       in_each("/costs", "made_ms", 3.5)},
      {"Made: computing and drawing a frame with nothing to wait for, as each station measured it before its "
       "sessions; mean over the sessions that hold it.",
       in_each("/costs", "made_ms", nullptr), set("/costs/0/made_ms", 3.5)},
      {"Shown: mean interval between frames of showings without a schedule, which the display's rate bounds.",
       in_each("/costs", "shown_ms", nullptr), set("/costs/0/shown_ms", 3.5)},
      {"The error is that which the setting file in the record says of itself, in per cent, with its least "
       "and largest start.",
       in_each("/costs", "error", {{"refused", "no setting file stands in the record"}}),
       set("/costs/0/error", error)},
      {"No setting file is stored for a usual setting, so its error is not known here.",
       in_each("/costs", "setting", "several")},
      {"A sweep file (--sweep) holds the errors of usual settings; none was given.", with_sweep},
      {"# Task [12]: cost and error in the sweep on #, program #, pictures #, reference of n[*] #",
       in_each("/costs", "sweep", no_row), with_sweep},
      {"The sweep ran each setting by itself; its times are of its machine and not of the sessions.",
       without_sweep, with_sweep},
      {"Settings of Task [12] that are not in the sweep:", with_sweep,
       all({with_sweep, set("/costs/0/sweep", no_row)})},
      {"# at n[*] # in #: #.", with_sweep, all({with_sweep, set("/costs/0/sweep", no_row)})},
      {"Not taken from the sweep:", set("/sweep/left_out", Json::array()), with_sweep},
  };
}

inline const std::vector<Case>& cases() {
  static const std::vector<Case> list = [] {
    std::vector<Case> out;
    for (auto part : {head_and_methods(), participants_and_timing(), pilot(), task1(), task2(), costs(),
                      sickness(), hypotheses(), bundle_and_provenance()})
      out.insert(out.end(), part.begin(), part.end());
    return out;
  }();
  return list;
}

}  // namespace report_sentences
