#include <algorithm>
#include <set>

#include "apps/stats/ptpe/heat_map.hpp"
#include "apps/stats/report/figures.hpp"
#include "apps/stats/report/html.hpp"
#include "apps/stats/report/sections.hpp"

namespace apps::report {

namespace {

/// The grid that the cells' list was written from.
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

std::string a_with_interval(const Field& e) { return fixed(e["a"], 2) + " " + interval(e["a_ci"], 2); }
std::string b_with_interval(const Field& e) { return fixed(e["b"], 4) + " " + interval(e["b_ci"], 4); }

void estimate_row(Table& table, const std::string& name, const Field& e) {
  if (!e["a"].is_number()) {
    const std::string reason = e.reason().empty() ? e["a"].reason() : e.reason();
    table.refused(name, "no estimate: " + svg::escaped(reason));
    return;
  }
  table.row({name, a_with_interval(e), b_with_interval(e)});
}

std::string estimates(const Field& pilot) {
  Table table("\xCE\xBC = <i>a</i> exp(<i>b</i> \xCE\xB4), intervals over participants",
              {"Estimator", "<i>a</i> [CI], frames/s", "<i>b</i> [CI], s/frame"});
  for (const Field& e : pilot["estimators"].entries())
    estimate_row(table,
                 words(e["label"]) + ", level " + fixed(e["level"], 1) +
                     (e["main"].yes() ? " <strong>(for the solver)</strong>" : ""),
                 e);
  const bool listed = !pilot["estimators"].entries().empty();  // with the harmonic mean
  for (const char* mean : {"harmonic", "arithmetic"}) {
    if (listed && std::string(mean) == "harmonic") continue;
    for (const Field& e : pilot["means"][mean].entries())
      estimate_row(table,
                   "contour of means with the " + std::string(mean) + " mean, level " + fixed(e["level"], 1),
                   e);
  }
  return table.empty() ? "" : table.html();
}

std::string bands(const Field& pilot) {
  Table table("The curve \xCE\xBC(\xCE\xB4) with its bands, frames/s",
              {"\xCE\xB4", "\xCE\xBC", "CI at this \xCE\xB4", "band over all \xCE\xB4"});
  std::string level;
  for (const Field& point : pilot["bands"].entries()) {
    const std::string here = svg::number(point["level"].number(), 4);
    if (here != level) table.group("Level " + fixed(point["level"], 1));
    level = here;
    table.row({fixed(point["delta"], 0), fixed(point["mu"], 2), interval(point["ci"], 2),
               interval(point["simultaneous_ci"], 2)});
  }
  return table.empty() ? "" : table.html();
}

std::string cells(const Field& pilot) {
  Table table("Scores of the settings, over participants",
              {"Setting: mean, frames/s", "SD, frames/s", "Realised mean", "Realised SD", "<i>n</i>",
               "Mean score", "<i>SD</i>", "CI (<i>t</i>)"});
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
    // The points are the contour's: with other estimators beside it they are not what was fitted.
    if (level != pilot["level"].number() || !pilot["estimators"].entries().empty()) continue;
    for (const Field& point : e["contour"]["points_delta_mu"].entries())
      map.points.push_back({point[0].number(), point[1].number()});
  }
  map.a = pilot["a"].number();
  map.b = pilot["b"].number();
  map.a_ci = {pilot["a_ci"][0].number(), pilot["a_ci"][1].number()};
  map.b_ci = {pilot["b_ci"][0].number(), pilot["b_ci"][1].number()};
  map.confidence = pilot["interval"]["confidence"].number();
  map.cells_field = pilot.pointer() + "/cells";
  map.estimate_field = pilot.pointer();
  return heat_map(map);
}

std::string pilot_section(const Field& root) {
  const Field pilot = root["pilot"];
  if (pilot.json().is_null()) return "";
  if (!pilot.there() || pilot["status"].words() != "ok") {
    const std::string reason = pilot.there() ? pilot["reason"].words() : pilot.reason();
    return section("pilot", "Pilot: tolerance of frame rates",
                   "<p class=\"refused\">No fit: " + svg::escaped(reason) + ".</p>\n");
  }
  std::string body =
      paragraph(count(pilot["n_participants"]) + " participants gave " + count(pilot["n_ratings"]) +
                " ratings of " + count(pilot["n_settings"]) + " settings. " +
                (pilot["doubts"].entries().empty() ? "For the solver" : "Not for a solver") + ", at level " +
                fixed(pilot["level"], 1) + ": <i>a</i> = " + a_with_interval(pilot) +
                " frames/s, <i>b</i> = " + b_with_interval(pilot) + " s/frame.");
  for (const Field& flag : pilot["flags"].entries())
    body += "<p class=\"warning\">" + words(flag["text"]) + "</p>\n";
  if (!pilot["cells"].entries().empty() && pilot["a_ci"].entries().size() == 2)
    body +=
        figure(pilot_map(pilot),
               "Mean scores over the standard deviation and the mean of the frame rate, with contours and "
               "the fitted curve, as the paper's Fig.&nbsp;6.");
  body += estimates(pilot);
  if (pilot["lack_of_fit"].there())
    body += paragraph("Shape of the scores: " + words(pilot["lack_of_fit"]["text"]) + ".");
  body += bands(pilot);
  const Field resampling = pilot["bootstrap"].there() ? pilot["bootstrap"] : pilot["interval"];
  body += paragraph(words(pilot["estimator"]) + ". " + words(pilot["interval"]["method"]) +
                    " (bootstrap: " + count(resampling["resamples"]) + " resamples, seed " +
                    count(resampling["seed"]) + "). " + words(pilot["means"]["note"]));
  return section("pilot", "Pilot: tolerance of frame rates", body + cells(pilot));
}

}  // namespace apps::report
