/// The page of a study with factors.

#include <algorithm>
#include <cmath>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/page.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

constexpr const char* italic_m = "<i>M</i>";

std::string exploratory_badge() { return badge(false); }

std::string declared_badge(const Field& hypothesis) {
  return hypothesis["status"].words() == "preregistered" ? badge(true)
                                                         : "<span class=\"badge\">Declared</span>";
}

std::string table_badge(const Field& part) {
  return part["exploratory"].yes() ? exploratory_badge()
                                   : "<span class=\"badge\">Outcome of a declared hypothesis</span>";
}

std::string note(const std::string& html) { return "<p class=\"note\">" + html + "</p>\n"; }

/// A number with three decimals if its absolute value is below 2, two if below 20, else one.
std::string value_of_scale(const Field& field) {
  const double size = field.number() < 0 ? -field.number() : field.number();
  return fixed(field, size < 2 ? 3 : size < 20 ? 2 : 1);
}

std::string interval_of_scale(const Field& field) {
  double size = 0;
  for (const Field& end : field.entries()) size = std::max(size, std::abs(end.number()));
  return interval(field, size < 2 ? 3 : size < 20 ? 2 : 1);
}

std::string confidence_head(const Field& root) { return percent(root["plan"]["confidence"]) + " interval"; }

std::string people_section(const Field& root) {
  const Field flow = root["flow"];
  Table table("What became of participants, sessions and trials", {"What", "Number"});
  const auto row = [&](const char* what, const Field& field) { table.row({what, count(field)}); };
  table.group("Participants");
  row("with a started session", flow["participants"]);
  row("without an answer", flow["no_answer"]);
  row("excluded whole", flow["excluded_participants"]);
  row("analysed", flow["analysed"]);
  row("withdrawn", flow["withdrawn"]);
  if (root["since"].exists()) row("new since the earlier result", root["since"]["new"]);
  for (const Field& group : root["groups"].entries())
    table.row({"analysed, " + words(group["group"]), count(group["participants"])});
  table.group("Sessions");
  row("done", flow["done"]);
  row("open", flow["open"]);
  row("stopped", flow["stopped"]);
  row("dropped out", flow["dropped_out"]);
  row("no consent", flow["no_consent"]);
  row("not eligible", flow["not_eligible"]);
  table.group("Trials");
  row("planned", flow["trials_planned"]);
  row("answered", flow["trials_answered"]);
  row("excluded", flow["trials_excluded"]);
  row("analysed", flow["trials_analysed"]);
  Table out("Exclusions", {"Participant", "Trial", "Rule", "Reason"});
  for (const Field& one : root["exclusions"].entries())
    out.row({words(one["participant"]), one["position"].is_number() ? count(one["position"]) : "whole visit",
             words(one["rule"]), words(one["reason"])});
  return section("participants", "Participants",
                 table.html() + (out.empty() ? paragraph("Nothing was excluded.") : out.html()));
}

/// How the particles were drawn; "" if the protocol names no surface.
std::string surfaces_text(const Field& surfaces) {
  std::vector<std::string> all;
  for (const auto& [surface, level] : surfaces.members()) {
    const std::string cells = level.words().empty() ? "some cells" : "cells with " + words(level);
    all.push_back("as " + svg::escaped(surface) + " in " +
                  (level.words() == "every stimulus" ? level.words() : cells));
  }
  return all.empty() ? "" : paragraph("The particles were drawn " + base::enumerated(all) + ".");
}

std::string design_section(const Field& root) {
  const Field design = root["design"];
  Table table("Factors", {"Factor", "Varies", "Levels"});
  for (const Field& factor : design["factors"].entries()) {
    std::string levels;
    for (const Field& level : factor["levels"].entries())
      levels += (levels.empty() ? "" : ", ") + words(level);
    table.row({words(factor["name"]),
               factor["vary"].words() == "between" ? "between participants" : "within participants", levels});
  }
  std::string more;
  if (design["standard"].exists()) {
    std::string standard;
    for (const auto& [factor, level] : design["standard"].members())
      standard += (standard.empty() ? "" : ", ") + svg::escaped(factor) + " " + words(level);
    std::vector<std::string> same;
    for (const Field& factor : design["factors"].entries())
      if (factor["vary"].words() != "between" && !design["standard"][factor["name"].words()].exists())
        same.push_back(words(factor["name"]));
    more += paragraph("Each trial shows a pair: a comparison and the standard, " + standard +
                      (same.empty() ? "" : ", both with the same level of " + base::enumerated(same)) + ".");
  }
  more += surfaces_text(design["surfaces"]);
  if (design["procedure"].exists())
    more += paragraph("The procedure " + words(design["procedure"]["kind"]) + " chose the level of " +
                      words(design["procedure"]["factor"]) + " in each trial, " +
                      count(design["procedure"]["trials"]) + " trials in each track.");
  return section("design", "Design", table.html() + more);
}

