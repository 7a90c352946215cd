#include <map>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

const std::string to = " \xE2\x88\x92 ";

std::string score_pair(const Field& pair) { return words(pair["a"]) + to + words(pair["b"]); }

bool of(const Field& entry, const std::string& score, const std::string& n_star) {
  return entry["score"].words() == score && entry["n_star"].words() == n_star;
}

/// Fills the table: calls `row` for each entry of the list `list` of task1 that has this score, grouped by
/// n_*. Returns the table's HTML, or "" without such an entry.
template <class Row>
std::string by_n_star(Table table, const Field& task1, const std::string& list, const std::string& score,
                      Row row) {
  bool any = false;
  for (const Field& n_star : task1["n_stars"].entries()) {
    table.group(n_star_sign + " = " + words(n_star));
    for (const Field& entry : task1[list].entries()) {
      if (!of(entry, score, n_star.words())) continue;
      row(table, entry);
      any = true;
    }
  }
  return any ? table.html() : "";
}

std::string listed(const Field& values) {
  std::string out;
  for (const Field& value : values.entries()) out += (out.empty() ? "" : "; ") + fixed(value, 2);
  return out.empty() ? "none" : out;
}

std::string cells_table(const Field& task1, const Field& score) {
  Table table("Participant means by method, " + words(score["label"]),
              {"Method", "<i>n</i>", "<i>M</i>", "<i>SD</i>", "CI (<i>t</i>)", "CI (BCa)", "Median",
               "Quartiles", "Whiskers", "Values beyond", "Shapiro-Wilk <i>W</i>", "<i>p</i>"});
  return by_n_star(std::move(table), task1, "cells", score["code"].words(), [](Table& t, const Field& c) {
    t.row({words(c["method"]), count(c["n"]), fixed(c["mean"], 2), fixed(c["sd"], 2), interval(c["ci"], 2),
           interval(c["bca"], 2), fixed(c["median"], 2), fixed(c["q1"], 2) + ", " + fixed(c["q3"], 2),
           fixed(c["whisker_low"], 2) + ", " + fixed(c["whisker_high"], 2), listed(c["outliers"]),
           fixed(c["normality"]["w"], 3), p_bare(c["normality"]["p"])});
  });
}

/// True if a pair was tested by the exact sign test, since all its differences are equal.
bool by_sign(const Field& pair) { return pair["test"].words() == "exact sign test"; }

std::string sign_test(const Field& pair) {
  return by_sign(pair) ? " <em>(all differences are equal: " + words(pair["test"]) + ")</em>" : "";
}

std::string t_tests(const Field& task1, const Field& score) {
  Table table("Paired <i>t</i> tests between methods, " + words(score["label"]),
              {"Pair", "<i>n</i>", "Difference [CI]", "<i>t</i>", "<i>df</i>", "<i>p</i>", "",
               "<i>p</i><sub>Holm</sub>", "", "<i>p</i><sub>BH</sub>", "<i>d<sub>z</sub></i> [CI]",
               "Hedges' <i>g</i> [CI]"});
  return by_n_star(
      std::move(table), task1, "comparisons", score["code"].words(), [](Table& t, const Field& c) {
        if (!c["p"].is_number()) {
          t.refused(score_pair(c), "no test: " + typeset(svg::escaped(c["t"].reason())));
          return;
        }
        t.row({score_pair(c) + sign_test(c), count(c["n"]),
               fixed(c["difference"], 2) + " " + interval(c["ci"], 2), fixed(c["t"], 2), fixed(c["df"], 0),
               p_bare(c["p"]), words(c["stars"]), p_bare(c["p_holm"]), words(c["stars_holm"]),
               p_bare(c["p_bh"]), fixed(c["d_z"], 2) + " " + interval(c["d_z_ci"], 2),
               fixed(c["g"], 2) + " " + interval(c["g_ci"], 2)});
      });
}

