#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

std::string difference_name(const Field& pair) {
  return words(pair["a"]) + " \xE2\x88\x92 " + words(pair["b"]);
}

std::string score_label(const Field& task1, const Field& entry) {
  for (const Field& score : task1["scores"].entries()) {
    if (score["code"].words() == entry["score"].words()) return words(score["label"]);
  }
  return words(entry["score"]);
}

/// Notes on scores whose pairs of methods were judged by different participants.
std::string people_notes(const Field& task1) {
  std::vector<std::string> lines;
  for (const Field& one : task1["people"].entries()) {
    if (!one["differ"].yes()) continue;
    lines.push_back(score_label(task1, one) + ", " + n_star_sign + " = " + words(one["n_star"]) +
                    ": pairs rest on different people, " + count(one["fewest"]) + " to " +
                    count(one["most"]) + " of " + count(one["planned"]) + " planned; " + count(one["all"]) +
                    " judged every method");
  }
  if (lines.empty()) return "";
  return "<div class=\"warning\">" + paragraph("Differences of such pairs do not add up:") + list(lines) +
         "</div>";
}

/// Calls `row` for each comparison for which `wanted` is true. Before the first such comparison of each score
/// and n_*, adds a heading with both to the table.
template <class Wanted, class Row>
void by_score(Table& table, const Field& task1, Wanted wanted, Row row) {
  std::string last;
  for (const Field& c : task1["comparisons"].entries()) {
    if (!wanted(c)) continue;
    const std::string key = c["score"].words() + c["n_star"].words();
    if (key != last) table.group(score_label(task1, c) + ", " + n_star_sign + " = " + words(c["n_star"]));
    last = key;
    row(c);
  }
}

std::string comparisons(const Field& task1) {
  Table table("Differences between methods by the mixed model",
              {"Pair", "M<sub>diff</sub> [CI]", "<i>SE</i>", "<i>t</i>", "<i>df</i>", "<i>p</i>",
               "<i>p</i><sub>Holm</sub>"});
  const auto all = [](const Field&) { return true; };
  by_score(table, task1, all, [&](const Field& c) {
    const Field m = c["mixed"];
    if (!m.exists()) {
      table.refused(difference_name(c), "no test: " + typeset(svg::escaped(m.reason())));
      return;
    }
    table.row({difference_name(c), fixed(m["estimate"], 2) + " " + interval(m["ci"], 2), fixed(m["se"], 2),
               fixed(m["t"], 2), fixed(m["df"], 1), p_bare(m["p"]), p_bare(m["p_holm"])});
  });
  return table.empty() ? "" : table.html();
}

std::string models(const Field& task1) {
  Table table("The mixed models: standard deviations, and terms beside the methods",
              {"Term", "Estimate [CI]", "<i>SE</i>", "<i>t</i>", "<i>df</i>", "<i>p</i>"});
  for (const Field& model : task1["mixed"].entries()) {
    if (!model["n"].is_number()) {
      table.refused(score_label(task1, model), "not fitted: " + typeset(svg::escaped(model.reason())));
      continue;
    }
    std::string title = score_label(task1, model) + ": " + count(model["n"]) + " answers of " +
                        count(model["participants"]) + " participants; SD of participants " +
                        fixed(model["sd_participant"], 2) + ", of participants by method " +
                        fixed(model["sd_method"], 2) + ", of the residual " + fixed(model["sd_residual"], 2);
    if (!model["singular"].words().empty()) title += "; at the bound: " + words(model["singular"]);
    table.group(title);
    for (const Field& t : model["terms"].entries())
      table.row({words(t["term"]), fixed(t["estimate"], 2) + " " + interval(t["ci"], 2), fixed(t["se"], 2),
                 fixed(t["t"], 2), fixed(t["df"], 1), p_bare(t["p"])});
  }
  return table.empty() ? "" : table.html();
}

bool anyone_missing(const Field& comparison) {
  const Field tipping = comparison["tipping"];
  return tipping["a"]["missing"].number() + tipping["b"]["missing"].number() > 0;
}

std::string worse_by(const Field& tipping, const char* which) {
  const Field side = tipping[which];
  if (side["missing"].number() == 0) return "\xE2\x80\x93";
  if (!tipping["reason"].words().empty())
    return count(side["missing"]) + ": unknown, " + words(tipping["reason"]);
  if (!side["worse_by"].is_number()) return count(side["missing"]) + ": any";
  return count(side["missing"]) + ": " + fixed(side["worse_by"], 2) +
         (side["within_scale"].yes() ? "" : " (beyond the scale)");
}

std::string tipping(const Field& task1) {
  Table table("Tipping points of the paired t tests",
              {"Pair", "Both, of those planned", "Significant", "First: missing, worse by",
               "Second: missing, worse by"});
  by_score(table, task1, anyone_missing, [&](const Field& c) {
    const Field t = c["tipping"];
    table.row({difference_name(c), count(c["n"]) + " of " + count(t["planned"]), yes_no(t["holds"]),
               worse_by(t, "a"), worse_by(t, "b")});
  });
  return table.empty() ? "" : table.html();
}

std::string decisions_tipping(const Field& hypotheses) {
  Table table("Tipping points of the tests of hypotheses",
              {"Test", "Planned", "Holds", "First: missing, worse by", "Second: missing, worse by"});
  for (const Field& hypothesis : hypotheses.entries()) {
    std::string group;
    for (const Field& test : hypothesis["tests"].entries()) {
      if (!anyone_missing(test)) continue;
      if (group.empty()) table.group(group = words(hypothesis["id"]));
      const Field t = test["tipping"];
      table.row({words(test["label"]), count(t["planned"]), yes_no(t["holds"]), worse_by(t, "a"),
                 worse_by(t, "b")});
    }
  }
  return table.empty() ? "" : table.html();
}

std::string tipping_points(const Field& root) {
  const std::string tables = tipping(root["task1"]) + decisions_tipping(root["hypotheses"]);
  if (tables.empty()) {
    const auto pairs = root["task1"]["comparisons"].entries();
    if (pairs.empty()) return "";
    for (const Field& c : pairs)
      if (!c["tipping"].exists())
        return paragraph("No tipping points: " + typeset(svg::escaped(c["tipping"].reason())) + ".");
    return paragraph("No participant lacks an answer to a method: there are no tipping points.");
  }
  return paragraph(
             "A tipping point is by how many points missing answers to one method must be worse than those "
             "of the others let expect before the decision changes; any: none is enough.") +
         tables;
}

}  // namespace

std::string missing_answers(const Field& root) {
  const Field task1 = root["task1"];
  const std::string fits = models(task1), pairs = comparisons(task1);
  if (fits.empty() && pairs.empty()) return "";
  return subsection("Missing answers: the mixed model and tipping points",
                    people_notes(task1) +
                        paragraph("The mixed model takes every answer, with scene, position and period as "
                                  "terms and random effects of the participant and of the participant with "
                                  "each method; degrees of freedom are Satterthwaite's.") +
                        pairs + fits + tipping_points(root));
}

}  // namespace study::report
