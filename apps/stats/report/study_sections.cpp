#include "apps/stats/report/figures.hpp"
#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"

namespace apps::report {

namespace {

struct Task {
  const char* key;
  const char* name;
};
constexpr Task tasks[] = {{"task1", "Task 1"}, {"task2", "Task 2"}};

/// "26 tracked, 3 mouse" of an object with counts.
std::string counts(const Field& object) {
  std::string out;
  for (const auto& [name, n] : object.members()) {
    if (n.number() <= 0) continue;
    const std::string shown = name.empty() ? "not said" : svg::escaped(name);
    out += (out.empty() ? "" : ", ") + shown + ": " + count(n);
  }
  return out.empty() ? "none" : out;
}

std::string joined(const Field& list) {
  std::string out;
  for (const Field& item : list.entries()) out += (out.empty() ? "" : ", ") + words(item);
  return out;
}

std::string people(const Field& flow) {
  std::string out;
  for (const auto& [key, name] : tasks) {
    const Field task = flow[key];
    if (!task.there()) continue;
    out += std::string(name) + " was begun by " + count(task["started"]) + " and completed by " +
           count(task["done"]) + " participants; " + count(task["excluded_participants"]) +
           " were left out and " + count(task["analysed"]) + " analysed, with " +
           count(task["trials_analysed"]) + " of " + count(task["trials_planned"]) + " planned trials (" +
           count(task["trials_excluded"]) + " left out). ";
  }
  return out;
}

/// The rules of exclusion in force, in words.
std::string exclusion_rules(const Field& rules) {
  std::string out = "Trials whose timing verdict was " +
                    (rules["timing"].words() == "none"       ? std::string("whatever it was stayed in")
                     : rules["timing"].words() == "degraded" ? std::string("degraded or fail were left out")
                                                             : std::string("fail were left out"));
  if (rules["min_catch_correct"].is_number())
    out += "; participants with fewer than " + percent(rules["min_catch_correct"]) +
           " of the catch pages right were left out";
  if (rules["max_repeat_difference"].is_number())
    out += "; as were those whose repeated ratings differed by more than " +
           fixed(rules["max_repeat_difference"], 1) + " points on average";
  if (rules["min_repeat_agreement"].is_number())
    out += "; as were those with less than " + percent(rules["min_repeat_agreement"]) +
           " of repeated pairs answered alike";
  if (rules["straight_lining_answers"].number() > 0) {
    out += "; as were those who gave one and the same answer throughout (" +
           count(rules["straight_lining_answers"]) + " answers or more)";
  } else if (rules["straight_lining"].yes()) {
    out += "; as were those who gave one and the same answer throughout";
  }
  if (rules["min_answered"].number() > 0)
    out += "; as were those with less than " + percent(rules["min_answered"]) + " of the trials answered";
  return out + ". The rules see neither method nor scene. ";
}

std::string tests(const Field& root) {
  const Field plan = root["plan"];
  std::string out;
  if (root["task1"].there())
    out +=
        "Answers of Task 1 were averaged over scenes within each participant, n* and method before any "
        "paired test; methods were compared by paired <i>t</i> tests, with Wilcoxon's signed-rank and "
        "Welch's tests beside them. Equivalence was tested by two one-sided tests with margins of " +
        fixed(plan["margins"]["realism"], 2) + " points on realism and " +
        fixed(plan["margins"]["sickness"], 2) + " on cybersickness. ";
  if (root["task2"].there()) out += "Preferences of Task 2 were tested by exact two-sided binomial tests. ";
  if (!root["hypotheses"].entries().empty()) {
    out += "Within each hypothesis Holm's correction held the family-wise error rate at " +
           fixed(plan["alpha"], 2) + " (tests in each family: ";
    bool first = true;
    for (const Field& h : root["hypotheses"].entries()) {
      out += (first ? "" : ", ") + words(h["id"]) + " " + count(h["family"]);
      first = false;
    }
    out += "). ";
  }
  return out + "Intervals hold " + percent(plan["confidence"]) +
         " unless said otherwise; bootstrap intervals use " + count(plan["resamples"]) +
         " resamples with seed " + count(plan["seed"]) + ". ";
}

std::string protocols_text(const Field& study) {
  std::string out;
  for (const Field& protocol : study["protocols"].entries())
    out += "The protocol of " + words(protocol["task"]) + " was " + words(protocol["name"]) + " version " +
           words(protocol["version"]) + " (SHA-256 <span class=\"hash\">" + words(protocol["sha256"]) +
           "</span>), planned for " + count(protocol["participants_planned"]) + " participants. ";
  return out;
}

std::string pilot_text(const Field& pilot) {
  if (!pilot["protocol"].there()) return {};
  std::string out = "The protocol of the pilot was " + words(pilot["protocol"]["name"]) +
                    " (SHA-256 <span class=\"hash\">" + words(pilot["protocol"]["sha256"]) + "</span>). ";
  if (pilot["status"].words() != "ok") return out;
  return out + count(pilot["n_participants"]) + " participants gave " + count(pilot["n_ratings"]) +
         " ratings of " + count(pilot["n_settings"]) +
         " settings. Estimator of a and b: " + words(pilot["estimator"]) +
         "; intervals: " + words(pilot["interval"]["method"]) + ". ";
}

std::string exclusions_table(const Field& root) {
  Table table("All that was left out",
              {"Participant", "Task", "Visit", "Trial", "Rule", "Reason", "Decided by", "Answers lost"});
  for (const Field& e : root["exclusions"].entries())
    table.row({words(e["participant"]), words(e["task"]), count(e["visit"]),
               e["position"].is_number() ? count(e["position"]) : "all", words(e["rule"]), words(e["reason"]),
               words(e["actor"]), count(e["answers"])});
  if (table.empty()) return paragraph("Nothing was left out by rule or by hand.");
  return table.html() + "<p class=\"note\">Trials are counted from nought, in the order of showing.</p>\n";
}

}  // namespace

std::string head_section(const Field& root) {
  const Field study = root["study"];
  const Field pilot = root["pilot"]["protocol"];
  std::string names = pilot.there() ? words(pilot["name"]) : "";
  for (const Field& protocol : study["protocols"].entries())
    names += (names.empty() ? "" : ", ") + words(protocol["name"]);
  std::string out = "<h1>Results of " +
                    (study["database"].words().empty() ? "a study" : words(study["database"])) + "</h1>\n" +
                    paragraph((names.empty() ? "" : "Protocols: " + names + ". ") + "Computed " +
                              words(root["date_utc"]) + ".");
  if (study["test_data"].yes())
    out +=
        "<p class=\"warning\"><strong>Test data.</strong> The study holds nothing but test data: these "
        "results say nothing about people.</p>\n";
  if (study["simulated"].number() > 0)
    out += "<p class=\"warning\"><strong>Simulated participants: " + count(study["simulated"]) +
           "</strong> (" + joined(study["observers"]) +
           "). Their answers come from a model; these results say nothing about people.</p>\n";
  return out;
}

std::string methods_section(const Field& root) {
  const Field study = root["study"];
  std::string text = pilot_text(root["pilot"]) + protocols_text(study) + people(root["flow"]);
  if (study["gaze"].there()) text += "Sessions by source of gaze: " + counts(study["gaze"]) + ". ";
  if (study["displays"].there()) text += "Sessions by display: " + counts(study["displays"]) + ". ";
  if (root["plan"]["exclusions"].there()) text += exclusion_rules(root["plan"]["exclusions"]);
  text += tests(root);
  if (root["versions"].there())
    text += "The analysis was made with ViP-Lab " + words(root["versions"]["vip_lab"]) +
            " and the GNU "
            "Scientific Library " +
            words(root["versions"]["gsl"]) + ".";
  std::string body = paragraph(text);
  for (const Field& note : study["notes"].entries()) body += paragraph("Note: " + words(note));
  return section("methods", "Methods", body);
}

std::string participants_section(const Field& root) {
  std::string body;
  for (const auto& [key, name] : tasks) {
    const Field flow = root["flow"][key];
    if (flow.there())
      body += figure(flow_chart(flow, std::string("flow-") + key, name),
                     std::string("What became of those who began ") + name + ".");
  }
  if (body.empty() && !root["exclusions"].there()) return "";
  return section("participants", "Participants and exclusions", body + exclusions_table(root));
}

std::string timing_section(const Field& root) {
  const Field timing = root["timing"];
  if (timing.entries().empty()) return "";
  std::string body = paragraph(
      "Each showing was recorded frame by frame and judged against the protocol's tolerance. Grades of "
      "evidence: A photodiode, B display feedback, C compositor, D submission by the program.");
  for (const auto& [key, name] : tasks) {
    Table table(std::string("Timing certificate, ") + name,
                {"Scene", "n*", "Method", "Showings", "Pass", "Degraded", "Fail", "Not judged", "Grades",
                 "Nominal mean", "SD (frames/s)", "Realised mean", "SD (frames/s)", "Longest (ms)",
                 "Late frames", "Solved (%)", "Tau (frames/s)"});
    for (const Field& c : timing.entries()) {
      if (c["task"].words() != key) continue;
      table.row({words(c["scene"]), words(c["n_star"]), words(c["method"]), count(c["showings"]),
                 count(c["pass"]), count(c["degraded"]), count(c["fail"]), count(c["unjudged"]),
                 counts(c["grades"]), fixed(c["nominal_mean_fps"], 2), fixed(c["nominal_sd_fps"], 2),
                 fixed(c["realised_mean_fps"], 2), fixed(c["realised_sd_fps"], 2), fixed(c["longest_ms"], 1),
                 count(c["late_frames"]), percent(c["active_fraction"]), fixed(c["tau_fps"], 2)});
    }
    if (table.empty()) continue;
    body +=
        figure(timing_chart(timing, key), std::string(name) + ": verdicts by method and n*.") + table.html();
  }
  return section("timing", "Timing", body);
}

std::string preregistration_section(const Field& root) {
  const Field plan = root["plan"], bundle = root["preregistration"];
  if (!plan.there() && !bundle.there()) return "";
  std::string body;
  if (!bundle.there()) {
    body = paragraph(
        "No preregistration was given: every analysis of this page is exploratory. Rules in "
        "force: " +
        words(plan["source"]) + ".");
  } else {
    body = paragraph("Bundle, SHA-256 <span class=\"hash\">" + words(bundle["sha256"]) + "</span>, frozen " +
                     words(bundle["frozen_utc"]) + " by ViP-Lab " + words(bundle["vip_lab"]) + ". " +
                     words(bundle["summary"]));
    std::vector<std::string> differences;
    for (const Field& d : bundle["differences"].entries()) differences.push_back(words(d));
    if (!differences.empty())
      body += "<div class=\"warning\"><p><strong>What differs from the preregistration</strong></p>\n" +
              list(differences) + "</div>\n";
  }
  std::vector<std::string> parts;
  for (const auto& [key, name] : tasks) {
    if (root[key].there())
      parts.push_back(badge(preregistered(root, key)) + " Hypotheses of " + name +
                      ": the tests of each family with their margins, corrections and exclusions.");
  }
  parts.push_back(badge(false) +
                  " All else: tables and tests of each task, ordinal and Bradley-Terry models, "
                  "results by scene, sensitivity, the pilot.");
  body += list(parts);
  return section("preregistration", "Preregistered and exploratory parts", body);
}

std::string provenance_section(const Field& root) {
  Table table("Where the numbers come from", {"What", "Value"});
  for (const auto& [name, version] : root["versions"].members())
    table.row({"Version: " + svg::escaped(name), words(version)});
  table.row({"Computed (UTC)", words(root["date_utc"])});
  for (const Field& protocol : root["study"]["protocols"].entries())
    table.row({"Protocol of " + words(protocol["task"]) + ", SHA-256",
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

}  // namespace apps::report