std::string other_tests(const Field& task1, const Field& score) {
  const std::string note =
      "<p class=\"note\">The level of a Hodges-Lehmann interval is exact where no two differences are tied, "
      "else about right.</p>\n";
  Table table(
      "The same pairs by other tests, " + words(score["label"]),
      {"Pair", "Wilcoxon <i>V</i>", "<i>p</i>", "<i>p</i><sub>Holm</sub>", "Hodges-Lehmann [CI] (its level)",
       "Welch <i>t</i> (<i>df</i>)", "<i>p</i>", "Equivalence within", "CI of equivalence", "<i>p</i>",
       "Equivalent", "BCa interval of the difference", "Shapiro-Wilk <i>p</i>"});
  const std::string table_html =
      by_n_star(std::move(table), task1, "comparisons", score["code"].words(), [](Table& t, const Field& c) {
        const Field w = c["wilcoxon"], welch = c["welch"], tost = c["tost"];
        const auto why = [](const Field& part, const std::string& shown) {
          return part.exists() ? shown : typeset(svg::escaped(part.reason()));
        };
        t.row({score_pair(c), why(w, fixed(w["w"], 1)), p_bare(w["p"]), p_bare(w["p_holm"]),
               fixed(w["location"], 2) + " " + interval(w["ci"], 2) +
                   (w["ci"].exists() ? " (" + percent(w["ci_level"], 1) + ")" : ""),
               why(welch, fixed(welch["t"], 2) + " (" + fixed(welch["df"], 1) + ")"), p_bare(welch["p"]),
               why(tost, "\xC2\xB1" + fixed(tost["margin"], 2)),
               tost.exists() ? percent(tost["ci_confidence"]) + " " + interval(tost["ci"], 2)
                             : interval(tost["ci"], 2),
               p_bare(tost["p"]), yes_no(tost["equivalent"]), interval(c["bca"], 2),
               p_bare(c["normality"]["p"])});
      });
  return table_html.empty() ? "" : table_html + note;
}

/// Sentences in APA style on the t tests and exact sign tests with an uncorrected p below .05.
std::string score_apa_lines(const Field& task1, const std::string& score) {
  std::vector<std::string> lines;
  bool any_tested = false;
  for (const Field& c : task1["comparisons"].entries()) {
    if (c["score"].words() != score) continue;
    any_tested = any_tested || c["p"].is_number();
    if (c["stars"].words().empty()) continue;
    const std::string name = words(c["n_star"]) + ", " + score_pair(c) + ": ";
    const std::string p_values = ", <i>p</i> " + p(c["p"]) + ", <i>p</i><sub>Holm</sub> " + p(c["p_holm"]);
    if (by_sign(c)) {
      lines.push_back(name + "all differences = " + fixed(c["difference"], 2) + ", " + words(c["test"]) +
                      p_values);
      continue;
    }
    lines.push_back(name + "<i>t</i>(" + fixed(c["df"], 0) + ") = " + fixed(c["t"], 2) + p_values +
                    ", <i>d<sub>z</sub></i> = " + fixed(c["d_z"], 2) + ", CI " + interval(c["d_z_ci"], 2));
  }
  if (!any_tested) return paragraph("No pair could be tested.");
  if (lines.empty()) return paragraph("No pair differs below .05, even without correction.");
  return paragraph("Pairs below .05 without correction, in APA style:") + list(lines);
}

