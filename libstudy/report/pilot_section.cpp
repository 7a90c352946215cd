#include <algorithm>
#include <set>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/ptpe/heat_map.hpp"
#include "libstudy/report/figures.hpp"
#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

stats::ScoreGrid grid_of(const Field& cells) {
  std::set<double> mu, delta;
  for (const Field& cell : cells.entries()) {
    mu.insert(cell["fps_mean"].number());
    delta.insert(cell["fps_sd"].number());
  }
  stats::ScoreGrid grid;
  grid.mu.assign(mu.begin(), mu.end());
  grid.delta.assign(delta.begin(), delta.end());
  grid.nodes.resize(mu.size() * delta.size());
  for (const Field& cell : cells.entries()) {
    const auto row = std::distance(mu.begin(), mu.find(cell["fps_mean"].number()));
    const auto column = std::distance(delta.begin(), delta.find(cell["fps_sd"].number()));
    grid.nodes[static_cast<std::size_t>(row) * delta.size() + static_cast<std::size_t>(column)] = {
        cell["score"].number(), cell["realised_mean"].number(), cell["realised_sd"].number()};
  }
  return grid;
}

std::string a_with_interval(const Field& e) { return fixed(e["a"], 2) + " " + rate_interval(e["a_ci"]); }
std::string b_with_interval(const Field& e) { return fixed(e["b"], 4) + " " + interval(e["b_ci"], 4); }

std::string for_solver(const Field& pilot) {
  return pilot["doubts"].entries().empty() ? "For the solver" : "Not for a solver";
}

void estimate_row(Table& table, const std::string& name, const Field& e) {
  if (!e["a"].is_number()) {
    const std::string reason = e.reason().empty() ? e["a"].reason() : e.reason();
    table.refused(name, "no estimate: " + typeset(svg::escaped(reason)));
    return;
  }
  table.row({name, a_with_interval(e), b_with_interval(e)});
}

/// The frame rates at which the ratings were analysed, in words.
std::string rates_of(const Field& pilot) {
  return pilot["rates"].exists() ? words(pilot["rates"]) : "realised";
}

std::string model_of(const Field& pilot) {
  if (pilot["estimator"].words().empty()) return "";
  const std::string mu = typeset("mu"), delta = typeset("delta"), u = "<i>u</i>";
  return paragraph(
             "Model of the direct estimate, least squares of all ratings with a participant's ratings of one "
             "setting averaged, at the " +
             rates_of(pilot) + " " + mu + " and " + delta + ":") +
         "<p class=\"formula\">E[score] = level + <i>k</i>\xE2\x80\x89" + u + " + <i>m</i>\xE2\x80\x89" + u +
         "\xE2\x80\x89" + delta + " + <i>q</i>\xE2\x80\x89" + u + "\xC2\xB2, with " + u +
         " = log\xE2\x80\x89" + mu +
         " \xE2\x88\x92 log\xE2\x80\x89<i>a</i> \xE2\x88\x92 <i>b</i>\xE2\x80\x89" + delta + "</p>\n";
}

std::string estimates(const Field& pilot) {
  Table table("Estimates of " + pilot_curve + ", intervals over participants",
              {"Estimate", "<i>a</i> [CI], frames/s", "<i>b</i> [CI], s/frame"});
  // The first row has the interval that is written into the solver's file. It can be wider than the interval
  // of the direct estimate, which is in the list of estimators.
  if (pilot["a"].is_number())
    table.row({"<strong>" + for_solver(pilot) + "</strong>, level " + fixed(pilot["level"], 1),
               a_with_interval(pilot), b_with_interval(pilot)});
  for (const Field& e : pilot["estimators"].entries())
    estimate_row(table,
                 words(e["label"]) + ", level " + fixed(e["level"], 1) +
                     (e["main"].yes() ? ", with its own interval" : ""),
                 e);
  // The list of estimators already holds the estimates with the harmonic mean.
  const bool listed = !pilot["estimators"].entries().empty();
  for (const char* mean : {"harmonic", "arithmetic"}) {
    if (listed && std::string(mean) == "harmonic") continue;
    for (const Field& e : pilot["means"][mean].entries())
      estimate_row(table,
                   "Contour of means with the " + std::string(mean) + " mean, level " + fixed(e["level"], 1),
                   e);
  }
  return table.empty() ? "" : table.html();
}

std::string bands(const Field& pilot) {
  const std::string mu = typeset("mu"), delta = typeset("delta");
  Table table("The curve " + typeset("mu(delta)") + " with its bands, frames/s",
              {delta, mu, "CI at this " + delta, "Band over all " + delta, "Band in the solver's file"});
  std::string level;
  for (const Field& point : pilot["bands"].entries()) {
    const std::string here = svg::number(point["level"].number(), 4);
    if (here != level) table.group("Level " + fixed(point["level"], 1));
    level = here;
    table.row({fixed(point["delta"], 0), fixed(point["mu"], 2), rate_interval(point["ci"]),
               rate_interval(point["simultaneous_ci"]), rate_interval(point["solver_ci"])});
  }
  return table.empty() ? "" : table.html();
}

/// The test that the curve is an exponential. If the test rejects, a table of the curve fitted without this
/// assumption follows.
std::string form(const Field& pilot) {
  const Field test = pilot["form"];
  if (!test.exists()) return "";
  std::string out = paragraph("Form of the curve: " + words(test["text"]) + ".");
  if (!test["rejected"].yes()) return out;
  const std::string mu = typeset("mu"), delta = typeset("delta");
  Table table("The free curve, which has one parameter more, with its bands, frames/s",
              {delta, mu, "CI at this " + delta, "Band over all " + delta});
  for (const Field& point : test["free_curve"].entries())
    table.row({fixed(point["delta"], 0), fixed(point["mu"], 2), rate_interval(point["ci"]),
               rate_interval(point["simultaneous_ci"])});
  return out + table.html();
}

