#include <algorithm>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

std::string preferred_pair(const Field& pair) { return words(pair["a"]) + " over " + words(pair["b"]); }

/// True if some pair has a Wilson interval, which accompanies the binomial test.
bool has_wilson(const Field& pairs) {
  const auto all = pairs.entries();
  return std::any_of(all.begin(), all.end(), [](const Field& pair) {
    return !pair["by_person"].exists() && pair["wilson"].exists();
  });
}

/// Names of the kinds of intervals that the figure's bars show.
std::string interval_names(const Field& pairs) {
  std::vector<std::string> names, seen;
  for (const Field& pair : pairs.entries()) {
    const Field people = pair["by_person"];
    const std::string name = people["ci_name"].words();
    if (name.empty() || std::find(seen.begin(), seen.end(), name) != seen.end()) continue;
    seen.push_back(name);
    names.push_back(words(people["ci_name"]));
  }
  if (has_wilson(pairs)) names.insert(names.begin(), "Wilson");
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : "; ") + name;
  return out;
}

/// Names of the tests to which the figure's stars refer, each once.
std::string test_names(const Field& pairs) {
  std::string out, binomial, shares;
  for (const Field& pair : pairs.entries()) {
    if (!pair["test"].exists()) continue;
    (pair["by_person"].exists() ? shares : binomial) = words(pair["test"]);
  }
  return binomial + (binomial.empty() || shares.empty() ? "" : " or ") + shares;
}

std::string bars_caption(const Field& pairs) {
  const std::string intervals = interval_names(pairs);
  const std::string out = "Share of answers that chose each of a pair, as the paper's Fig.&nbsp;10" +
                          (intervals.empty() ? "." : "; line: interval of the share (" + intervals + ").");
  const std::string tests = test_names(pairs);
  return tests.empty() ? out : out + " Stars: " + tests + ", uncorrected / after Holm over all pairs.";
}

std::string several_answers(const Field& several) {
  if (!(several["participants"].number() > 0)) return "";
  return paragraph(count(several["participants"]) + " of " + count(several["of"]) +
                   " participants answered a pair more than once, at most " + count(several["most"]) +
                   " times.");
}

std::string pairs_table(const Field& pairs) {
  const bool wilson = has_wilson(pairs);
  std::vector<std::string> columns{"Pair",
                                   "Chosen",
                                   "Share",
                                   "CI",
                                   "CI (Wilson)",
                                   "Test",
                                   "<i>p</i>",
                                   "",
                                   "<i>p</i><sub>Holm</sub>",
                                   "",
                                   "<i>p</i><sub>BH</sub>",
                                   "Left one shown first",
                                   "First one chosen",
                                   "In the paper's Fig.&nbsp;10"};
  constexpr std::ptrdiff_t at_wilson = 4;
  if (!wilson) columns.erase(columns.begin() + at_wilson);
  Table table("How often each of a pair was chosen, with a two-sided test of each pair", columns);
  for (const Field& pair : pairs.entries()) {
    const std::string warning = pair["warning"].words();
    const std::string name =
        preferred_pair(pair) +
        (warning.empty() || !pair["p"].is_number() ? "" : " <em>(" + words(pair["warning"]) + ")</em>");
    if (!pair["p"].is_number() && !pair["share"].is_number()) {
      table.refused(name, "no test: " + typeset(svg::escaped(pair["p"].reason())));
      continue;
    }
    const Field people = pair["by_person"];
    std::vector<std::string> cells{name,
                                   count(pair["k"]) + " of " + count(pair["n"]),
                                   percent(tested_share(pair)),
                                   people.exists()
                                       ? interval(people["ci"], 2) + " (" + words(people["ci_name"]) + ")"
                                       : interval(pair["clopper_pearson"], 2) + " (Clopper-Pearson)",
                                   people.exists() ? "" : interval(pair["wilson"], 2),
                                   words(pair["test"]),
                                   p_bare(pair["p"]),
                                   words(pair["stars"]),
                                   p_bare(pair["p_holm"]),
                                   words(pair["stars_holm"]),
                                   p_bare(pair["p_bh"]),
                                   count(pair["a_first"]),
                                   count(pair["first_chosen"]),
                                   yes_no(pair["paper"])};
    if (!wilson) cells.erase(cells.begin() + at_wilson);
    table.row(cells);
  }
  return table.html();
}

std::string preference_apa_lines(const Field& pairs) {
  std::vector<std::string> lines;
  for (const Field& pair : pairs.entries()) {
    if (!pair["p"].is_number()) continue;
    const Field people = pair["by_person"];
    const Field ci = people.exists() ? people["ci"] : pair["clopper_pearson"];
    lines.push_back(preferred_pair(pair) + ": " + count(pair["k"]) + " of " + count(pair["n"]) +
                    (people.exists() ? " answers of " + count(people["participants"]) +
                                           " people, mean share " + percent(people["share"]) + ", CI "
                                     : " (" + percent(pair["share"]) + "), CI ") +
                    interval(ci, 2) + (pair["test"].exists() ? ", " + words(pair["test"]) : "") +
                    ", <i>p</i> " + p(pair["p"]) + ", <i>p</i><sub>Holm</sub> " + p(pair["p_holm"]));
  }
  return list(lines);
}

