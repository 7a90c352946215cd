#include <algorithm>

#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

std::string bundle_text(const Field& bundle) {
  std::string body = paragraph("Bundle, SHA-256 <span class=\"hash\">" + words(bundle["sha256"]) +
                               "</span>, frozen " + words(bundle["frozen_utc"]) + " by ViP-Lab " +
                               words(bundle["vip_lab"]) + ". " + words(bundle["summary"]));
  std::string times;
  for (const Field& one : bundle["times"].entries()) times += words(one["text"]) + " ";
  if (!times.empty())
    body += paragraph(times +
                      "These dates are what the clocks of the computers said: only a hash that was deposited "
                      "elsewhere proves its date.");
  std::vector<std::string> differences;
  for (const Field& d : bundle["differences"].entries()) differences.push_back(words(d));
  if (!differences.empty())
    body += "<div class=\"warning\"><p><strong>What differs from the preregistration</strong></p>\n" +
            list(differences) + "</div>\n";
  return body;
}

/// Names the contents of the page that are not hypotheses: "tables and tests of Task 1, ordinal models, ...".
std::string everything_else(const Field& root) {
  std::vector<std::string> parts;
  for (const auto& [key, title] : all_parts)
    if (root[key].exists()) parts.push_back(std::string("tables and tests of ") + title);
  if (!root["descriptives"].entries().empty()) parts.emplace_back("answers by cell");
  if (!root["task1"]["ordinal"].entries().empty()) parts.emplace_back("ordinal models");
  if (root["task2"]["bradley_terry"].exists()) parts.emplace_back("the Bradley-Terry model");
  if (!root["sensitivity"].entries().empty()) parts.emplace_back("sensitivity");
  return base::enumerated(parts);
}

}  // namespace

bool preregistered(const Field& root, const std::string& task) {
  return root["preregistration"]["tasks"][task].yes();
}

std::string preregistration_section(const Field& root) {
  const Field plan = root["plan"], bundle = root["preregistration"];
  if (!plan.exists() && !bundle.exists()) return "";
  std::string body = bundle.exists()
                         ? bundle_text(bundle)
                         : paragraph(
                               "No preregistration was given: every analysis of this page is exploratory. "
                               "Rules in force: " +
                               words(plan["source"]) + ".");
  std::vector<std::string> parts;
  for (const auto& [key, title] : all_parts) {
    const std::string task = key;
    const auto hypotheses = root["hypotheses"].entries();
    if (root[key].exists() && std::any_of(hypotheses.begin(), hypotheses.end(),
                                          [&](const Field& one) { return one["task"].words() == task; }))
      parts.push_back(badge(preregistered(root, key)) + " Hypotheses of " + title +
                      ": the tests of each family with their margins, corrections and exclusions.");
  }
  const std::string rest = everything_else(root);
  if (!rest.empty())
    parts.push_back(badge(false) + (parts.empty() ? " All of it: " : " All but the hypotheses: ") + rest +
                    ".");
  return section("preregistration", "Preregistered and exploratory parts", body + list(parts));
}

std::string provenance_section(const Field& root) {
  Table table("Where the numbers come from", {"What", "Value"});
  for (const auto& [name, version] : root["versions"].members())
    table.row({"Version: " + svg::escaped(name), words(version)});
  table.row({"Computed (UTC)", words(root["date_utc"])});
  for (const Field& protocol : root["study"]["protocols"].entries())
    table.row({"Protocol of " + words(protocol["title"]) + ", SHA-256",
               "<span class=\"hash\">" + words(protocol["sha256"]) + "</span>"});
  table.row({"Rules in force", words(root["plan"]["source"])});
  if (!root["plan"]["sha256"].words().empty())
    table.row({"Rules, SHA-256", "<span class=\"hash\">" + words(root["plan"]["sha256"]) + "</span>"});
  return section(
      "provenance", "Provenance",
      table.html() + paragraph("Every number of this page is read from the results' JSON, schema " +
                               words(root["schema"]) +
                               "; the attribute <code>data-field</code> names its place there."));
}

}  // namespace study::report
