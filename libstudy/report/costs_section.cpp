#include <algorithm>
#include <map>
#include <tuple>

#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

using Rows = std::vector<Field>;

Rows rows_of(const Field& costs, const std::string& task) {
  Rows out;
  for (const Field& row : costs.entries())
    if (row["task"].words() == task) out.push_back(row);
  return out;
}

template <class Holds>
bool any(const Rows& rows, Holds holds) {
  return std::any_of(rows.begin(), rows.end(), holds);
}

/// The answers to a stimulus: its mean score, or in Task 2 the share of pairs in which it was chosen.
std::string said(const Field& row, bool pairs) {
  return (pairs ? percent(row["said"]) : fixed(row["said"], 2)) +
         (row["said"].is_number() ? " (<i>n</i> = " + count(row["answers"]) + ")" : "");
}

const char* said_heading(bool pairs) { return pairs ? "Chosen" : "Score"; }

std::string error_of(const Field& error) {
  if (!error["mean"].is_number()) return fixed(error["mean"], 2);
  return words(error["error"]) + " " + fixed(error["mean"], 3) + " [" + fixed(error["low"], 3) + ", " +
         fixed(error["high"], 3) + "]";
}

std::string costs_table(const Rows& rows, const char* title, bool pairs) {
  Table table(std::string(title) + ": what frames cost, what error they carried, what people said",
              {"Method", n_star_sign, "Setting", "Made, ms", "p95, ms", "Shown, ms",
               "Error of the setting file", said_heading(pairs)});
  std::string scene;
  for (const Field& row : rows) {
    if (row["scene"].words() != scene) table.group(words(row["scene"]));
    scene = row["scene"].words();
    table.row({words(row["method"]), words(row["n_star"]), words(row["setting"]), fixed(row["made_ms"], 2),
               fixed(row["made_p95_ms"], 2), fixed(row["shown_ms"], 2), error_of(row["error"]),
               said(row, pairs)});
  }
  return table.html();
}

bool says_something(const Field& row) {
  return row["made_ms"].is_number() || row["shown_ms"].is_number() || row["error"]["mean"].is_number();
}

std::string notes(const Rows& rows, const char* title) {
  std::string out;
  if (any(rows, [](const Field& row) { return row["made_ms"].is_number(); })) {
    out +=
        "Made: computing and drawing a frame with nothing to wait for, as each station measured it before "
        "its "
        "sessions; mean over the sessions that hold it. ";
  } else {
    out += std::string("No session of ") + title +
           " holds what a frame costs: it is measured before live sessions on the real clock. ";
  }
  if (any(rows, [](const Field& row) { return row["shown_ms"].is_number(); }))
    out +=
        "Shown: mean interval between frames of showings without a schedule, which the display's rate "
        "bounds. ";
  if (any(rows, [](const Field& row) { return row["error"]["mean"].is_number(); }))
    out +=
        "The error is that which the setting file in the record says of itself, in per cent, with its least "
        "and "
        "largest start. ";
  if (any(rows, [](const Field& row) { return row["setting"].words() == "usual"; }))
    out += "No setting file is stored for a usual setting, so its error is not known here. ";
  return "<p class=\"note\">" + out + "</p>\n";
}

/// One table for each combination of machine, program, picture, reference and run length. Values of different
/// machines or programs are not comparable.
std::string sweep_tables_of(const Field& root, const Rows& rows, const char* title, bool pairs) {
  using Origin = std::tuple<std::string, std::string, std::string, double, double>;
  std::map<Origin, std::vector<std::pair<Field, Field>>> by_origin;  // row, price
  std::vector<std::string> missing;
  for (const Field& row : rows) {
    for (const Field& price : row["sweep"].entries())
      by_origin[{price["machine"].words(), price["program"].words(), price["picture"].words(),
                 price["reference_n_star"].number(), price["seconds"].number()}]
          .emplace_back(row, price);
    if (row["sweep"].json().is_object())
      missing.push_back(words(row["method"]) + " at " + n_star_sign + " " + words(row["n_star"]) + " in " +
                        words(row["scene"]) + ": " + words(row["sweep"]["refused"]) + ".");
  }
  std::vector<std::string> columns{"Method", n_star_sign, "ms", "p95, ms", "Times HiRes"};
  for (const auto& [name, heading] : root["sweep"]["errors"].members()) columns.push_back(words(heading));
  columns.emplace_back(said_heading(pairs));
  std::string out;
  for (const auto& [origin, some] : by_origin) {
    const Field& first = some.front().second;
    Table table(std::string(title) + ": cost and error in the sweep on " + words(first["machine"]) +
                    ", program " + words(first["program"]) + ", pictures " + words(first["picture"]) +
                    ", reference of " + n_star_sign + " " + count(first["reference_n_star"]),
                columns);
    std::string scene;
    for (const auto& [row, price] : some) {
      if (row["scene"].words() != scene) table.group(words(row["scene"]));
      scene = row["scene"].words();
      std::vector<std::string> cells{words(row["method"]), words(row["n_star"]), fixed(price["ms_mean"], 2),
                                     fixed(price["ms_p95"], 2), fixed(price["times_hires"], 2)};
      for (const auto& [name, heading] : root["sweep"]["errors"].members())
        cells.push_back(fixed(price["errors"][name]["mean"], 3));
      cells.push_back(said(row, pairs));
      table.row(cells);
    }
    out += table.html();
  }
  if (!out.empty())
    out +=
        "<p class=\"note\">The sweep ran each setting by itself; its times are of its machine and not of the "
        "sessions.</p>\n";
  return missing.empty()
             ? out
             : out + paragraph(std::string("Settings of ") + title + " that are not in the sweep:") +
                   list(missing);
}

}  // namespace

std::string costs_section(const Field& root) {
  std::string body;
  for (const auto& [task, title] : all_parts) {
    const Rows rows = rows_of(root["costs"], task);
    if (rows.empty()) continue;
    const bool pairs = std::string(task) == "task2";
    std::string part =
        (any(rows, says_something) ? costs_table(rows, title, pairs) : "") + notes(rows, title);
    if (root["sweep"].exists()) part += sweep_tables_of(root, rows, title, pairs);
    body += subsection(title, part);
  }
  if (body.empty()) return "";
  if (!root["sweep"].exists())
    body +=
        paragraph("A sweep file (<code>--sweep</code>) holds the errors of usual settings; none was given.");
  std::vector<std::string> left_out;
  for (const Field& why : root["sweep"]["left_out"].entries()) left_out.push_back(words(why) + ".");
  if (!left_out.empty()) body += paragraph("Not taken from the sweep:") + list(left_out);
  return section("costs", "Cost and error", body);
}

}  // namespace study::report
