#include <algorithm>

#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

/// Names of the protocols for which `holds` is true, each once, as "Pilot (ptpe_pilot, version 1.0)".
template <class Holds>
std::vector<std::string> parts_where(const Field& root, Holds holds) {
  std::vector<std::string> out, seen;
  for (const Field& document : documents(root)) {
    for (const Field& protocol : document["study"]["protocols"].entries()) {
      const std::string& sha256 = protocol["sha256"].words();
      if (!holds(protocol) || std::find(seen.begin(), seen.end(), sha256) != seen.end()) continue;
      seen.push_back(sha256);
      out.push_back(words(protocol["title"]) + " (" + words(protocol["name"]) + ", version " +
                    words(protocol["version"]) + ")");
    }
  }
  return out;
}

std::string observers(const Field& root) {
  std::string out;
  std::vector<std::string> seen;
  for (const Field& document : documents(root)) {
    for (const Field& observer : document["study"]["observers"].entries()) {
      if (std::find(seen.begin(), seen.end(), observer.words()) != seen.end()) continue;
      seen.push_back(observer.words());
      out += (out.empty() ? "" : ", ") + words(observer);
    }
  }
  return out;
}

}  // namespace

std::vector<Field> documents(const Field& root) {
  std::vector<Field> out{root};
  for (const Field& one : root["apart"].entries()) out.push_back(one);
  return out;
}

namespace {

/// Warnings at the top of the page: the data are incomplete, test data or simulated.
std::string banners(const Field& root) {
  const Field study = root["study"];
  std::string out;
  if (study["incomplete"].exists())
    out += "<p class=\"warning\"><strong>Incomplete.</strong> " + words(study["incomplete"]) +
           ": the database lacks them, and so do these results.</p>\n";
  const auto test = parts_where(root, [](const Field& protocol) { return protocol["test_data"].yes(); });
  if (!test.empty())
    out += "<p class=\"warning\"><strong>Test data.</strong> There are no other data of " +
           base::enumerated(test) + ": these results say nothing about people.</p>\n";
  const auto simulated =
      parts_where(root, [](const Field& protocol) { return protocol["simulated"].number() > 0; });
  if (!simulated.empty())
    out += "<p class=\"warning\"><strong>Simulated participants: " + count(study["simulated_people"]) +
           "</strong> (" + observers(root) + "). All answers of " + base::enumerated(simulated) +
           " come from a model: they say nothing about people.</p>\n";
  const auto imported =
      parts_where(root, [](const Field& protocol) { return !protocol["imported"].members().empty(); });
  if (!imported.empty())
    out +=
        "<p class=\"warning\"><strong>Imported.</strong> Sessions of " + base::enumerated(imported) +
        " were recorded by another program: Methods names it, and the notes its files by their hashes.</p>\n";
  return out;
}

}  // namespace

std::string head_section(const Field& root) {
  const Field study = root["study"];
  std::string names;
  for (const std::string& one : parts_where(root, [](const Field&) { return true; }))
    names += (names.empty() ? "" : ", ") + one;
  return "<h1>Results of " + (study["database"].words().empty() ? "a study" : words(study["database"])) +
         "</h1>\n" +
         paragraph((names.empty() ? "" : "Parts: " + names + ". ") +
                   (root["date_utc"].exists() ? "Computed " + words(root["date_utc"]) + "." : "")) +
         banners(root);
}

}  // namespace study::report
