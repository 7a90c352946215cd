#include <algorithm>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

std::string at_n_star(const Field& task1, const Field& entry) {
  return label_of(task1, entry) + ", " + n_star_sign + " = " + words(entry["n_star"]);
}

std::string choices_of(const Field& question) {
  std::string out;
  for (const Field& group : question["groups"].entries())
    out += (out.empty() ? "" : "; ") + words(group["answer"]) + ": " + count(group["n"]);
  const Field pooled = question["pooled"];
  if (pooled.json().is_null()) return out;
  std::string names;
  for (const Field& answer : pooled["answers"].entries())
    names += (names.empty() ? "" : " or ") + words(answer);
  const std::string taken =
      pooled.exists() ? names + ": " + count(pooled["n"]) : typeset(svg::escaped(pooled.reason()));
  return out + (out.empty() ? "" : "; ") + taken;
}

std::string numbers_of(const Field& question) {
  if (!question["mean"].is_number()) return typeset(svg::escaped(question.reason()));
  return "<i>M</i> = " + fixed(question["mean"], 1) + ", <i>SD</i> = " + fixed(question["sd"], 1) +
         (question["range"].exists() ? ", range within " + interval(question["range"], 0) : "");
}

}  // namespace

std::string label_of(const Field& task1, const Field& entry) {
  for (const Field& score : task1["scores"].entries())
    if (score["code"].words() == entry["score"].words()) return words(score["label"]);
  return words(entry["score"]);
}

std::string people_tables(const Field& root) {
  Table table("What the analysed participants answered on pages outside the trials",
              {"Question", "<i>n</i>", "No answer", "Answers"});
  const auto parts = root["people"].entries();
  for (const Field& part : parts) {
    for (const auto& [key, title] : all_parts)
      if (part["task"].words() == key) table.group(title);
    for (const Field& question : part["questions"].entries())
      table.row({words(question["text"]), count(question["n"]), count(question["missing"]),
                 question["groups"].json().is_array() ? choices_of(question) : numbers_of(question)});
  }
  if (table.empty()) return "";
  const Field& first = parts.front();
  return table.html() + "<p class=\"note\">No single person is shown: groups of fewer than " +
         count(first["smallest_group"]) +
         " people are taken together with the next smallest; a number that fewer than " +
         count(first["fewest_numbers"]) + " people gave has no summary; ranges go to whole fives.</p>\n";
}

std::string pilot_ratings(const Field& pilot) {
  const auto entries = pilot["distributions"].entries();
  if (entries.empty()) return "";
  std::vector<std::string> names;
  for (const Field& entry : entries)
    names.push_back(svg::number(entry["fps_mean"].number(), 0) + ", SD " +
                    svg::number(entry["fps_sd"].number(), 0));
  return figure(rating_bars(entries, names, "ratings-pilot", "Ratings of each setting"),
                "How often each score was given (of a line: the scores of each tenth), by setting (mean and "
                "standard deviation of the frame rate, "
                "frames/s).");
}

std::string score_ratings(const Field& task1, const Field& score) {
  std::string out;
  for (const Field& item : score["items"].entries()) {
    const std::string question = item.words();
    std::vector<Field> entries;
    std::vector<std::string> names;
    for (const Field& entry : task1["distributions"].entries()) {
      if (entry["question"].words() != question) continue;
      entries.push_back(entry);
      names.push_back(entry["n_star"].words() + ", " + entry["method"].words());
    }
    if (entries.empty()) continue;
    out += figure(rating_bars(entries, names, "ratings-" + question, "Answers about " + question),
                  "How often each score of " + words(item) +
                      " was given (of a line: the scores of each tenth), by " + n_star_sign +
                      " and method; single answers, not averaged.");
  }
  return out;
}

