#include <algorithm>
#include <iterator>

#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

std::string effects_text(const Field& protocol, const std::string& title) {
  std::string levels;
  for (const auto& [name, held] : protocol["effects"].members())
    levels += (levels.empty() ? "" : ", ") + svg::escaped(name) + " (" + words(held) + ")";
  if (levels.empty()) return "";
  return "Effects were a factor of " + title + " with the levels " + levels + ". ";
}

std::string protocols_text(const Field& study) {
  std::string out;
  for (const Field& protocol : study["protocols"].entries()) {
    const std::string title = words(protocol["title"]);
    out += "The protocol of " + title + " was " + words(protocol["name"]) + " version " +
           words(protocol["version"]) + " (SHA-256 <span class=\"hash\">" + words(protocol["sha256"]) +
           "</span>)" +
           (protocol["participants_planned"].is_number()
                ? ", planned for " + count(protocol["participants_planned"]) + " participants. "
                : ". ");
    if (!protocol["gaze"].members().empty())
      out += "Sessions of " + title +
             " with analysed answers by source of gaze: " + counts(protocol["gaze"]) +
             "; by display: " + counts(protocol["displays"]) + ". ";
    if (protocol["trackers"].exists())
      out +=
          "Of these, gaze came from an eye tracker outside OpenXR in: " + counts(protocol["trackers"]) + ". ";
    if (!protocol["angles"].members().empty())
      out += "Sessions of " + title +
             " with analysed answers by vertical angle: " + counts(protocol["angles"]) + ". ";
    if (!protocol["settings"].members().empty())
      out +=
          "Live fluid of " + title +
          " ran at these settings of the solver instead of the usual, by sessions with analysed answers: " +
          counts(protocol["settings"]) + ". ";
    if (!protocol["unblinded"].members().empty())
      out += "Sessions of " + title + " with analysed answers to which the experimenter was not blind: " +
             counts(protocol["unblinded"]) + ". ";
    for (const auto& [tool, sources] : protocol["imported"].members())
      out += "Of " + title + ", " + std::to_string(sources.entries().size()) +
             " sessions with analysed answers were recorded elsewhere, by " + svg::escaped(tool) +
             ", and imported. ";
    out += effects_text(protocol, title);
    if (protocol["overlay"].exists())
      out += "Over the water of every stimulus of " + title + " " + words(protocol["overlay"]) +
             " was painted. ";
    if (!protocol["mixed_pictures"].members().empty())
      out += "Sessions of " + title +
             " with analysed answers in which pictures of one scene were compared though they differ in "
             "renderer, size or angle, as the protocol accepts: " +
             counts(protocol["mixed_pictures"]) + ". ";
  }
  return out;
}

std::string people_text(const Field& flow) {
  std::string out;
  for (const auto& [key, title] : all_parts) {
    const Field part = flow[key];
    if (!part.exists()) continue;
    out += std::string(title) + " was begun in " + count(part["started"]) + " sessions, of which " +
           count(part["done"]) + " were completed; of " + count(part["participants"]) + " participants " +
           count(part["no_answer"]) + " gave no answer to analyse, " + count(part["excluded_participants"]) +
           " who had answered were left out and " + count(part["analysed"]) + " analysed, with " +
           count(part["trials_analysed"]) + " of " + count(part["trials_planned"]) + " planned trials (" +
           count(part["trials_excluded"]) + " answered ones left out). ";
  }
  return out;
}

