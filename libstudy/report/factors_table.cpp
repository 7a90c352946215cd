#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

/// The two levels of a comparison: "effects: foam over none". `between`: " over ", or a minus sign for a
/// difference.
std::string level_name(const Field& line, const char* between) {
  std::string out = words(line["factor"]) + ": " + words(line["a"]) + between + words(line["b"]);
  if (line["test"].words() == "exact sign test")
    out += " <em>(all participants alike: " + words(line["test"]) + ")</em>";
  return out;
}

std::string refusal(const Field& line) { return "no test: " + typeset(svg::escaped(line["p"].reason())); }

}  // namespace

std::string treatment_note(const Field& task) {
  if (task["factors"].entries().empty()) return "";
  return paragraph("Effects are a factor: what is called a method here is one with a level of effects.");
}

std::string preference_factors(const Field& task2) {
  Table table(
      "What each level is worth over another, all else alike: participants' shares against one half; Holm "
      "over the "
      "pairs of levels of one factor, not over the table",
      {"Factor: pair of levels", "Participants", "Chosen", "Share", "Mean share [CI]", "<i>t</i>",
       "<i>df</i>", "<i>p</i>", "<i>p</i><sub>Holm</sub>"});
  for (const Field& line : task2["factors"].entries()) {
    if (!line["p"].is_number()) {
      table.refused(level_name(line, " over "), refusal(line));
      continue;
    }
    table.row({level_name(line, " over "), count(line["participants"]),
               count(line["k"]) + " of " + count(line["n"]), percent(line["share"]),
               fixed(line["mean"], 2) + " " + interval(line["ci"], 2), fixed(line["t"], 2),
               fixed(line["df"], 0), p_bare(line["p"]), p_bare(line["p_holm"])});
  }
  return table.empty() ? "" : subsection("Factors", table.html());
}

std::string score_factors(const Field& task1) {
  Table table(
      "What each level is worth over another, all else alike: participants' differences against nought; Holm "
      "over the pairs of levels of one factor, score and " +
          n_star_sign + ", not over the table",
      {"Factor: pair of levels", "Score", n_star_sign, "Participants", "Difference [CI]", "<i>t</i>",
       "<i>df</i>", "<i>p</i>", "<i>p</i><sub>Holm</sub>"});
  for (const Field& line : task1["factors"].entries()) {
    const std::string name = level_name(line, " \xE2\x88\x92 ");
    if (!line["p"].is_number()) {
      table.refused(name, words(line["score"]) + ", " + words(line["n_star"]) + ", " + refusal(line));
      continue;
    }
    table.row({name, words(line["score"]), words(line["n_star"]), count(line["participants"]),
               fixed(line["mean"], 2) + " " + interval(line["ci"], 2), fixed(line["t"], 2),
               fixed(line["df"], 0), p_bare(line["p"]), p_bare(line["p_holm"])});
  }
  return table.empty() ? "" : subsection("Factors", table.html());
}

}  // namespace study::report