std::string omnibus(const Field& task1) {
  Table table("All methods at once",
              {"Score, " + n_star_sign, "<i>n</i>", "Incomplete", "Friedman \xCF\x87\xC2\xB2 (<i>df</i>)",
               "<i>p</i>", "Kendall's <i>W</i>", "<i>F</i> (<i>df</i>)", "<i>p</i>", "GG \xCE\xB5",
               "<i>p</i><sub>GG</sub>", "HF \xCE\xB5 (at most 1)", "<i>p</i><sub>HF</sub>",
               "Partial \xCE\xB7\xC2\xB2", "Generalised \xCE\xB7\xC2\xB2"});
  std::vector<std::string> lines;
  for (const Field& o : task1["omnibus"].entries()) {
    const Field f = o["friedman"], a = o["anova"];
    const std::string name = label_of(task1, o) + ", " + words(o["n_star"]);
    const auto why = [](const Field& part, const std::string& shown) {
      return part.exists() ? shown : typeset(svg::escaped(part.reason()));
    };
    table.row({name, count(o["n"]), count(o["n_incomplete"]),
               why(f, fixed(f["chi2"], 2) + " (" + count(f["df"]) + ")"), p_bare(f["p"]),
               fixed(f["kendall_w"], 2),
               why(a, fixed(a["f"], 2) + " (" + count(a["df1"]) + ", " + count(a["df2"]) + ")"),
               p_bare(a["p"]), fixed(a["epsilon_gg"], 2), p_bare(a["p_gg"]), fixed(a["epsilon_hf"], 2),
               p_bare(a["p_hf"]), fixed(a["partial_eta2"], 2), fixed(a["generalised_eta2"], 2)});
    if (f.exists() && a.exists())
      lines.push_back(name + ": <i>F</i>(" + count(a["df1"]) + ", " + count(a["df2"]) +
                      ") = " + fixed(a["f"], 2) + ", <i>p</i><sub>GG</sub> " + p(a["p_gg"]) +
                      ", \xCE\xB5 = " + fixed(a["epsilon_gg"], 2) + ", generalised \xCE\xB7\xC2\xB2 = " +
                      fixed(a["generalised_eta2"], 2) + "; \xCF\x87\xC2\xB2<sub>F</sub>(" + count(f["df"]) +
                      ") = " + fixed(f["chi2"], 2) + ", <i>p</i> " + p(f["p"]));
  }
  return table.empty() ? "" : subsection("All methods at once", table.html() + list(lines));
}

std::string ordinal(const Field& task1) {
  Table table("Cumulative-link mixed models of single answers: effects of the method, log odds",
              {"Method", "Estimate", "<i>SE</i>", "CI", "<i>z</i>", "<i>p</i>", "<i>p</i><sub>Holm</sub>",
               "<i>p</i><sub>BH</sub>", "Odds ratio"});
  bool penalised = false;
  for (const Field& model : task1["ordinal"].entries()) {
    const std::string name = words(model["question"]) + ", " + words(model["n_star"]);
    if (!model["effects"].exists()) {
      const std::string reason = model.reason().empty() ? model["effects"].reason() : model.reason();
      table.refused(name, "not fitted: " + typeset(svg::escaped(reason)));
      continue;
    }
    const Field overall = model["overall"];
    std::string title = name + ": " + words(model["link"]) + " link, reference " + words(model["reference"]) +
                        ", " + count(model["n"]) + " answers of " + count(model["participants"]) +
                        " participants (SD " + fixed(model["participant_sd"], 2) + "), log-likelihood " +
                        fixed(model["log_likelihood"], 1);
    if (overall.exists())
      title += "; any effect: \xCF\x87\xC2\xB2(" + count(overall["df"]) + ") = " + fixed(overall["chi2"], 2) +
               ", <i>p</i> " + p(overall["p"]);
    if (!model["penalty"].words().empty()) {
      penalised = true;
      title += "; penalised by " + words(model["penalty"]) + ": " + words(model["why_penalised"]);
    }
    table.group(title);
    for (const Field& e : model["effects"].entries())
      table.row({words(e["method"]), fixed(e["estimate"], 2), fixed(e["se"], 2), interval(e["ci"], 2),
                 fixed(e["z"], 2), p_bare(e["p"]), p_bare(e["p_holm"]), p_bare(e["p_bh"]),
                 fixed(e["odds_ratio"], 2)});
  }
  const std::string note =
      penalised ? paragraph(
                      "A penalised model has a weak prior on each effect, because maximum likelihood has no "
                      "finite estimate. Its errors, intervals and p are those of the penalised likelihood.")
                : "";
  return table.empty() ? "" : subsection("Ordinal models", table.html() + note);
}

/// True if the figure by scene cuts off an interval at an end of the scale.
bool cut_intervals(const Field& task1, const Field& score) {
  for (const Field& cell : task1["by_scene"].entries())
    if (cell["score"].words() == score["code"].words() && cell["ci"].entries().size() == 2 &&
        (cell["ci"][0].number() < score["min"].number() || cell["ci"][1].number() > score["max"].number()))
      return true;
  return false;
}

