#include "apps/stats/report/page.hpp"

#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"
#include "stats/base/error.hpp"

namespace apps::report {

namespace {

struct Section {
  const char* id;
  const char* title;
  std::string (*render)(const Field&);
};

constexpr Section sections[] = {
    {"decisions", "Decisions", decisions_section},
    {"methods", "Methods", methods_section},
    {"participants", "Participants and exclusions", participants_section},
    {"timing", "Timing", timing_section},
    {"pilot", "Pilot", pilot_section},
    {"task1", "Task 1", task1_section},
    {"task2", "Task 2", task2_section},
    {"costs", "Cost and error", costs_section},
    {"sickness", "Sickness", sickness_section},
    {"hypotheses", "Hypotheses", hypotheses_section},
    {"sensitivity", "Sensitivity", sensitivity_section},
    {"preregistration", "Preregistered and exploratory parts", preregistration_section},
    {"provenance", "Provenance", provenance_section},
};

/// Writes "Table 3. " or "Figure 2. " behind each start tag, in the order of the page.
std::string numbered(std::string body, const std::string& tag, const std::string& name) {
  int n = 0;
  for (auto at = body.find(tag); at != std::string::npos; at = body.find(tag, at)) {
    at += tag.size();
    body.insert(at, "<span class=\"ordinal\">" + name + " " + std::to_string(++n) + ".</span> ");
  }
  return body;
}

}  // namespace

std::string results_page(const Json& results) {
  const Field root(results);
  if (root["schema"].words() != "vip-results/1")
    throw base::Error("results", "schema is \"" + root["schema"].words() + "\", not \"vip-results/1\"",
                      "compute the results anew with this version of vip-stats");
  std::string contents, body;
  for (const Section& part : sections) {
    const std::string rendered = part.render(root);
    if (rendered.empty()) continue;
    contents += "<li><a href=\"#" + std::string(part.id) + "\">" + part.title + "</a></li>\n";
    body += rendered;
  }
  body = numbered(numbered(std::move(body), "<caption>", "Table"), "<figcaption>", "Figure");
  return whole_page("Results of " + root["study"]["database"].words(),
                    "<main id=\"main\">\n" + head_section(root) + "<nav aria-label=\"Contents\">\n<ul>\n" +
                        contents + "</ul>\n</nav>\n" + body + "</main>\n");
}

}  // namespace apps::report