std::string interval_bias(const Field& bias) {
  if (bias.json().is_null()) return "";
  if (!bias.exists()) return subsection("Bias towards the first interval", why_not(bias));
  std::string body =
      paragraph("The first of a pair was chosen in " + count(bias["first_chosen"]) + " of " +
                count(bias["n"]) + " answers (" + percent(bias["share"]) + ", CI " +
                interval(bias["clopper_pearson"], 2) + ", exact binomial <i>p</i> " + p(bias["p"]) + ").");
  if (!bias["warning"].words().empty()) body += paragraph("Note: " + words(bias["warning"]) + ".");
  const Field by = bias["by_participant"];
  if (by["test"].words() == "exact sign test") {
    body += paragraph("Over participants: every share is " + fixed(by["mean_share"], 2) + ", " +
                      words(by["test"]) + ", <i>p</i> " + p(by["p"]) + ".");
  } else if (by.exists()) {
    body += paragraph("Over participants: mean share " + fixed(by["mean_share"], 2) + " " +
                      interval(by["ci"], 2) + ", <i>t</i>(" + fixed(by["df"], 0) +
                      ") = " + fixed(by["t"], 2) + ", <i>p</i> " + p(by["p"]) + ".");
  } else {
    body += why_not(by);
  }
  return subsection("Bias towards the first interval", body);
}

std::string bradley_terry(const Field& model) {
  if (model.json().is_null()) return "";
  if (!model.exists()) return subsection("Bradley-Terry model", why_not(model));
  Table table("Abilities on the log-odds scale, with mean zero",
              {"Method", "Estimate", "<i>SE</i>", "CI", "Worth (sums to one)"});
  for (const Field& ability : model["abilities"].entries())
    table.row({words(ability["method"]), fixed(ability["estimate"], 2), fixed(ability["se"], 2),
               interval(ability["ci"], 2), fixed(ability["worth"], 3)});
  std::string body = table.html();
  if (model["penalised"].yes())
    body += paragraph(
        "A method or a group of methods was always or never chosen over all others: the estimates are "
        "Firth's, penalised.");
  const Field people = model["people"];
  body += paragraph(
      people["errors"].words() == "people"
          ? "Errors and intervals allow for the likeness of one person's answers (sandwich over people, "
            "<i>t</i> with " +
                fixed(people["people_df"], 0) + " degrees of freedom)."
          : "Errors and intervals take all answers as independent: " + words(people["why_independent"]) +
                ".");
  const auto test = [](const std::string& name, const Field& part) {
    if (!part.exists())
      return part.reason().empty() ? "" : name + ": " + typeset(svg::escaped(part.reason()));
    return name + ": \xCF\x87\xC2\xB2(" + count(part["df"]) + ") = " + fixed(part["chi2"], 2) +
           ", <i>p</i> " + p(part["p"]);
  };
  std::vector<std::string> lines;
  for (const auto& line : {test("All methods equal, if answers were independent", model["overall"]),
                           test("Lack of fit over the pairs, if answers were independent", model["fit"])})
    if (!line.empty()) lines.push_back(line);
  const Field equal = people["equal"];
  if (equal.exists())
    lines.push_back("All methods equal, over people: <i>F</i>(" + fixed(equal["df1"], 0) + ", " +
                    fixed(equal["df2"], 0) + ") = " + fixed(equal["f"], 2) + ", <i>p</i> " + p(equal["p"]));
  const Field order = model["order"];
  if (order.exists())
    lines.push_back("Effect of the order (log odds of the first interval): " + fixed(order["estimate"], 2) +
                    " " + interval(order["ci"], 2) + ", <i>SE</i> = " + fixed(order["se"], 2) +
                    ", <i>p</i> " + p(order["p"]));
  return subsection("Bradley-Terry model", body + list(lines));
}

std::string triads(const Field& t) {
  if (t.json().is_null()) return "";
  if (!t.exists()) return subsection("Circular triads", why_not(t));
  return subsection("Circular triads",
                    paragraph("Participants who judged every pair once: " + count(t["n"]) +
                              " (others: " + count(t["incomplete"]) + "). Mean number of circular triads " +
                              fixed(t["mean"], 2) + " (random answers: " + fixed(t["expected"], 2) +
                              "), mean consistency (Kendall's \xCE\xB6) " + fixed(t["mean_consistency"], 2) +
                              "; as few or fewer by chance: <i>p</i> " + p(t["p"]) + "."));
}

std::string preferences_by_scene(const Field& task2) {
  Table table("Choices by scene (not tested)", {"Scene", "Pair", "Chosen"});
  for (const Field& c : task2["by_scene"].entries())
    table.row({words(c["scene"]), preferred_pair(c), count(c["k"]) + " of " + count(c["n"])});
  return table.empty() ? "" : subsection("By scene", table.html());
}

std::string preference_retest(const Field& r) {
  if (!r.exists()) return "";
  return subsection("Test and retest", paragraph("Of " + count(r["pairs"]) + " pairs shown again, " +
                                                 percent(r["same"]) + " were answered alike."));
}

}  // namespace

std::string task2_section(const Field& root) {
  const Field task2 = root["task2"];
  if (task2.json().is_null()) return "";
  if (!task2.exists()) return section("task2", "Task 2: preference", why_not(task2));
  const Field pairs = task2["pairs"];
  std::vector<std::string> rules;
  for (const auto& [name, rule] : task2["rules"].members()) rules.push_back(words(rule));
  return section(
      "task2", "Task 2: preference",
      paragraph(badge(false) + " " + count(task2["participants"]) + " participants, " +
                count(task2["answers"]) + " answers. The tests of all pairs describe the data" +
                (root["hypotheses"].entries().empty() ? "." : "; the decisions stand under Hypotheses.")) +
          treatment_note(task2) + several_answers(task2["several_answers"]) + list(rules) +
          figure(preference_bars(pairs), bars_caption(pairs)) + pairs_table(pairs) +
          preference_apa_lines(pairs) + preference_factors(task2) + interval_bias(task2["interval_bias"]) +
          bradley_terry(task2["bradley_terry"]) + triads(task2["triads"]) + preferences_by_scene(task2) +
          detectable_preference(task2) + response_times(root, "task2") + preference_retest(task2["retest"]));
}

}  // namespace study::report