std::string statistic(const Field& one) {
  if (!one["statistic_value"].is_number()) return "\xE2\x80\x93";
  std::string out = "<i>" + words(one["statistic"]) + "</i>";
  if (one["df"].is_number()) out += "(" + fixed(one["df"], 1) + ")";
  return out + " = " + fixed(one["statistic_value"], 2);
}

std::string estimate_of(const Field& one) {
  const std::string value = value_of_scale(one["estimate"]);
  return one["estimated"].words().empty() ? value : words(one["estimated"]) + "<br/>" + value;
}

std::string sizes(const Field& one) {
  if (!one["n_a"].is_number()) return "\xE2\x80\x93";
  return !one["groups"].yes() && one["n_a"].number() == one["n_b"].number()
             ? count(one["n_a"])
             : count(one["n_a"]) + " and " + count(one["n_b"]);
}

std::string tested_section(const Field& root) {
  const auto tested = root["hypotheses"].entries();
  std::string frozen;
  if (root["preregistration"].exists()) {
    frozen =
        paragraph("Preregistration of " + words(root["preregistration"]["frozen_utc"]) +
                  ", hash <span class=\"hash\">" + words(root["preregistration"]["sha256"]) + "</span>.");
    for (const Field& problem : root["preregistration"]["problems"].entries())
      frozen += note("Not preregistered: " + words(problem) + ".");
  }
  if (tested.empty())
    return section("hypotheses", "Hypotheses",
                   paragraph("The plan declares no hypothesis. " + exploratory_badge() +
                             " Every result of this page is exploratory."));
  Table table("Declared tests", {"Hypothesis", "Test", "<i>n</i>", "Estimate", "Interval", "Statistic",
                                 "<i>p</i>", "Adjusted <i>p</i>", "Effect size", "Result"});
  std::string notes;
  for (const Field& one : tested) {
    const std::string name = words(one["id"]) + " " + declared_badge(one) + "<br/>" +
                             (one["text"].words().empty() ? "" : words(one["text"]) + "<br/>") +
                             words(one["outcome"]) + ": " + words(one["a"]) + " against " + words(one["b"]);
    std::string test = words(one["test_name"]);
    if (!one["alternative"].words().empty()) test += ", " + words(one["alternative"]);
    if (one["margin"].is_number()) test += ", margin " + fixed(one["margin"], 2);
    if (!one["family"].words().empty())
      test += ", family " + words(one["family"]) + " (" + words(one["adjust"]) + ")";
    const std::string effect = one["effect_size"].is_number()
                                   ? words(one["effect"]) + " = " + fixed(one["effect_size"], 2)
                                   : "\xE2\x80\x93";
    table.row({name, test, sizes(one), estimate_of(one),
               one["ci"].exists() ? percent(one["ci_confidence"]) + " " + interval_of_scale(one["ci"])
                                  : interval_of_scale(one["ci"]),
               statistic(one), p_bare(one["p"]), p_bare(one["p_adjusted"]), effect,
               one["holds"].yes() ? "holds" : "does not hold"});
    if (!one["reason"].words().empty()) notes += note(words(one["id"]) + ": " + words(one["reason"]) + ".");
  }
  Table again("The same tests under other rules",
              {"Hypothesis", "Variant", "Participants", "Estimate", "Adjusted <i>p</i>", "Result"});
  for (const Field& one : root["sensitivity"].entries())
    again.row({words(one["id"]), words(one["variant"]), count(one["participants"]),
               value_of_scale(one["estimate"]), p_bare(one["p_adjusted"]),
               std::string(one["holds"].yes() ? "holds" : "does not hold") +
                   (one["changed"].yes() ? ", changed" : "")});
  return section(
      "hypotheses", "Hypotheses",
      frozen + table.html() +
          note("A test holds if its adjusted <i>p</i> is below " + fixed(tested.front()["alpha"], 3) +
               ". Differences are those of the first condition minus the second.") +
          notes + again.html());
}

/// A figure is drawn for 2 to 60 cells. A single cell needs no figure, and the rows of more than 60 cells
/// cannot be compared at a glance.
constexpr std::size_t least_cells_drawn = 2, most_cells_drawn = 60;

