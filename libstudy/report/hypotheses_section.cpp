#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

const std::string minus = "\xE2\x88\x92";

/// "90 % CI [0.06, 1.25]". The confidence level is printed because it differs between intervals of the page.
std::string interval_of(const Field& test) {
  return (test["ci"].entries().empty() ? "" : percent(test["ci_confidence"]) + " ") + "CI " +
         interval(test["ci"], 2);
}

bool is_sign_test(const Field& test) { return test["method"].words() == "exact sign test"; }

/// True if the test uses the mixed model. Its degrees of freedom (Satterthwaite) are no whole numbers.
bool by_model(const Field& test) { return test["method"].words() == "t test of the mixed model"; }

/// The estimated difference or share with its interval: "0.46, 90 % CI [0.06, 1.25]".
std::string estimate(const Field& test) {
  if (!test["estimate"].is_number()) return fixed(test["estimate"], 2);
  if (is_sign_test(test))
    return fixed(test["estimate"], 2) + ", " + words(test["method"]) + " (all are equal)";
  return fixed(test["estimate"], 2) + ", " + interval_of(test);
}

/// The test's label, followed by the reason if there is no test.
std::string label(const Field& test) {
  const std::string reason = test["reason"].words();
  return words(test["label"]) + (reason.empty() ? "" : " <em>(no test: " + words(test["reason"]) + ")</em>");
}

Table tests_table(const Field& hypothesis, const Field& tests, const std::string& title) {
  const bool preference = hypothesis["kind"].words() == "preference";
  Table table(words(hypothesis["id"]) + ": " + title,
              {"Test", "<i>n</i>", preference ? "Share" : "Difference", "Margin", "<i>p</i>", "",
               "<i>p</i><sub>Holm</sub>", "", "Holds", "Holds after Holm", "<i>p</i> as in the paper",
               "Holds as in the paper"});
  for (const Field& test : tests.entries()) {
    table.row({label(test), count(test["n"]), estimate(test), fixed(test["margin"], 2), p_bare(test["p"]),
               words(test["stars"]), p_bare(test["p_holm"]), words(test["stars_holm"]), yes_no(test["holds"]),
               yes_no(test["holds_holm"]), p_bare(test["paper_p"]), yes_no(test["paper_holds"])});
  }
  return table;
}

/// One test as a sentence in APA style.
std::string apa(const Field& test, bool preference) {
  std::string out = words(test["label"]) + ": ";
  if (!test["p"].is_number()) {
    const std::string reason = test["reason"].words();
    return out + "no test" + (reason.empty() ? "" : ", " + words(test["reason"]));
  }
  if (preference) {
    if (test["k"].is_number()) out += count(test["k"]) + " of " + count(test["n"]) + ", ";
    out += "share = " + fixed(test["estimate"], 2) + ", " + words(test["method"]);
  } else {
    out += "<i>M</i><sub>diff</sub> = " + fixed(test["estimate"], 2);
  }
  out += ", " + (is_sign_test(test) ? words(test["method"]) : interval_of(test));
  if (test["margin"].is_number()) out += ", margin " + fixed(test["margin"], 2);
  if (test["t"].is_number())
    out += ", <i>t</i>(" + fixed(test["df"], by_model(test) ? 1 : 0) + ") = " + fixed(test["t"], 2);
  if (test["d_z"].is_number()) out += ", <i>d<sub>z</sub></i> = " + fixed(test["d_z"], 2);
  return out + ", <i>p</i> " + p(test["p"]) + ", <i>p</i><sub>Holm</sub> " + p(test["p_holm"]);
}

/// A table of p values of preferences after Holm's correction over the hypothesis, over the pairs
/// of all hypotheses and over all pairs, since the result depends on the family.
std::string families(const Field& hypothesis) {
  Table table("The same <i>p</i> in larger families",
              {"Test", "<i>p</i>", "Holm over this family", "Holm over the pairs of all hypotheses",
               "Holm over all pairs"});
  for (const Field& test : hypothesis["tests"].entries()) {
    if (!test["p_holm_of_five"].is_number() && !test["p_holm_of_ten"].is_number()) continue;
    table.row({words(test["label"]), p_bare(test["p"]), p_bare(test["p_holm"]),
               p_bare(test["p_holm_of_five"]), p_bare(test["p_holm_of_ten"])});
  }
  return table.empty() ? "" : table.html();
}

/// The paired tests of a hypothesis that is decided by the mixed model; "" for other hypotheses.
std::string paired(const Field& hypothesis) {
  const Field beside = hypothesis["paired"];
  if (!beside.exists()) return "";
  return paragraph("By paired <i>t</i> tests, which the plan does not decide by: " + words(beside["status"]) +
                   ".") +
         tests_table(hypothesis, beside["tests"], "paired tests beside").html();
}

/// A note if a test of participants' shares replaced the binomial test that the rule names. The test of
/// shares is used for pairs that a person answered more than once.
std::string other_test(const Field& hypothesis) {
  for (const Field& test : hypothesis["tests"].entries())
    if (hypothesis["kind"].words() == "preference" && test["p"].is_number() &&
        test["method"].words() != "exact binomial test")
      return paragraph("Where a person answered a pair more than once, the test is the " +
                       words(test["method"]) + ", in place of the binomial test.");
  return "";
}

