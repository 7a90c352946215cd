#include "libstudy/report/page.hpp"

#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/error.hpp"

namespace study::report {

namespace {

struct Section {
  const char* id;
  const char* title;
  std::string (*render)(const Field&);
};

constexpr Section sections[] = {
    {"decisions", "Decisions", decisions_section},
    {"not-analysed", "Not analysed", not_analysed_section},
    {"methods", "Methods", methods_section},
    {"participants", "Participants and exclusions", participants_section},
    {"pilot", "Pilot", pilot_section},
    {"task1", "Task 1", task1_section},
    {"task2", "Task 2", task2_section},
    {"sickness", "Sickness", sickness_section},
    {"hypotheses", "Hypotheses", hypotheses_section},
    {"sensitivity", "Sensitivity", sensitivity_section},
    {"descriptives", "Answers by cell", descriptives_section},
    {"timing", "Timing", timing_section},
    {"costs", "Cost and error", costs_section},
    {"preregistration", "Preregistered and exploratory parts", preregistration_section},
    {"provenance", "Provenance", provenance_section},
};

/// Numbers the tables or figures: inserts `name` and a running number, such as "Table 3. ", after each `tag`
/// in `body`.
std::string numbered(std::string body, const std::string& tag, const std::string& name) {
  int n = 0;
  for (auto at = body.find(tag); at != std::string::npos; at = body.find(tag, at)) {
    at += tag.size();
    body.insert(at, "<span class=\"ordinal\">" + name + " " + std::to_string(++n) + ".</span> ");
  }
  return body;
}

/// Puts `prefix` before each id in `html` and each reference to an id. Documents with equal ids can then be
/// on one page. Texts of the page contain no quotes (svg::escaped), so they are not changed.
std::string with_prefix(std::string html, const std::string& prefix) {
  for (const std::string mark : {" id=\"", "href=\"#", "url(#", "aria-labelledby=\""}) {
    for (auto at = html.find(mark); at != std::string::npos; at = html.find(mark, at)) {
      at += mark.size();
      html.insert(at, prefix);
      if (mark.front() != 'a') continue;
      for (auto end = html.find('"', at), space = html.find(' ', at); space < end;
           end = html.find('"', at), space = html.find(' ', space + 1))
        html.insert(space + 1, prefix);
    }
  }
  return html;
}

struct Rendered {
  std::string contents, body;
};

/// Renders those sections for which the results have content. `prefix` (of ids) and `name` (in headings)
/// distinguish a document of the list "apart" (further analyses) from the main document, for which both are
/// empty.
Rendered rendered(const Field& results, const std::string& prefix, const std::string& name) {
  Rendered out;
  for (const Section& part : sections) {
    std::string html = part.render(results);
    if (html.empty()) continue;
    html = with_prefix(std::move(html), prefix);
    if (!name.empty()) html.insert(html.find("</h2>"), ": " + name);
    out.contents += "<li><a href=\"#" + prefix + part.id + "\">" + part.title +
                    (name.empty() ? "" : ": " + name) + "</a></li>\n";
    out.body += html;
  }
  return out;
}

/// Name of a document of the list "apart", which holds further analyses: "apart 1, Task 1, task1 1.1" or
/// "apart 1, Pilot, ptpe_pilot_lab 1.0, question smoothness".
std::string document_name(const Field& results) {
  const Field protocol = results["study"]["protocols"][0];
  std::string out = words(results["section"]) + ", " + words(protocol["title"]) + ", " +
                    words(protocol["name"]) + " " + words(protocol["version"]);
  if (results["pilot"]["question"].exists()) out += ", question " + words(results["pilot"]["question"]);
  return out;
}

}  // namespace

std::string results_page(const Json& results) {
  const Field root(results);
  if (root["schema"].words() != "vip-results/1")
    throw base::Error("results", "schema is \"" + root["schema"].words() + "\", not \"vip-results/1\"",
                      "compute the results anew with this version of vip-stats");
  std::string contents, body;
  std::size_t apart = 0;
  for (const Field& document : documents(root)) {
    const bool first = document.pointer().empty();
    const auto part =
        first ? rendered(document, "", "")
              : rendered(document, "apart-" + std::to_string(++apart) + "-", document_name(document));
    contents += part.contents;
    body += part.body;
  }
  body = numbered(numbered(std::move(body), "<caption>", "Table"), "<figcaption>", "Figure");
  return whole_page("Results of " + root["study"]["database"].words(),
                    "<main id=\"main\">\n" + head_section(root) + "<nav aria-label=\"Contents\">\n<ul>\n" +
                        contents + "</ul>\n</nav>\n" + body + "</main>\n");
}

}  // namespace study::report