std::string raters(const Field& pilot) {
  std::string out;
  const Field all = pilot["raters"];
  if (!all.exists()) return out;
  for (const auto& [name, part] : {std::pair{"Direction of the ratings", "reverse_coders"},
                                   {"Drift over the session", "drift"},
                                   {"Lapses to the lowest score", "lapses"},
                                   {"Answers far from the score expected", "far_answers"}})
    if (!all[part]["text"].words().empty())
      out += paragraph(std::string(name) + ": " + words(all[part]["text"]) + ".");
  return out;
}

std::string cells(const Field& pilot) {
  const bool recorded = !pilot["rates"].exists();
  const std::string mean = recorded ? "Realised mean" : "Mean: " + rates_of(pilot),
                    sd = recorded ? "Realised SD" : "SD: " + rates_of(pilot);
  Table table("Scores of the settings, over participants",
              {"Setting: mean, frames/s", "SD, frames/s", mean, sd, "<i>n</i>", "Mean score", "<i>SD</i>",
               "CI (<i>t</i>)"});
  for (const Field& c : pilot["cells"].entries())
    table.row({fixed(c["fps_mean"], 0), fixed(c["fps_sd"], 0), fixed(c["realised_mean"], 2),
               fixed(c["realised_sd"], 2), count(c["n"]), fixed(c["score"], 2), fixed(c["sd"], 2),
               interval(c["ci"], 2)});
  return table.empty() ? "" : table.html();
}

}  // namespace

svg::Picture pilot_map(const Field& pilot) {
  HeatMap map;
  map.title = "PTPE pilot: mean scores";
  map.grid = grid_of(pilot["cells"]);
  if (pilot["scale_min"].is_number()) map.scale_min = pilot["scale_min"].number();
  if (pilot["scale_max"].is_number()) map.scale_max = pilot["scale_max"].number();
  for (const Field& e : pilot["means"]["harmonic"].entries()) {
    const double level = e["level"].number();
    map.levels.push_back(level);
    // The contour's points are drawn only if the curve was fitted to them. If the results list several
    // estimators, the curve is the direct estimate.
    if (level != pilot["level"].number() || !pilot["estimators"].entries().empty()) continue;
    for (const Field& point : e["contour"]["points_delta_mu"].entries())
      map.points.push_back({point[0].number(), point[1].number()});
  }
  map.a = pilot["a"].number();
  map.b = pilot["b"].number();
  map.a_ci = {number_of(pilot["a_ci"][0].json()), number_of(pilot["a_ci"][1].json())};
  map.b_ci = {number_of(pilot["b_ci"][0].json()), number_of(pilot["b_ci"][1].json())};
  map.confidence = pilot["interval"]["confidence"].number();
  if (pilot["form"]["rejected"].yes())
    for (const Field& point : pilot["form"]["free_curve"].entries())
      map.free_curve.push_back({point["delta"].number(), point["mu"].number()});
  map.cells_field = pilot.pointer() + "/cells";
  map.estimate_field = pilot.pointer();
  return heat_map(map);
}

std::string pilot_section(const Field& root) {
  const Field pilot = root["pilot"];
  if (pilot.json().is_null()) return "";
  if (!pilot.exists() || pilot["status"].words() != "ok") {
    const std::string reason = pilot.exists() ? pilot["reason"].words() : pilot.reason();
    return section("pilot", "Pilot: tolerance of frame rates",
                   "<p class=\"refused\">No fit: " + typeset(svg::escaped(reason)) + ".</p>\n");
  }
  std::string body =
      paragraph(count(pilot["n_participants"]) + " participants gave " + count(pilot["n_ratings"]) +
                " ratings of " + count(pilot["n_settings"]) + " settings. " + for_solver(pilot) +
                ", at level " + fixed(pilot["level"], 1) + ": <i>a</i> = " + a_with_interval(pilot) +
                " frames/s, <i>b</i> = " + b_with_interval(pilot) + " s/frame.");
  for (const Field& flag : pilot["flags"].entries())
    body += "<p class=\"warning\">About the fit: " + words(flag["text"]) + "</p>\n";
  if (!pilot["cells"].entries().empty() && pilot["a_ci"].entries().size() == 2)
    body +=
        figure(pilot_map(pilot),
               "Mean scores over the standard deviation and the mean of the frame rate, with contours and "
               "the fitted curve, as the paper's Fig.&nbsp;6.");
  body += estimates(pilot);
  if (pilot["lack_of_fit"].exists())
    body += paragraph("Shape of the scores: " + words(pilot["lack_of_fit"]["text"]) + ".");
  body += raters(pilot) + form(pilot) + bands(pilot);
  const Field resampling = pilot["bootstrap"].exists() ? pilot["bootstrap"] : pilot["interval"];
  body += model_of(pilot);
  body += paragraph("Intervals: " + words(pilot["interval"]["method"]) +
                    " (bootstrap: " + count(resampling["resamples"]) + " resamples, seed " +
                    count(resampling["seed"]) + "). " + words(pilot["means"]["note"]));
  return section("pilot", "Pilot: tolerance of frame rates",
                 body + cells(pilot) + pilot_ratings(pilot) + response_times(root, "pilot"));
}

}  // namespace study::report