std::string scores_by_scene(const Field& task1) {
  Table table(
      "Scores by scene (not averaged, not tested)",
      {"Scene", "Method", "<i>n</i>", "<i>M</i>", "<i>SD</i>", "CI (<i>t</i>, of participants' means)"});
  std::string last;
  for (const Field& c : task1["by_scene"].entries()) {
    const std::string group = label_of(task1, c) + ", " + n_star_sign + " = " + words(c["n_star"]);
    const std::string key = c["score"].words() + c["n_star"].words();
    if (key != last) table.group(group);
    last = key;
    table.row({words(c["scene"]), words(c["method"]), count(c["n"]), fixed(c["mean"], 2), fixed(c["sd"], 2),
               interval(c["ci"], 2)});
  }
  std::string pictures;
  for (const Field& score : task1["scores"].entries()) {
    if (score["primary"].yes())
      pictures +=
          figure(scene_lines(task1, score),
                 words(score["label"]) +
                     " by scene: means of participants with their intervals, "
                     "not tested." +
                     (cut_intervals(task1, score) ? " An interval that goes beyond the scale is cut at the "
                                                    "scale's end."
                                                  : ""));
  }
  return table.empty() ? "" : subsection("By scene", pictures + table.html());
}

std::string score_retest(const Field& task1) {
  Table table("Repeated showings",
              {"Score", "Pairs", "Mean difference", "Mean absolute difference", "Equal", "Correlation"});
  for (const Field& r : task1["retest"].entries())
    table.row({words(r["score"]), count(r["pairs"]), fixed(r["mean_difference"], 2),
               fixed(r["mean_absolute_difference"], 2), percent(r["exact"]), fixed(r["correlation"], 2)});
  return table.empty() ? "" : subsection("Test and retest", table.html());
}

std::string one_score(const Field& task1, const Field& score) {
  std::string body;
  const bool primary = score["primary"].yes();
  if (primary)
    body +=
        figure(box_plot(task1, score),
               words(score["label"]) +
                   " of each participant, averaged over scenes, as the paper's Fig.&nbsp;9. Box: quartiles "
                   "and median; whiskers: last values within one and a half interquartile ranges; circles: "
                   "values beyond; X and number: mean. Brackets: paired <i>t</i> tests, uncorrected, * "
                   "<i>p</i> &lt; .05, ** <i>p</i> &lt; .01, *** <i>p</i> &lt; .001; solid: still below "
                   ".05 after Holm over the pairs within " +
                   n_star_sign + ", dashed: not.");
  if (primary)
    body += figure(person_lines(task1, score),
                   words(score["label"]) + " of each participant: thin lines; thick line and X: means.");
  if (primary) body += score_ratings(task1, score);
  body += cells_table(task1, score) + t_tests(task1, score);
  if (primary) body += score_apa_lines(task1, score["code"].words());
  body += other_tests(task1, score);
  return subsection(words(score["label"]) + (primary ? "" : " (secondary score)"), body);
}

}  // namespace

std::string task1_section(const Field& root) {
  const Field task1 = root["task1"];
  if (task1.json().is_null()) return "";
  if (!task1.exists()) return section("task1", "Task 1: realism and cybersickness", why_not(task1));
  std::string body = paragraph(
      badge(false) + " " + count(task1["participants"]) + " participants, " + count(task1["reports"]) +
      " reports. All pairwise and omnibus tests of this section describe the data" +
      (root["hypotheses"].entries().empty() ? "." : "; the decisions stand under Hypotheses."));
  std::vector<std::string> rules;
  for (const auto& [name, rule] : task1["rules"].members()) rules.push_back(words(rule));
  body += treatment_note(task1) + list(rules);
  for (const Field& score : task1["scores"].entries()) body += one_score(task1, score);
  return section("task1", "Task 1: realism and cybersickness",
                 body + score_factors(task1) + omnibus(task1) + missing_answers(root) + ordinal(task1) +
                     by_n_star(task1) + scores_by_scene(task1) + reliability(task1) +
                     detectable_scores(task1) + response_times(root, "task1") + score_retest(task1));
}

}  // namespace study::report
