#include "apps/stats/report/page.hpp"

#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"
#include "stats/base/error.hpp"

namespace apps::report {

namespace {

struct Part {
  const char* id;
  const char* title;
  std::string (*render)(const Field&);
};

constexpr Part parts[] = {
    {"decisions", "Decisions", decisions_section},
    {"methods", "Methods", methods_section},
    {"participants", "Participants and exclusions", participants_section},
    {"timing", "Timing", timing_section},
    {"pilot", "Pilot", pilot_section},
    {"task1", "Task 1", task1_section},
    {"task2", "Task 2", task2_section},
    {"sickness", "Sickness", sickness_section},
    {"hypotheses", "Hypotheses", hypotheses_section},
    {"sensitivity", "Sensitivity", sensitivity_section},
    {"preregistration", "Preregistered and exploratory parts", preregistration_section},
    {"provenance", "Provenance", provenance_section},
};

}  // namespace

std::string results_page(const Json& results) {
  const Field root(results);
  if (root["schema"].words() != "vip-results/1")
    throw base::Error("results", "schema is \"" + root["schema"].words() + "\", not \"vip-results/1\"",
                      "compute the results anew with this version of vip-stats");
  std::string contents, body;
  for (const Part& part : parts) {
    const std::string rendered = part.render(root);
    if (rendered.empty()) continue;
    contents += "<li><a href=\"#" + std::string(part.id) + "\">" + part.title + "</a></li>\n";
    body += rendered;
  }
  return whole_page("Results of " + root["study"]["database"].words(),
                    "<main id=\"main\">\n" + head_section(root) + "<nav aria-label=\"Contents\">\n<ul>\n" +
                        contents + "</ul>\n</nav>\n" + body + "</main>\n");
}

}  // namespace apps::report