std::string one(const Field& hypothesis, bool registered) {
  const Field paper = hypothesis["paper"];
  const bool preference = hypothesis["kind"].words() == "preference";
  std::string body = paragraph("<q>" + words(hypothesis["title"]) + "</q>");
  body += paragraph(badge(registered) + " Decision: <strong>" + words(hypothesis["status"]) + "</strong>. " +
                    words(hypothesis["status_text"]));
  if (hypothesis["status_if_testable"].exists() && hypothesis["status"].words() == "not testable")
    body += paragraph(
        "Were it testable, the tests below would read: " + words(hypothesis["status_if_testable"]) + ".");
  body += paragraph("Rule: " + words(hypothesis["rule"]) + " (tests in the family: " +
                    count(hypothesis["family"]) + ", \xCE\xB1 = " + fixed(hypothesis["alpha"], 3) + ").");
  body += other_test(hypothesis);
  if (hypothesis["p_claim"].is_number())
    body += paragraph("The claim as a whole: <i>p</i> " + p(hypothesis["p_claim"]) +
                      (hypothesis["p_claim_of_six"].is_number()
                           ? ", after Holm over all claims <i>p</i> " + p(hypothesis["p_claim_of_six"])
                           : "") +
                      ".");
  body += tests_table(hypothesis, hypothesis["tests"], "tests of the family").html() + families(hypothesis);
  std::vector<std::string> lines;
  for (const Field& test : hypothesis["tests"].entries()) lines.push_back(apa(test, preference));
  body += list(lines) + paired(hypothesis);
  if (paper.exists())
    body += paragraph("The paper's own procedure on these data (" + words(paper["rule"]) +
                      "): " + words(paper["status"]) + ". " + words(paper["text"]) +
                      " Of its own data the paper said: " + words(paper["published"]) + ".");
  return subsection(words(hypothesis["id"]) + ", " + words(hypothesis["kind"]), body);
}

std::string decision_words(const Field& plan) {
  if (plan["decision"].words() == "holm")
    return "Each hypothesis is a family of its own; Holm's step-down correction holds the family's error "
           "rate. ";
  return "Each hypothesis claims all of its tests: it is supported where every one is significant at "
         "\xCE\xB1 "
         "without correction (an intersection-union test), which errs at most at \xCE\xB1. Where not all "
         "are, those that hold after Holm's step-down correction within the hypothesis may be claimed one by "
         "one. ";
}

}  // namespace

std::string decisions_section(const Field& root) {
  if (root["hypotheses"].entries().empty()) return "";
  Table table(
      "Decisions on the hypotheses",
      {"Hypothesis", "Kind", "Plan", "Decision", "Tests that hold", "In words", "<i>p</i> of the claim",
       "After Holm over all claims", "The paper's uncorrected procedure", "Published"});
  for (const Field& hypothesis : root["hypotheses"].entries()) {
    table.row({words(hypothesis["id"]), words(hypothesis["kind"]),
               badge(preregistered(root, hypothesis["task"].words())),
               "<strong>" + words(hypothesis["status"]) + "</strong>",
               count(hypothesis["confirmed"]) + " of " + count(hypothesis["family"]),
               words(hypothesis["status_text"]), p_bare(hypothesis["p_claim"]),
               p_bare(hypothesis["p_claim_of_six"]), words(hypothesis["paper"]["status"]),
               words(hypothesis["paper"]["published"])});
  }
  return section("decisions", "Decisions", table.html());
}

std::string hypotheses_section(const Field& root) {
  std::string body;
  for (const Field& hypothesis : root["hypotheses"].entries())
    body += one(hypothesis, preregistered(root, hypothesis["task"].words()));
  if (body.empty()) return "";
  return section("hypotheses", "Hypotheses",
                 paragraph(decision_words(root["plan"]) +
                           "The claims are not corrected for one another; what Holm makes of them "
                           "stands beside. Stars: * <i>p</i> &lt; .05, ** <i>p</i> &lt; .01, *** "
                           "<i>p</i> &lt; .001.") +
                     body);
}

std::string sensitivity_section(const Field& root) {
  if (root["sensitivity"].entries().empty()) return "";
  Table overview("The decisions under other rules",
                 {"Rules", "Task", "Participants", "Answers", "Decisions", "Changed"});
  Table details("Every test under other rules", {"Test", "<i>n</i>", "Estimate", "<i>p</i>",
                                                 "<i>p</i><sub>Holm</sub>", "Holds", "Holds after Holm"});
  for (const Field& variant : root["sensitivity"].entries()) {
    std::string decisions, changed;
    for (const Field& hypothesis : variant["hypotheses"].entries()) {
      decisions +=
          (decisions.empty() ? "" : "; ") + words(hypothesis["id"]) + ": " + words(hypothesis["status"]);
      details.group(words(variant["label"]) + ", " + words(hypothesis["id"]));
      for (const Field& test : hypothesis["tests"].entries())
        details.row({words(test["label"]), count(test["n"]), fixed(test["estimate"], 2), p_bare(test["p"]),
                     p_bare(test["p_holm"]), yes_no(test["holds"]), yes_no(test["holds_holm"])});
    }
    for (const Field& id : variant["changed"].entries()) changed += (changed.empty() ? "" : ", ") + words(id);
    if (variant["hypotheses"].entries().empty() && !variant.reason().empty())
      decisions = typeset(svg::escaped(variant.reason()));
    overview.row({words(variant["label"]), words(variant["task"]), count(variant["participants"]),
                  count(variant["answers"]), decisions,
                  !variant["changed"].exists() ? ""
                  : changed.empty()            ? "none"
                                               : changed});
  }
  return section(
      "sensitivity", "Sensitivity",
      paragraph(badge(false) +
                " The hypotheses again under other rules of exclusion and averaging. None of these "
                "replaces a decision above.") +
          overview.html() + details.html());
}

}  // namespace study::report
