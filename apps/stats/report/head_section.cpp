#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"

namespace apps::report {

namespace {

std::string joined(const Field& list) {
  std::string out;
  for (const Field& item : list.entries()) out += (out.empty() ? "" : ", ") + words(item);
  return out;
}

/// Titles of the protocols of which `holds` is true.
template <class Holds>
std::vector<std::string> titles(const Field& study, Holds holds) {
  std::vector<std::string> out;
  for (const Field& protocol : study["protocols"].entries())
    if (holds(protocol)) out.push_back(words(protocol["title"]));
  return out;
}

}  // namespace

std::string enumerated(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return out;
}

std::vector<Field> documents(const Field& root) {
  std::vector<Field> out{root};
  for (const Field& one : root["apart"].entries()) out.push_back(one);
  return out;
}

namespace {

/// What a reader must know before any number: that it is of no people.
std::string banners(const Field& study) {
  std::string out;
  if (study["incomplete"].there())
    out += "<p class=\"warning\"><strong>Incomplete.</strong> " + words(study["incomplete"]) +
           ": the database lacks them, and so do these results.</p>\n";
  const auto test = titles(study, [](const Field& protocol) { return protocol["test_data"].yes(); });
  if (!test.empty())
    out += "<p class=\"warning\"><strong>Test data.</strong> There are no other data of " + enumerated(test) +
           ": these results say nothing about people.</p>\n";
  const auto simulated =
      titles(study, [](const Field& protocol) { return protocol["simulated"].number() > 0; });
  if (!simulated.empty())
    out += "<p class=\"warning\"><strong>Simulated participants: " + count(study["simulated"]) +
           "</strong> (" + joined(study["observers"]) + "). All answers of " + enumerated(simulated) +
           " come from a model: they say nothing about people.</p>\n";
  return out;
}

}  // namespace

std::string head_section(const Field& root) {
  const Field study = root["study"];
  std::string names, warnings;
  for (const Field& document : documents(root)) {
    for (const Field& protocol : document["study"]["protocols"].entries())
      names += (names.empty() ? "" : ", ") + words(protocol["name"]) +
               (document.pointer().empty() ? "" : " " + words(protocol["version"]));
    warnings += banners(document["study"]);
  }
  return "<h1>Results of " + (study["database"].words().empty() ? "a study" : words(study["database"])) +
         "</h1>\n" +
         paragraph((names.empty() ? "" : "Protocols: " + names + ". ") +
                   (root["date_utc"].there() ? "Computed " + words(root["date_utc"]) + "." : "")) +
         warnings;
}

}  // namespace apps::report