/// The plan's exclusion rules in words, without those that cannot have an effect. `acting`: keys of the rules
/// that can have an effect.
std::string rules_text(const Field& rules, const std::vector<std::string>& acting) {
  const auto acts = [&](const char* rule) {
    return std::find(acting.begin(), acting.end(), rule) != acting.end();
  };
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  const std::string timing = rules["timing"].words();
  if (timing == "none")
    add("no trial was left out for its timing verdict");
  else if (acts("timing"))
    add("trials whose timing verdict was " + std::string(timing == "degraded" ? "degraded or fail" : "fail") +
        " were left out");
  if (rules["min_catch_correct"].is_number() && acts("min_catch_correct"))
    add("visits with fewer than " + percent(rules["min_catch_correct"]) +
        " of the catch pages right were left out");
  if (rules["max_repeat_difference"].is_number() && acts("max_repeat_difference"))
    add("visits whose repeated ratings differed by more than " + fixed(rules["max_repeat_difference"], 1) +
        " points on average were left out");
  if (rules["min_repeat_agreement"].is_number() && acts("min_repeat_agreement"))
    add("visits with less than " + percent(rules["min_repeat_agreement"]) +
        " of repeated pairs answered alike were left out");
  if (rules["straight_lining_answers"].number() > 0 && acts("straight_lining_answers"))
    add("visits with one and the same answer throughout (" + count(rules["straight_lining_answers"]) +
        " answers or more) were left out");
  if (rules["min_answered"].number() > 0 && acts("min_answered"))
    add("visits with less than " + percent(rules["min_answered"]) + " of the trials answered were left out");
  return out;
}

/// The exclusion rules in words for each part of the study. Parts with the same rules share one sentence.
std::string exclusion_rules(const Field& root) {
  const Field rules = root["plan"]["exclusions"];
  if (!rules.exists()) return "";
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;  // rules, parts
  for (const auto& [key, title] : all_parts) {
    if (!root["flow"][key].exists()) continue;
    std::vector<std::string> acting;
    for (const Field& protocol : root["study"]["protocols"].entries())
      if (protocol["task"].words() == key)
        for (const Field& rule : protocol["rules"].entries()) acting.push_back(rule.words());
    const std::string text = rules_text(rules, acting);
    const auto same =
        std::find_if(groups.begin(), groups.end(), [&](const auto& one) { return one.first == text; });
    if (same == groups.end())
      groups.push_back({text, {title}});
    else
      same->second.emplace_back(title);
  }
  std::string out;
  for (const auto& [text, parts] : groups)
    out += text.empty() ? "No rule of exclusion could act on " + base::enumerated(parts) + ". "
           : parts.size() > 1
               ? "The same rules of exclusion held for " + base::enumerated(parts) + ": " + text + ". "
               : "Rules of exclusion for " + parts.front() + ": " + text + ". ";
  return out.empty() ? "" : out + "The rules see neither method, scene nor frame rate. ";
}

std::string pilot_text(const Field& pilot) {
  if (pilot["status"].words() != "ok") return "";
  return "The pilot's curve " + pilot_curve +
         " was estimated by least squares of all ratings (the model stands under Pilot); its intervals by " +
         words(pilot["interval"]["method"]) + ". ";
}

std::string tests_of_task1(const Field& root) {
  const auto hypotheses = root["hypotheses"].entries();
  if (std::none_of(hypotheses.begin(), hypotheses.end(),
                   [](const Field& one) { return one["task"].words() == "task1"; }))
    return "";
  return root["plan"]["tests"].words() == "mixed"
             ? "Hypotheses of Task 1 were tested by the mixed model of all answers with Satterthwaite's "
               "degrees of freedom; paired <i>t</i> tests stand beside. "
             : "Hypotheses of Task 1 were tested by paired <i>t</i> tests. ";
}

std::string tests_of_task2(const Field& pairs) {
  bool binomial = false, shares = false;
  for (const Field& pair : pairs.entries()) {
    shares = shares || pair["by_person"].exists();
    binomial = binomial || (!pair["by_person"].exists() && pair["test"].exists());
  }
  if (!shares && !binomial) return "";
  if (!shares) return "Each pair of Task 2 was tested by an exact two-sided binomial test. ";
  const std::string of_people =
      "by an exact two-sided permutation test of people's shares against one half, since people answered it "
      "several times. ";
  if (!binomial) return "Each pair of Task 2 was tested " + of_people;
  return "Each pair of Task 2 was tested by an exact two-sided binomial test, or " + of_people;
}

