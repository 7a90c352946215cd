#include <algorithm>
#include <iterator>

#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"

namespace apps::report {

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
    out += effects_text(protocol, title);
    if (protocol["overlay"].there())
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
    if (!part.there()) continue;
    out += std::string(title) + " was begun in " + count(part["started"]) + " sessions, of which " +
           count(part["done"]) + " were completed; " + count(part["excluded_participants"]) +
           " participants who had answered were left out and " + count(part["analysed"]) +
           " analysed, with " + count(part["trials_analysed"]) + " of " + count(part["trials_planned"]) +
           " planned trials (" + count(part["trials_excluded"]) + " answered ones left out). ";
  }
  return out;
}

/// The rules of exclusion in force, in words.
std::string exclusion_rules(const Field& root) {
  std::vector<std::string> parts;
  for (const auto& [key, title] : all_parts)
    if (root["flow"][key].there()) parts.emplace_back(title);
  const Field rules = root["plan"]["exclusions"];
  if (parts.empty() || !rules.there()) return "";
  const std::string timing = rules["timing"].words();
  std::string out = "The same rules of exclusion held for " + enumerated(parts) + ": " +
                    (timing == "none" ? std::string("no trial was left out for its timing verdict")
                                      : "trials whose timing verdict was " +
                                            std::string(timing == "degraded" ? "degraded or fail" : "fail") +
                                            " were left out");
  if (rules["min_catch_correct"].is_number())
    out += "; visits with fewer than " + percent(rules["min_catch_correct"]) +
           " of the catch pages right were left out";
  if (rules["max_repeat_difference"].is_number())
    out += "; visits whose repeated ratings differed by more than " +
           fixed(rules["max_repeat_difference"], 1) + " points on average were left out";
  if (rules["min_repeat_agreement"].is_number())
    out += "; visits with less than " + percent(rules["min_repeat_agreement"]) +
           " of repeated pairs answered alike were left out";
  if (rules["straight_lining_answers"].number() > 0)
    out += "; visits with one and the same answer throughout (" + count(rules["straight_lining_answers"]) +
           " answers or more) were left out";
  if (rules["min_answered"].number() > 0)
    out +=
        "; visits with less than " + percent(rules["min_answered"]) + " of the trials answered were left out";
  return out + ". The rules see neither method, scene nor frame rate. ";
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
             ? "H1 to H3 were tested by the mixed model of all answers with Satterthwaite's degrees of "
               "freedom; paired <i>t</i> tests stand beside. "
             : "H1 to H3 were tested by paired <i>t</i> tests. ";
}

std::string factors_text(const Field& root) {
  if (root["task1"]["factors"].entries().empty() && root["task2"]["factors"].entries().empty()) return "";
  return "What each level of a factor is worth over another was tested within participants by one-sample "
         "<i>t</i> tests, and by exact sign tests where all participants are alike. ";
}

std::string task1_text(const Field& root) {
  if (!root["task1"].there()) return "";
  const Field plan = root["plan"];
  return "Answers of Task 1 were averaged over scenes within each participant, " + n_star_sign +
         " and method before any "
         "paired test; methods were compared by paired <i>t</i> tests, with Wilcoxon's signed-rank and "
         "Welch's tests beside them. Equivalence was tested by two one-sided tests with margins of " +
         fixed(plan["margins"]["realism"], 2) + " points on realism and " +
         fixed(plan["margins"]["sickness"], 2) + " on cybersickness. Bootstrap intervals of Task 1 use " +
         count(plan["resamples"]) + " resamples with seed " + count(plan["seed"]) + ". " +
         tests_of_task1(root);
}

/// "two-sided", or which of H1 to H6 are not.
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
                     [&](const char* part) { return root[part].there(); });
}

}  // namespace

std::string methods_section(const Field& root) {
  std::string tests = factors_text(root) + hypotheses_text(root), end;
  if (root["task2"].there())
    tests = "Each pair of Task 2 was tested by an exact two-sided binomial test. " + tests;
  if (root["plan"]["confidence"].is_number() && has_intervals(root))
    end = "Intervals hold " + percent(root["plan"]["confidence"]) +
          " unless another share stands beside them. ";
  if (root["versions"].there())
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

}  // namespace apps::report
