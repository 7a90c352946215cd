#pragma once
/// The report's sentences about the pilot and the tasks.

#include "tests/apps/report_sentence.hpp"

namespace report_sentences {

/// The effect of foam over none, as the results give it if effects are a factor.
inline Json preference_factor() {
  return {{"factor", "effects"}, {"a", "none"},      {"b", "foam"},
          {"participants", 16},  {"n", 32},          {"k", 10},
          {"share", 0.3125},     {"test", "t test"}, {"mean", 0.3125},
          {"ci", {0.2, 0.4}},    {"t", -2.5},        {"df", 15},
          {"p", 0.024},          {"p_holm", 0.024},  {"reason", ""}};
}
/// The test of a pair over people, some of whom answered more than once.
inline Json by_person() {
  return {{"participants", 9}, {"share", 0.6}, {"ci", {0.4, 0.8}}, {"ci_name", "of people"}, {"p", 0.03}};
}
inline Json score_factor() {
  return {{"score", "realism"},
          {"n_star", "16k"},
          {"factor", "effects"},
          {"a", "none"},
          {"b", "foam"},
          {"participants", 16},
          {"test", "exact sign test"},
          {"mean", -1},
          {"ci", nullptr},
          {"t", nullptr},
          {"df", nullptr},
          {"p", 0.0001},
          {"p_holm", 0.0001},
          {"reason", ""}};
}

/// A pilot whose threshold is not exponential, as its results give it.
inline Json other_form() {
  return {{"rejected", true},
          {"text", "c = -0.2, it levels off"},
          {"free_curve",
           {{{"delta", 0}, {"mu", 24.5}, {"ci", {22.5, 26.5}}, {"simultaneous_ci", {21.5, 27.5}}},
            {{"delta", 1}, {"mu", 25.5}, {"ci", {23.5, 27.5}}, {"simultaneous_ci", {22.5, 28.5}}}}}};
}

inline Json raters() {
  return {{"reverse_coders", {{"text", "no participant"}}},
          {"drift", {{"text", "scores change by +0.1"}}},
          {"lapses", {{"text", "0 of 100 answers"}}}};
}

inline std::vector<Case> pilot() {
  const Change failed = all({set("/pilot/status", "failed"), set("/pilot/reason", "no contour")});
  return {
      {"# participants gave # ratings of # settings.", failed},
      {"For the solver, at level #: a = # [[]#, #] frames/s, b = # [[]#, #] s/frame.", failed},
      {"No fit: *.", set("/pilot/status", "ok"), failed},
      {"# Mean scores over the standard deviation and the mean of the frame rate, with contours and the "
       "fitted "
       "curve, as the paper's Fig._6.",
       set("/pilot/cells", Json::array())},
      {"Heat map of mean scores over the standard deviation and the mean of the frame rate, with contours of "
       "the "
       "scores and the fitted curve.",
       set("/pilot/cells", Json::array())},
      {"# Estimates of \u03bc(\u03b4) = a\u2009eb\u2009\u03b4, intervals over participants",
       all({set("/pilot/estimators", Json::array()), set("/pilot/means", Json::object()),
            set("/pilot/a", nullptr)})},
      {"About the fit: #*", set("/pilot/flags", Json::array())},
      {"Shape of the scores: #.", refused("/pilot/lack_of_fit")},
      {"Direction of the ratings: #.", set("/pilot/raters", Json::object()), set("/pilot/raters", raters())},
      {"Drift over the session: #.", set("/pilot/raters", Json::object()), set("/pilot/raters", raters())},
      {"Lapses to the lowest score: #.", set("/pilot/raters", Json::object()),
       set("/pilot/raters", raters())},
      {"Form of the curve: #.", refused("/pilot/form"), set("/pilot/form", other_form())},
      {"# The free curve, which has one parameter more, with its bands, frames/s",
       set("/pilot/form/rejected", false), set("/pilot/form", other_form())},
      {"# The curve \u03bc(\u03b4) with its bands, frames/s", set("/pilot/bands", Json::array())},
      {"Model of the direct estimate, least squares of all ratings with a participant's ratings of one "
       "setting "
       "averaged, at the realised \u03bc and \u03b4:",
       set("/pilot/estimator", nullptr)},
      {"E[[]score] = level + *", set("/pilot/estimator", nullptr)},
      {"Intervals: # (bootstrap: # resamples, seed #).", failed},
      {"# How often each score was given, by setting (mean and standard deviation of the frame rate, "
       "frames/s).",
       set("/pilot/distributions", Json::array())},
      {"A bar for each line of names: the shares of its answers that gave each score, from the lowest at the "
       "left to the highest at the right, with how many they were.",
       all({set("/pilot/distributions", Json::array()), set("/task1/distributions", Json::array())})},
      {"# Scores of the settings, over participants", set("/pilot/cells", Json::array())},
  };
}

inline std::vector<Case> task1() {
  const Change no_task = refused("/task1"), no_pairs = set("/task1/comparisons", Json::array());
  const Change secondary = in_each("/task1/scores", "primary", false);
  // Also in words: p below .05 without t.
  const Change unanimous =
      all({set("/task1/comparisons/0/t", nullptr), set("/task1/comparisons/0/stars", "*"),
           set("/task1/comparisons/0/test", "exact sign test")});
  const auto lacking = [](int answers) {
    const Json side{{"missing", answers}, {"worse_by", nullptr}};
    return in_each("/task1/comparisons", "tipping",
                   {{"planned", 16}, {"holds", false}, {"a", side}, {"b", side}, {"reason", ""}});
  };
  const Change no_hypotheses = set("/hypotheses", Json::array());
  const auto stars = [](const std::string& text) { return in_each("/task1/comparisons", "stars", text); };
  return {
      {"Exploratory # participants, # reports.", no_task},
      {"All pairwise and omnibus tests of this section describe the data; the decisions stand under "
       "Hypotheses.",
       set("/hypotheses", Json::array())},
      {"All pairwise and omnibus tests of this section describe the data.", no_task,
       set("/hypotheses", Json::array())},
      {"Not given: *.", set("/task1", nullptr), no_task},
      {"# # of each participant, averaged over scenes, as the paper's Fig._9.", secondary},
      {"Box: quartiles and median; whiskers: last values within one and a half interquartile ranges; "
       "circles: "
       "values beyond; X and number: mean.",
       secondary},
      {"Brackets: paired t tests, uncorrected, [*] p < .05, [*][*] p < .01, [*][*][*] p < .001; solid: still "
       "below .05 after Holm over the pairs within n[*], dashed: not.",
       secondary},
      {"A box for each method within each n[*]: median, quartiles, whiskers to the last values within one "
       "and a "
       "half times the interquartile range, circles beyond them, an X at the mean.",
       secondary},
      {"Brackets with stars join methods that differ.", secondary},
      {"The tables below hold the same numbers.", secondary},
      {"# Participant means by method, #", set("/task1/cells", Json::array())},
      {"# Paired t tests between methods, #", no_pairs},
      {"# The same pairs by other tests, #", no_pairs},
      {"The level of a Hodges-Lehmann interval is exact where no two differences are tied, else about right.",
       no_pairs},
      {"Pairs below .05 without correction, in APA style:", stars("")},
      {"#, # \u2212 #: t(#) = #, p *, pHolm *, dz = #, CI [[]#, #]", stars("")},
      {"#, # \u2212 #: all differences = #, #, p *, pHolm *",
       in_each("/task1/comparisons", "test", "paired t test"), unanimous},
      {"No pair differs below .05, even without correction.", stars("*"), stars("")},
      {"No pair could be tested.", in_each("/task1/comparisons", "p", 0.5),
       in_each("/task1/comparisons", "p", nullptr)},
      {"# All methods at once", set("/task1/omnibus", Json::array())},
      {"#, #: F(#, #) = #, pGG *, \u03b5 = #, generalised \u03b7\u00b2 = #; \u03c7\u00b2F(#) = #, p *",
       set("/task1/omnibus", Json::array())},
      {"Differences of such pairs do not add up:", in_each("/task1/people", "differ", false),
       in_each("/task1/people", "differ", true)},
      {"#, n[*] = #: pairs rest on different people, # to # of # planned; # judged every method",
       in_each("/task1/people", "differ", false), in_each("/task1/people", "differ", true)},
      {"The mixed model takes every answer, with scene, position and period as terms and random effects of "
       "the participant and of the participant with each method; degrees of freedom are Satterthwaite's.",
       all({no_pairs, set("/task1/mixed", Json::array())})},
      {"# Differences between methods by the mixed model", no_pairs},
      {"# The mixed models: standard deviations, and terms beside the methods",
       set("/task1/mixed", Json::array())},
      {"A tipping point is by how many points missing answers to one method must be worse than those of the "
       "others let expect before the decision changes; any: none is enough.",
       all({no_pairs, set("/hypotheses", Json::array())})},
      {"# Tipping points of the paired t tests", no_pairs},
      {"# Tipping points of the tests of H1 to H3", set("/hypotheses", Json::array())},
      {"No participant lacks an answer to a method: there are no tipping points.", lacking(1),
       all({lacking(0), no_hypotheses})},
      {"No tipping points: too few answers.", lacking(1),
       all({in_each("/task1/comparisons", "tipping", {{"refused", "too few answers"}}), no_hypotheses})},
      {"# Cumulative-link mixed models of single answers: effects of the method, log odds",
       set("/task1/ordinal", Json::array())},
      {"A penalised model has a weak prior on each effect, because maximum likelihood has no finite "
       "estimate.",
       in_each("/task1/ordinal", "penalty", ""), in_each("/task1/ordinal", "penalty", "log-F(1, 1)")},
      {"Its errors, intervals and p are those of the penalised likelihood.",
       in_each("/task1/ordinal", "penalty", ""), in_each("/task1/ordinal", "penalty", "log-F(1, 1)")},
      {"# What each level is worth over another, all else alike: participants' differences against nought; "
       "Holm over the pairs of levels of one factor, score and n[*], not over the table",
       set("/task1/factors", Json::array()), set("/task1/factors", {score_factor()})},
      {"# Scores by scene (not averaged, not tested)", set("/task1/by_scene", Json::array())},
      {"# # by scene: means of participants with their intervals, not tested.", secondary},
      {"A line for each scene over the methods within each n[*]: means of the participants who judged it "
       "there, "
       "with their intervals.",
       secondary},
      {"An interval that goes beyond the scale is cut at the scale's end.",
       in_each("/task1/by_scene", "ci", nullptr), set("/task1/by_scene/0/ci", {-3, 12})},
      {"The table of scores by scene holds the numbers.", secondary},
      {"# # of each participant: thin lines; thick line and X: means.", secondary},
      {"A thin line for each participant over the methods within each n[*], so that it is seen who differs "
       "how; "
       "the thick line with an X joins the means.",
       secondary},
      {"# How often each score of # was given, by n[*] and method; single answers, not averaged.",
       set("/task1/distributions", Json::array())},
      {"# Whether the difference of two methods depends on n[*]: the difference at the first less that at "
       "the "
       "second, paired within participants",
       set("/task1/by_n_star", Json::array())},
      {"Holm over the pairs of methods of one score.", set("/task1/by_n_star", Json::array())},
      {"Where a participant sees another scene at each n[*], the scene is part of the difference.",
       set("/task1/by_n_star", Json::array())},
      {"# Reliability of the scores of several items: Cronbach's \u03b1",
       set("/task1/reliability", Json::array())},
      {"Of each participant's mean answers to the items over all reports at this n[*]; intervals after "
       "Feldt.",
       set("/task1/reliability", Json::array())},
      {"# The smallest difference that a paired t test of so many participants finds",
       set("/task1/detectable", Json::array())},
      {"# Time from the page's showing to the last change of the answer, s",
       set("/response_times", Json::array())},
      {"Not given: simulated participants take no time to answer.", in_each("/response_times", "median", 2.5),
       all({in_each("/response_times", "median", nullptr),
            in_each("/response_times", "reason", "simulated participants take no time to answer")})},
      {"Not given for the other questions: simulated participants take no time to answer.",
       in_each("/response_times", "median", 2.5),
       all({set("/response_times/0/median", nullptr),
            set("/response_times/0/reason", "simulated participants take no time to answer")})},
      {"# Repeated showings", set("/task1/retest", Json::array()),
       set("/task1/retest", {{{"score", "realism"}, {"pairs", 4}}})},
  };
}

inline std::vector<Case> task2() {
  const Change no_task = refused("/task2");
  const std::string bias = "/task2/interval_bias", model = "/task2/bradley_terry";
  return {
      {"Exploratory # participants, # answers.", no_task},
      {"The tests of all pairs describe the data; the decisions stand under Hypotheses.",
       set("/hypotheses", Json::array())},
      {"The tests of all pairs describe the data.", no_task, set("/hypotheses", Json::array())},
      {"# Share of answers that chose each of a pair, as the paper's Fig._10; line: interval of the share "
       "(Wilson*).",
       in_each("/task2/pairs", "by_person", by_person())},
      {"# Share of answers that chose each of a pair, as the paper's Fig._10; line: interval of the share "
       "(#).",
       no_task, in_each("/task2/pairs", "by_person", by_person())},
      {"# Share of answers that chose each of a pair, as the paper's Fig._10.", no_task,
       in_each("/task2/pairs", "wilson", nullptr)},
      {"Stars: #*, uncorrected / after Holm over all pairs.", in_each("/task2/pairs", "test", nullptr)},
      {"# of # participants answered a pair more than once, at most # times.",
       set("/task2/several_answers/participants", 0), set("/task2/several_answers/participants", 3)},
      {"A bar for each pair of methods: the plain part on the left is the share of answers that chose the "
       "method "
       "named on the left, the hatched part the other's.",
       no_task},
      {"The line across the bar is the share's interval, the dotted line no preference.", no_task},
      {"The table below holds the same numbers.", no_task},
      {"# How often each of a pair was chosen, with a two-sided test of each pair", no_task},
      {"# over #: # of # (#), CI [[]#, #]*, p *, pHolm *", in_each("/task2/pairs", "p", nullptr)},
      {"# over #: # of # answers of # people, mean share #, CI [[]#, #], #, p *, pHolm *",
       in_each("/task2/pairs", "by_person", nullptr), in_each("/task2/pairs", "by_person", by_person())},
      {"The first of a pair was chosen in # of # answers (#, CI [[]#, #], exact binomial p *).",
       refused(bias)},
      {"Note: #.", set(bias + "/warning", ""), set(bias + "/warning", "one answered all pairs alike")},
      {"Over participants: mean share # [[]#, #], t(#) = #, p *.", refused(bias + "/by_participant")},
      {"Over participants: every share is #, #, p *.", set(bias + "/by_participant/test", "t test"),
       set(bias + "/by_participant/test", "exact sign test")},
      {"# Abilities on the log-odds scale, with mean zero", refused(model)},
      {"A method or a group of methods was always or never chosen over all others: the estimates are "
       "Firth's, "
       "penalised.",
       set(model + "/penalised", false), set(model + "/penalised", true)},
      {"Errors and intervals allow for the likeness of one person's answers (sandwich over people, t with # "
       "degrees of freedom).",
       all({set(model + "/people/errors", "independent answers"),
            set(model + "/people/why_independent", "too few")})},
      {"Errors and intervals take all answers as independent: #.", set(model + "/people/errors", "people"),
       all({set(model + "/people/errors", "independent answers"),
            set(model + "/people/why_independent", "too few")})},
      {"All methods equal, if answers were independent: \u03c7\u00b2(#) = #, p *",
       set(model + "/overall", nullptr)},
      {"All methods equal, over people: F(#, #) = #, p *", set(model + "/people/equal", nullptr)},
      {"Lack of fit over the pairs, if answers were independent: \u03c7\u00b2(#) = #, p *",
       set(model + "/fit", nullptr)},
      {"Effect of the order (log odds of the first interval): # [[]#, #], SE = #, p *",
       set(model + "/order", nullptr)},
      {"Participants who judged every pair once: # (others: #).", refused("/task2/triads")},
      {"Mean number of circular triads # (random answers: #), mean consistency (Kendall's \u03b6) #; as few "
       "or "
       "fewer by chance: p *.",
       refused("/task2/triads")},
      {"Effects are a factor: what is called a method here is one with a level of effects.",
       set("/task2/factors", Json::array()), set("/task2/factors", {preference_factor()})},
      {"# What each level is worth over another, all else alike: participants' shares against one half; Holm "
       "over the pairs of levels of one factor, not over the table",
       set("/task2/factors", Json::array()), set("/task2/factors", {preference_factor()})},
      {"# Choices by scene (not tested)", set("/task2/by_scene", Json::array())},
      {"The exact binomial test of # answers at \u03b1 = # finds a true preference of # with a power of #.",
       set("/task2/detectable", nullptr)},
      {"Not given: too few answers: not even a choice by all is significant at this level.",
       set("/task2/detectable", nullptr),
       set("/task2/detectable",
           {{"n", 5},
            {"share", nullptr},
            {"reason", "too few answers: not even a choice by all is significant at this level"}})},
      {"Of # pairs shown again, # were answered alike.", set("/task2/retest", nullptr),
       set("/task2/retest", {{"pairs", 4}, {"same", 0.5}})},
  };
}

}  // namespace report_sentences