std::string factors_text(const Field& root) {
  if (root["task1"]["factors"].entries().empty() && root["task2"]["factors"].entries().empty()) return "";
  return "What each level of a factor is worth over another was tested within participants by one-sample "
         "<i>t</i> tests, and by exact sign tests where all participants are alike. ";
}

/// The plan's margins in words, without that of cybersickness if its items were not asked.
std::string margins_text(const Field& root) {
  const Field margins = root["plan"]["margins"];
  const auto scores = root["task1"]["scores"].entries();
  const bool sickness = std::any_of(scores.begin(), scores.end(),
                                    [](const Field& one) { return one["code"].words() == "sickness"; });
  const std::string realism = fixed(margins["realism"], 2) + " points on realism";
  if (!sickness) return "a margin of " + realism;
  return "margins of " + realism + " and " + fixed(margins["sickness"], 2) + " on cybersickness";
}

std::string task1_text(const Field& root) {
  if (!root["task1"].exists()) return "";
  const Field plan = root["plan"];
  return "Answers of Task 1 were averaged over scenes within each participant, " + n_star_sign +
         " and method before any "
         "paired test; methods were compared by paired <i>t</i> tests, with Wilcoxon's signed-rank and "
         "Welch's tests beside them. Equivalence was tested by two one-sided tests with " +
         margins_text(root) + ". Bootstrap intervals of Task 1 use " + count(plan["resamples"]) +
         " resamples with seed " + count(plan["seed"]) + ". " + tests_of_task1(root);
}

/// Words on the direction of the tests: "two-sided", "one-sided, ...", or "two-sided, but one-sided for" the
/// hypotheses named.
std::string sides(const Field& directional) {
  if (!directional.words().empty()) return "two-sided, but one-sided for " + words(directional);
  return directional.yes() ? "one-sided, in the direction claimed" : "two-sided";
}

std::string hypotheses_text(const Field& root) {
  if (root["hypotheses"].entries().empty()) return "";
  const Field plan = root["plan"];
  const bool by_holm = plan["decision"].words() == "holm";
  std::string out = "Tests of the hypotheses were " + sides(plan["directional"]) + ". " +
                    (by_holm ? "Within each hypothesis Holm's correction held the family-wise error rate at "
                             : "A hypothesis needed every one of its tests, each significant without "
                               "correction (intersection-union) at ") +
                    fixed(plan["alpha"], 2) + " (tests in each family: ";
  bool first = true;
  for (const Field& h : root["hypotheses"].entries()) {
    out += (first ? "" : ", ") + words(h["id"]) + " " + count(h["family"]);
    first = false;
  }
  return out + "). " +
         (by_holm ? "" : "Single tests were claimed after Holm's correction within their hypothesis. ");
}

bool has_intervals(const Field& root) {
  const char* parts[] = {"pilot", "task1", "task2", "sickness"};
  return std::any_of(std::begin(parts), std::end(parts),
                     [&](const char* part) { return root[part].exists(); });
}

}  // namespace

std::string methods_section(const Field& root) {
  std::string tests = factors_text(root) + hypotheses_text(root), end;
  if (root["task2"].exists()) tests = tests_of_task2(root["task2"]["pairs"]) + tests;
  if (root["plan"]["confidence"].is_number() && has_intervals(root))
    end = "Intervals hold " + percent(root["plan"]["confidence"]) +
          " unless another share stands beside them. ";
  if (root["versions"].exists())
    end += "The analysis was made with ViP-Lab " + words(root["versions"]["vip_lab"]) +
           " and the GNU Scientific Library " + words(root["versions"]["gsl"]) + ".";
  std::string body;
  for (const std::string& text :
       {protocols_text(root["study"]), people_text(root["flow"]), exclusion_rules(root),
        pilot_text(root["pilot"]), task1_text(root), tests, end})
    if (!text.empty()) body += paragraph(text);
  for (const Field& note : root["study"]["notes"].entries()) body += paragraph("Note: " + words(note));
  return section("methods", "Methods", body);
}

}  // namespace study::report