std::string answers_section(const Field& root) {
  std::string body;
  std::size_t number = 0;
  for (const Field& question : root["descriptives"].entries()) {
    Table table(words(question["question"]) + ": " + words(question["text"]) + " (" +
                    words(question["value_text"]) + ")",
                {"Cell", "Participants", "Trials", italic_m, "<i>SD</i>", confidence_head(root), "Answers"});
    for (const Field& cell : question["cells"].entries()) {
      std::string given;
      for (const Field& score : cell["counts"].entries()) {
        if (score["n"].number() <= 0) continue;
        given += (given.empty() ? "" : ", ") +
                 (score["words"].words().empty() ? count(score["score"]) : words(score["words"])) + ": " +
                 count(score["n"]);
      }
      const std::string other = cell["other"].words().empty() ? "" : " and " + words(cell["other"]);
      table.row({words(cell["cell"]) + other, count(cell["participants"]), count(cell["trials"]),
                 value_of_scale(cell["mean"]), value_of_scale(cell["sd"]), interval_of_scale(cell["ci"]),
                 given});
    }
    if (table.empty()) continue;
    body += paragraph(table_badge(question));
    const std::size_t cells = question["cells"].entries().size();
    if (cells >= least_cells_drawn && cells <= most_cells_drawn)
      body += figure(cell_means_chart(question, "means-" + std::to_string(++number)),
                     "Means over participants (points) with " + percent(root["plan"]["confidence"]) +
                         " intervals (lines).");
    body += table.html();
  }
  if (body.empty()) return "";
  const std::string chosen = root["design"]["procedure"].exists()
                                 ? " The procedure chose the levels from earlier answers, so participants "
                                   "count at the levels that they "
                                   "saw."
                                 : "";
  return section(
      "answers", "Answers by cell",
      note("Means, standard deviations and intervals are over the participants' means." + chosen) + body);
}

std::string thresholds_section(const Field& root) {
  const Field thresholds = root["thresholds"];
  if (!thresholds.exists()) return "";
  std::string figures;
  Table means("Mean threshold over participants, " + words(thresholds["axis"]),
              {"Track", "<i>n</i>", italic_m, "<i>SD</i>", confidence_head(root)});
  std::size_t number = 0;
  for (const Field& track : thresholds["tracks"].entries()) {
    const std::string name = track["track"].words().empty() ? "all trials" : words(track["track"]);
    means.row({name, count(track["n"]), value_of_scale(track["mean"]), value_of_scale(track["sd"]),
               interval_of_scale(track["ci"])});
    figures += figure(psychometric_chart(thresholds, track, "psychometric-" + std::to_string(++number)),
                      "Share of positive answers of all participants (circles; the area is the number of "
                      "trials), mean of the participants' psychometric functions (line), mean threshold with "
                      "interval (dashed).");
  }
  Table people(
      "Threshold of each participant, with " + percent(thresholds["credibility"]) + " credible intervals",
      {"Participant", "Track", "Trials", "Threshold", "Interval", "Shape", "Interval of the shape"});
  for (const Field& one : thresholds["participants"].entries())
    people.row({words(one["participant"]), one["track"].words().empty() ? "all trials" : words(one["track"]),
                count(one["trials"]), value_of_scale(one["threshold"]),
                interval_of_scale(one["threshold_ci"]), value_of_scale(one["shape"]),
                interval_of_scale(one["shape_ci"])});
  return section("thresholds", "Thresholds",
                 paragraph(table_badge(thresholds)) + means.html() + figures +
                     details("Every participant", people.html()));
}

std::string shown_section(const Field& root) {
  Table table("Timing that was asked for and shown, by cell",
              {"Cell", "Asked", "Showings", "Pass", "Degraded", "Fail", "Not judged", "Mean frames/s",
               "<i>SD</i>", "Longest ms", "Late frames"});
  for (const Field& cell : root["timing"].entries())
    table.row({words(cell["cell"]), words(cell["asked"]), count(cell["showings"]), count(cell["pass"]),
               count(cell["degraded"]), count(cell["fail"]), count(cell["unjudged"]),
               fixed(cell["realised_mean_fps"], 2), fixed(cell["realised_sd_fps"], 2),
               fixed(cell["longest_ms"], 1), count(cell["late_frames"])});
  return table.empty() ? "" : section("timing", "Timing", table.html() + station_timing(root, "own", ""));
}

}  // namespace

std::string factor_study_page(const Json& results) {
  const Field root(results);
  if (root["schema"].words() != "vip-study/1")
    throw base::Error("results", "schema is \"" + root["schema"].words() + "\", not \"vip-study/1\"",
                      "compute the results anew with this version of vip-stats");
  std::string notes;
  for (const Field& one : root["study"]["notes"].entries()) notes += note(words(one));
  return whole_page("Results of " + root["study"]["database"].words(),
                    "<main id=\"main\">\n" + head_section(root) + notes + design_section(root) +
                        tested_section(root) + people_section(root) + answers_section(root) +
                        thresholds_section(root) + shown_section(root) + provenance_section(root) +
                        "</main>\n");
}

}  // namespace study::report