std::string response_times(const Field& root, const std::string& task) {
  std::string none;
  Table table(
      "Time from the page's showing to the last change of the answer, s",
      {"Question", "<i>n</i>", "Median", "Quartiles", "<i>M</i>", "<i>SD</i>", "Shortest", "Longest"});
  for (const Field& one : root["response_times"].entries()) {
    if (one["task"].words() != task) continue;
    if (!one["median"].is_number()) {
      none = one["reason"].words();
      continue;
    }
    table.row({words(one["question"]), count(one["n"]), fixed(one["median"], 2),
               fixed(one["q1"], 2) + ", " + fixed(one["q3"], 2), fixed(one["mean"], 2), fixed(one["sd"], 2),
               fixed(one["min"], 2), fixed(one["max"], 2)});
  }
  std::string body = table.empty() ? "" : table.html();
  if (!none.empty())
    body += "<p class=\"note\">Not given" + std::string(table.empty() ? "" : " for the other questions") +
            ": " + svg::escaped(none) + ".</p>\n";
  return body.empty() ? "" : subsection("Response times", body);
}

std::string reliability(const Field& task1) {
  Table table("Reliability of the scores of several items: Cronbach's \xCE\xB1",
              {"Score", "Items", "<i>n</i>", "\xCE\xB1 [CI]"});
  for (const Field& one : task1["reliability"].entries()) {
    const std::string name = at_n_star(task1, one);
    if (!one["alpha"].is_number()) {
      table.refused(name, "not given: " + typeset(svg::escaped(one["alpha"].reason())));
      continue;
    }
    table.row(
        {name, count(one["items"]), count(one["n"]), fixed(one["alpha"], 2) + " " + interval(one["ci"], 2)});
  }
  if (table.empty()) return "";
  return subsection(
      "Reliability",
      table.html() +
          "<p class=\"note\">Of each participant's mean answers to the items over all reports at "
          "this " +
          n_star_sign + "; intervals after Feldt.</p>\n");
}

std::string by_n_star(const Field& task1) {
  Table table("Whether the difference of two methods depends on " + n_star_sign +
                  ": the difference at the first less that at the second, paired within participants",
              {"Pair", "<i>n</i>", "Difference of differences [CI]", "<i>t</i>", "<i>df</i>", "<i>p</i>",
               "<i>p</i><sub>Holm</sub>"});
  std::string last;
  for (const Field& one : task1["by_n_star"].entries()) {
    const std::string key = one["score"].words() + one["n_star"].words() + one["other_n_star"].words();
    if (key != last)
      table.group(label_of(task1, one) + ", " + n_star_sign + " = " + words(one["n_star"]) + " less " +
                  words(one["other_n_star"]));
    last = key;
    const std::string pair = words(one["a"]) + " \xE2\x88\x92 " + words(one["b"]);
    if (!one["p"].is_number()) {
      table.refused(pair, "no test: " + typeset(svg::escaped(one["p"].reason())));
      continue;
    }
    table.row({pair, count(one["n"]), fixed(one["difference"], 2) + " " + interval(one["ci"], 2),
               fixed(one["t"], 2), fixed(one["df"], 0), p_bare(one["p"]), p_bare(one["p_holm"])});
  }
  if (table.empty()) return "";
  return subsection(
      "Methods by " + n_star_sign,
      table.html() +
          "<p class=\"note\">Holm over the pairs of methods of one score. Where a participant sees "
          "another scene at each " +
          n_star_sign + ", the scene is part of the difference.</p>\n");
}

std::string detectable_scores(const Field& task1) {
  Table table("The smallest difference that a paired <i>t</i> test of so many participants finds",
              {"Score", "<i>n</i>", "Power", "\xCE\xB1", "<i>d<sub>z</sub></i>",
               "<i>SD</i> of differences (median over pairs)", "Points"});
  for (const Field& one : task1["detectable"].entries())
    table.row({at_n_star(task1, one), count(one["n"]), percent(one["power"]), fixed(one["alpha"], 3),
               fixed(one["d_z"], 2), fixed(one["sd_difference"], 2), fixed(one["points"], 2)});
  return table.empty() ? "" : subsection("Smallest detectable difference", table.html());
}

std::string detectable_preference(const Field& task2) {
  const Field one = task2["detectable"];
  if (!one.exists()) return "";
  if (!one["share"].is_number())
    return subsection("Smallest detectable preference",
                      paragraph("Not given: " + typeset(svg::escaped(one["share"].reason())) + "."));
  return subsection("Smallest detectable preference",
                    paragraph("The exact binomial test of " + count(one["n"]) + " answers at \xCE\xB1 = " +
                              fixed(one["alpha"], 3) + " finds a true preference of " +
                              percent(one["share"], 1) + " with a power of " + percent(one["power"]) + "."));
}

}  // namespace study::report
