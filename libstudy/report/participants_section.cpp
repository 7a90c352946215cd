#include <algorithm>

#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"
#include "stats/base/text.hpp"

namespace study::report {

namespace {

std::string exclusions_table(const Field& root) {
  Table table("All that was left out by rule or by hand",
              {"Participant", "Part", "Visit", "Trial", "Rule", "Reason", "Decided by", "Answers lost"});
  bool one_trial = false;
  for (const Field& e : root["exclusions"].entries()) {
    one_trial = one_trial || e["position"].is_number();
    table.row({words(e["participant"]), words(e["task"]), count(e["visit"]),
               e["position"].is_number() ? count(e["position"]) : "all", words(e["rule"]), words(e["reason"]),
               words(e["actor"]), count(e["answers"])});
  }
  if (table.empty()) return "";
  return table.html() +
         "<p class=\"note\">Answers lost are scores, choices and numbers that were given, those "
         "about repeated showings with them." +
         (one_trial ? " Trials are counted from nought, in the order of showing." : "") + "</p>\n";
}

/// A sentence that names the parts of the study (pilot, tasks) of which nothing was excluded; "" if there are
/// none.
std::string untouched(const Field& root) {
  std::vector<std::string> parts;
  for (const auto& [key, title] : all_parts) {
    bool touched = !root["flow"][key].exists();
    for (const Field& e : root["exclusions"].entries()) touched = touched || e["task"].words() == key;
    if (!touched) parts.emplace_back(title);
  }
  return parts.empty()
             ? ""
             : paragraph("Nothing of " + base::enumerated(parts) + " was left out by rule or by hand.");
}

bool any_judged(const Field& timing) {
  for (const Field& c : timing.entries())
    if (c["unjudged"].number() < c["showings"].number()) return true;
  return false;
}

/// True if a showing has frames, but no schedule to judge them by.
bool any_unjudged(const Field& timing) {
  for (const Field& c : timing.entries())
    if (c["unjudged"].number() > c["not_recorded"].number()) return true;
  return false;
}

/// A table of the database's protocols: counts of participants and sessions, and the sections that analyse
/// the protocol.
std::string roster(const Field& roster) {
  if (!roster.exists()) return "";
  Table table("Everybody in the database", {"Protocol", "Version", "SHA-256", "Participants", "Sessions",
                                            "Simulated", "Test data", "Section"});
  for (const Field& one : roster["protocols"].entries()) {
    std::string parts_named;
    for (const Field& place : one["sections"].entries())
      parts_named += (parts_named.empty() ? "" : ", ") + words(place);
    table.row({words(one["name"]), words(one["version"]),
               "<span class=\"hash\">" + words(one["sha256"]) + "</span>", count(one["participants"]),
               count(one["sessions"]), count(one["simulated"]), count(one["test_data"]),
               parts_named.empty() ? "none: set aside, or not chosen" : parts_named});
  }
  return paragraph("The database holds " + count(roster["sessions"]) + " sessions of " +
                   count(roster["participants"]) + " participants; " + count(roster["withdrawn"]) +
                   " withdrew, of whom nothing is kept.") +
         (table.empty() ? "" : table.html());
}

/// A cell's distribution as "answer: count; ...". Numeric scores that were never given are omitted, which
/// keeps the line of a long scale short. Labels are always listed.
std::string distribution(const Field& cell) {
  std::string out;
  for (const Field& one : cell["distribution"].entries()) {
    if (one["answer"].is_number() && one["count"].number() == 0) continue;
    const Field answer = one["answer"];
    out += (out.empty() ? "" : "; ") + (answer.is_number() ? count(answer) : words(answer)) + ": " +
           count(one["count"]);
  }
  return out;
}

bool flawed(const Field& cell) { return cell["degraded"].number() + cell["fail"].number() > 0; }

/// True if a cell of the timing table that belongs to the task of `total` has a number under `key`. `total`:
/// an entry of timing_totals.
bool measured(const Field& timing, const Field& total, const char* key) {
  const auto cells = timing.entries();
  return std::any_of(cells.begin(), cells.end(), [&](const Field& one) {
    return one["task"].words() == total["task"].words() && one[key].is_number();
  });
}

/// The timing table of a task. With `only_flawed`, it has only cells in which a showing was degraded or
/// failed.
std::string certificate(const Field& root, const Field& total, const std::string& caption, bool only_flawed) {
  const bool solved = measured(root["timing"], total, "active_fraction"),
             tau = measured(root["timing"], total, "tau_fps");
  std::vector<std::string> columns{"Scene",
                                   n_star_sign,
                                   "Method",
                                   "Planned rate: mean, SD (frames/s)",
                                   "Showings",
                                   "Pass",
                                   "Degraded",
                                   "Fail",
                                   "Not judged",
                                   "Grades",
                                   "Realised rate: mean, SD (frames/s)",
                                   "Longest (ms)",
                                   "Late frames"};
  if (solved) columns.emplace_back("Solved");
  if (tau) columns.emplace_back("Tau (frames/s)");
  Table table(caption, columns);
  for (const Field& c : root["timing"].entries()) {
    if (c["task"].words() != total["task"].words() || (only_flawed && !flawed(c))) continue;
    std::vector<std::string> cells{
        words(c["scene"]),
        words(c["n_star"]),
        words(c["method"]),
        c["nominal_mean_fps"].is_number()
            ? fixed(c["nominal_mean_fps"], 2) + ", " + fixed(c["nominal_sd_fps"], 2)
            : "none: as it ran",
        count(c["showings"]),
        count(c["pass"]),
        count(c["degraded"]),
        count(c["fail"]),
        count(c["unjudged"]),
        counts(c["grades"]),
        fixed(c["realised_mean_fps"], 2) + ", " + fixed(c["realised_sd_fps"], 2),
        fixed(c["longest_ms"], 1),
        count(c["late_frames"])};
    if (solved) cells.push_back(percent(c["active_fraction"]));
    if (tau) cells.push_back(fixed(c["tau_fps"], 2));
    table.row(cells);
  }
  return table.html() +
         (solved ? ""
                 : "<p class=\"note\">No showing measured the share of particles that was solved.</p>\n");
}

/// The timing of a task: a summary, a table of the cells with degraded or failed showings, and a table of all
/// cells that the reader can open.
std::string timing_of(const Field& root, const Field& total) {
  const std::string key = total["task"].words();
  std::string title = key;
  for (const auto& [part, name] : all_parts)
    if (key == part) title = name;
  std::string body =
      paragraph("Of " + count(total["showings"]) + " showings " + count(total["pass"]) + " passed, " +
                count(total["degraded"]) + " were degraded, " + count(total["fail"]) + " failed and " +
                count(total["unjudged"]) + " could not be judged. In " + count(total["flawed_cells"]) +
                " of " + count(total["cells"]) + " cells a showing was degraded or failed." +
                (total["not_recorded"].exists()
                     ? " Of " + count(total["not_recorded"]) +
                           " imported showings, counted as not judged, no frame was recorded: when they were "
                           "shown is not known. Their realised rates are what the source states, if it does."
                     : ""));
  if (total["flawed_cells"].number() > 0)
    body += figure(timing_chart(root["timing"], key),
                   title + ": verdicts by " +
                       (key == "pilot" ? std::string("setting") : "method and " + n_star_sign) +
                       ", where a showing was degraded or failed.") +
            certificate(root, total, title + ": cells in which a showing was degraded or failed", true);
  body += station_timing(root, key, title);
  return subsection(title, body + details("The certificate of all cells of " + title,
                                          certificate(root, total, "Timing certificate, " + title, false)));
}

}  // namespace

std::string descriptives_section(const Field& root) {
  std::string body;
  for (const auto& [key, title] : all_parts) {
    std::string tables;
    for (const Field& question : root["descriptives"].entries()) {
      if (question["task"].words() != key) continue;
      const std::string text = words(question["text"]);
      Table table("Answers to " + words(question["question"]) + (text.empty() ? "" : ": " + text),
                  {"Shown", "Scene", n_star_sign, "<i>n</i>", "Participants", "Mean", "<i>SD</i>", "Median",
                   "Answers given: how often"});
      for (const Field& c : question["cells"].entries())
        table.row({words(c["shown"]), words(c["scene"]), words(c["n_star"]), count(c["n"]),
                   count(c["participants"]), fixed(c["mean"], 2), fixed(c["sd"], 2), fixed(c["median"], 1),
                   distribution(c)});
      tables += table.empty() ? "<p class=\"refused\">No answer to " + words(question["question"]) +
                                    " is analysed.</p>\n"
                              : table.html();
    }
    if (!tables.empty()) body += subsection(title, tables);
    if (std::string(key) == "own") body += response_times(root, key);
  }
  if (body.empty()) return "";
  return section("descriptives", "Answers by cell",
                 paragraph("Every answer to a trial that is analysed, whatever else is computed from it. A "
                           "cell is what was shown in one scene at one " +
                           n_star_sign + "; <i>n</i> counts answers.") +
                     body);
}

std::string not_analysed_section(const Field& root) {
  std::vector<std::string> lines;
  for (const Field& one : root["not_analysed"].entries())
    lines.push_back("<strong>" + words(one["what"]) + "</strong>" +
                    (one["protocol"].words().empty() ? "" : " of " + words(one["protocol"])) +
                    " (not analysed): " + words(one["reason"]) + ".");
  if (lines.empty()) return "";
  return section("not-analysed", "Not analysed",
                 "<div class=\"warning\">" +
                     paragraph("The shipped analyses do not cover these parts of the study:") + list(lines) +
                     "</div>\n");
}

std::string participants_section(const Field& root) {
  std::string body = roster(root["roster"]);
  for (const auto& [key, title] : all_parts) {
    const Field flow = root["flow"][key];
    if (flow.exists())
      body += figure(flow_chart(flow, std::string("flow-") + key, title),
                     std::string("What became of those who began: ") + title +
                         ". Answers count whether or not their session was completed.");
  }
  body += people_tables(root) + exclusions_table(root) + untouched(root);
  return body.empty() ? "" : section("participants", "Participants and exclusions", body);
}

std::string timing_section(const Field& root) {
  const Field timing = root["timing"];
  if (timing.entries().empty()) return "";
  std::string body = paragraph(
      "Every showing that was played is counted, practice aside, also those of trials left out. " +
      std::string(any_judged(timing) ? "Its frames were judged against the protocol's tolerance. " : "") +
      (any_unjudged(timing) ? "Without a schedule there is nothing to judge by. " : "") +
      "Grades of evidence: A photodiode, B display feedback, C compositor, D submission by the program.");
  for (const Field& total : root["timing_totals"].entries()) body += timing_of(root, total);
  return section("timing", "Timing", body);
}

}  // namespace study::report
