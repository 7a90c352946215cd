#include <algorithm>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

std::string quartiles(const Field& summary) {
  if (!summary["q1"].is_number()) return fixed(summary["q1"], 1);
  return fixed(summary["q1"], 1) + " to " + fixed(summary["q3"], 1);
}

std::vector<std::string> described(const Field& summary) {
  return {count(summary["n"]), fixed(summary["median"], 1), quartiles(summary), fixed(summary["mean"], 2),
          fixed(summary["max"], 1)};
}

const std::vector<std::string> described_columns{"<i>n</i>", "Median", "Quartiles", "<i>M</i>", "Largest"};

std::vector<std::string> with_columns(std::vector<std::string> head, const std::vector<std::string>& more) {
  head.insert(head.end(), more.begin(), more.end());
  return head;
}

std::vector<std::string> changed(const Field& change) {
  const Field ranks = change["wilcoxon"];
  return {count(change["n"]),
          fixed(change["mean"], 2),
          interval(change["bca"], 2),
          fixed(ranks["location"], 2),
          fixed(ranks["w"], 1),
          p_bare(ranks["p"]),
          fixed(ranks["rank_biserial"], 2)};
}

const std::vector<std::string> changed_columns{"<i>n</i>",        "<i>M</i> of changes", "BCa interval",
                                               "Hodges-Lehmann",  "Wilcoxon's <i>W</i>", "<i>p</i>",
                                               "Rank correlation"};

std::string ssq(const Field& ssq) {
  if (!ssq.exists()) return "";
  Table levels("SSQ scores before and after", with_columns({"Score"}, described_columns));
  Table changes("Changes of the SSQ scores, after less before", with_columns({"Score"}, changed_columns));
  const auto never = [&](const char* when) { return ssq[when].is_number() && ssq[when].number() == 0; };
  const bool both = !never("pages_before") && !never("pages_after");
  for (const auto& [key, name] : {std::pair{"before", "Before"}, {"after", "After"}}) {
    if (never(key == std::string("before") ? "pages_before" : "pages_after")) continue;
    levels.group(name);
    for (const Field& score : ssq["scores"].entries())
      levels.row(with_columns({words(score["label"])}, described(score[key])));
  }
  for (const Field& score : ssq["scores"].entries())
    changes.row(with_columns({words(score["label"])}, changed(score["change"])));
  std::string note =
      "Simulator Sickness Questionnaire with the weights of Kennedy et al. (1993): before is the last page "
      "ahead of the first trial, after the last page behind it. ";
  if (ssq["incomplete"].number() > 0)
    note += "A missing item empties its scale and the total: " + count(ssq["incomplete"]) + " of " +
            count(ssq["pages"]) + " pages lack some. ";
  if (both) {
    note += "Changes are of the participants with both; signed-rank tests are two-sided and not corrected.";
  } else {
    note += std::string("No session answered the questionnaire ") +
            (never("pages_after") ? "after the first trial" : "before the first trial") +
            ", so there are no changes.";
  }
  return levels.html() + (both ? changes.html() : "") + "<p class=\"note\">" + note + "</p>\n";
}

std::string fms(const Field& fms, const std::string& id) {
  if (!fms.exists()) return "";
  Table courses("FMS: mean and peak of each participant", with_columns({"Part"}, described_columns));
  const auto part = [&](const std::string& title, const Field& course) {
    courses.group(title);
    courses.row(with_columns({"Mean"}, described(course["mean"])));
    courses.row(with_columns({"Peak"}, described(course["peak"])));
  };
  part("Whole session", fms);
  for (const Field& block : fms["blocks"].entries()) part("Block " + words(block["block"]), block);
  // Answers of observer models have no times; without times the table has no column of minutes.
  const auto asked = fms["times"].entries();
  const bool timed =
      std::any_of(asked.begin(), asked.end(), [](const Field& time) { return time["minutes"].is_number(); });
  std::vector<std::string> head{"Asked"};
  if (timed) head.emplace_back("Minutes (median)");
  Table times("FMS over the session", with_columns(head, described_columns));
  for (const Field& time : asked) {
    std::vector<std::string> cells{count(time["asked"])};
    if (timed) cells.push_back(fixed(time["minutes"], 1));
    times.row(with_columns(cells, described(time)));
  }
  Table change("Change of the FMS from the first answer to the last",
               with_columns({"Score"}, changed_columns));
  change.row(with_columns({"FMS"}, changed(fms["change"])));
  return figure(fms_chart(fms, id),
                "Fast Motion Sickness scale at each asking. Band: quartiles; line: median; X: mean; circle: "
                "largest. Sessions that ended early are missing from later askings.") +
         courses.html() + times.html() + change.html();
}

}  // namespace

std::string sickness_section(const Field& root) {
  std::string body;
  int part = 0;
  for (const Field& one : root["sickness"].entries()) {
    std::string who = badge(false) + " " + count(one["participants"]) + " participants";
    if (one["test_data"].yes()) who += ", test data";
    if (one["simulated"].number() > 0) who += ", all answered by a model";
    who += ". Sessions that ended early and those left out elsewhere count here.";
    body += subsection(words(one["protocol"]["name"]),
                       paragraph(who) + ssq(one["ssq"]) + fms(one["fms"], "fms-" + std::to_string(part++)));
  }
  return body.empty() ? "" : section("sickness", "Sickness before, during and after", body);
}

}  // namespace study::report
