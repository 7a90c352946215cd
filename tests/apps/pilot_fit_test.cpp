#include "apps/stats/pilot_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/stats/contour_lines.hpp"
#include "apps/stats/heat_map.hpp"
#include "apps/stats/pilot_data.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace {

using nlohmann::ordered_json;
using study::RatingRow;
using testing_pilot::simulated_pilot;

apps::PilotFit fit_rows(const std::vector<RatingRow>& rows, double level = 4,
                        const apps::PilotSelection& selection = {}) {
  return apps::fit_pilot(*apps::select_pilot(rows, selection), level, {200, 1, 0.95});
}

apps::PilotSelection choice(const std::string& protocol, apps::ExcludedVerdicts exclude) {
  return {protocol, "", exclude};
}

bool has_flag(const apps::PilotFit& fit, const std::string& code) {
  return std::any_of(fit.flags.begin(), fit.flags.end(), [&](const auto& flag) { return flag.code == code; });
}

TEST(PilotFit, WritesEveryPromisedField) {
  const auto fit = fit_rows(simulated_pilot("ptpe:a=24,b=0.02", 16, 7));
  ASSERT_TRUE(fit.ok()) << fit.reason;
  const auto json = apps::fit_json(fit);
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("converged"), true);
  EXPECT_EQ(json.at("n_participants"), 16);
  EXPECT_EQ(json.at("n_ratings"), 16 * 21);
  EXPECT_EQ(json.at("n_settings"), 21);
  EXPECT_LT(json.at("a_ci")[0], json.at("a"));
  EXPECT_GT(json.at("b_ci")[1], json.at("b"));
  EXPECT_TRUE(json.at("level5").at("a").is_number());
  EXPECT_EQ(json.at("means").at("arithmetic").size(), 2u);
  EXPECT_EQ(json.at("protocol").at("sha256"), std::string(64, '1'));
  EXPECT_TRUE(has_flag(fit, "simulated"));
  const auto file = sim::parse_ptpe_file(sim::format_ptpe_file(apps::ptpe_file(fit)), "ptpe.toml");
  EXPECT_EQ(file.model.a, fit.main().fit->a);
  EXPECT_EQ(file.b_ci, fit.main().spread->b_ci);
  EXPECT_EQ(file.n_simulated, 16);
}

TEST(PilotFit, SelectsByVerdictAndCountsWhatItLeavesOut) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  rows[0].timing->verdict = study::Verdict::Fail;
  rows[1].timing->verdict = study::Verdict::Degraded;
  rows[2].rating.reset();
  rows[3].practice = true;
  rows[4].timing.reset();
  const auto usual = *apps::select_pilot(rows, {});
  EXPECT_EQ(usual.ratings.size(), rows.size() - 4);
  EXPECT_EQ(usual.excluded_by_verdict.at("fail"), 1);
  EXPECT_EQ(usual.used_by_verdict.at("degraded"), 1);
  EXPECT_EQ(usual.unanswered, 1);
  EXPECT_EQ(usual.practice, 1);
  EXPECT_EQ(usual.without_timing, 1);
  EXPECT_EQ(apps::select_pilot(rows, choice("", apps::ExcludedVerdicts::None))->ratings.size(),
            rows.size() - 3);
  EXPECT_EQ(apps::select_pilot(rows, choice("", apps::ExcludedVerdicts::Degraded))->ratings.size(),
            rows.size() - 5);
}

TEST(PilotFit, LeavesOutRepeatsAndWhatTheExperimenterExcluded) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 2, 3);
  rows[0].repeat = true;
  rows[1].excluded = true;
  const auto data = *apps::select_pilot(rows, {});
  EXPECT_EQ(data.ratings.size(), rows.size() - 2);
  EXPECT_EQ(data.repeat, 1);
  EXPECT_EQ(data.excluded, 1);
}

TEST(PilotFit, NeverPoolsQuestions) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 2, 3);
  for (auto& row : rows) row.question = "satisfaction";
  rows[0].question = "realism";
  EXPECT_NE(apps::select_pilot(rows, {}).reason().find("--question"), std::string::npos);
  apps::PilotSelection selection;
  selection.question = "satisfaction";
  EXPECT_EQ(apps::select_pilot(rows, selection)->ratings.size(), rows.size() - 1);
  selection.question = "speed";
  EXPECT_NE(apps::select_pilot(rows, selection).reason().find("'speed'"), std::string::npos);
}

TEST(PilotFit, NeverPoolsTestDataOrProtocols) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 4, 3);
  for (auto& row : rows) row.test_data = true;
  EXPECT_TRUE(apps::select_pilot(rows, {})->test_data);
  rows[0].test_data = false;
  const auto real = *apps::select_pilot(rows, {});
  EXPECT_FALSE(real.test_data);
  EXPECT_EQ(real.ratings.size(), 1u);
  EXPECT_EQ(real.test_left_out, static_cast<int>(rows.size()) - 1);
  rows[1].protocol_sha256 = std::string(64, '2');
  EXPECT_NE(apps::select_pilot(rows, {}).reason().find("several protocols"), std::string::npos);
  EXPECT_EQ(apps::select_pilot(rows, choice("2", apps::ExcludedVerdicts::Fail))->ratings.size(), 1u);
  EXPECT_FALSE(apps::select_pilot(rows, choice("3", apps::ExcludedVerdicts::Fail)));
  EXPECT_FALSE(apps::select_pilot({}, {}));
}

TEST(PilotFit, NeverPoolsObserverModelsWithPeople) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  EXPECT_EQ(apps::select_pilot(rows, {})->simulated_participants, 6);
  for (auto& row : rows) {
    if (row.participant == "p0" || row.participant == "p1") row.observer.clear();
  }
  const auto people = *apps::select_pilot(rows, {});
  EXPECT_EQ(people.simulated_participants, 0);
  EXPECT_EQ(people.simulated_left_out, 4 * 21);
  EXPECT_EQ(people.ratings.size(), 2u * 21);
  EXPECT_TRUE(has_flag(apps::fit_pilot(people, 4, {200, 1, 0.95}), "simulated_left_out"));
  // People whose data are only test data do not push the others out.
  for (auto& row : rows) row.test_data = row.observer.empty();
  EXPECT_EQ(apps::select_pilot(rows, {})->simulated_participants, 4);
}

TEST(PilotFit, FlagsAContourThatLeavesTheGrid) {
  const auto fit = fit_rows(simulated_pilot("ptpe:a=31,b=0.035", 16, 7));
  ASSERT_TRUE(fit.ok()) << fit.reason;
  EXPECT_TRUE(has_flag(fit, "leaves_grid_above"));
  EXPECT_FALSE(has_flag(fit, "leaves_grid_below"));
  EXPECT_NEAR(fit.main().fit->a, 31, 6);
}

TEST(PilotFit, NamesTheReasonWhenThereIsNoFit) {
  const auto rows = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  auto equal = rows, unanswered = rows, alone = rows, satisfied = rows;
  for (auto& row : equal) row.rating = 4;
  for (auto& row : unanswered) row.rating.reset();
  std::erase_if(alone, [](const RatingRow& row) { return row.participant != "p0"; });
  for (auto& row : satisfied) row.rating = row.nominal.mean > 25 ? 7 : 6;
  const std::vector<std::pair<std::vector<RatingRow>, std::string>> cases{{equal, "all ratings are equal"},
                                                                          {unanswered, "no answered trial"},
                                                                          {alone, "at least 4"},
                                                                          {satisfied, "no contour"}};
  for (const auto& [data, words] : cases) {
    const auto fit = fit_rows(data);
    EXPECT_NE(fit.reason.find(words), std::string::npos) << fit.reason;
    const auto json = apps::fit_json(fit);
    EXPECT_EQ(json.at("status"), "failed");
    EXPECT_TRUE(json.at("a_ci").is_null());
  }
  EXPECT_NE(fit_rows(rows, 9).reason.find("rating scale"), std::string::npos);
}

TEST(PilotFit, KeepsNoNumberThatIsNone) {
  // A NaN would be written as null: no null may stand where the status says ok.
  const auto json = apps::fit_json(fit_rows(simulated_pilot("ptpe:a=24,b=0.02", 16, 7)));
  const auto flat = json.flatten();
  for (const auto& [key, ignored] : flat.items()) {
    static_cast<void>(ignored);
    const bool failed_part =
        key.find("/level5") != std::string::npos || key.find("/means") != std::string::npos;
    if (!failed_part) {
      EXPECT_FALSE(json.at(ordered_json::json_pointer(key)).is_null()) << key;
    }
  }
}

TEST(PilotFit, ToleratesIncompleteParticipants) {
  auto rows = simulated_pilot("ptpe:a=24,b=0.02", 16, 7);
  std::erase_if(rows, [](const RatingRow& row) { return row.participant == "p3" && row.position > 4; });
  const auto fit = fit_rows(rows);
  EXPECT_TRUE(fit.ok()) << fit.reason;
  EXPECT_TRUE(has_flag(fit, "incomplete_participants"));
}

TEST(ContourPolylines, FollowTheLevelWithoutGaps) {
  // score = mu + delta on the unit spacing: the contour at 3.2 is one straight line.
  stats::ScoreGrid grid{{0, 1, 2, 3}, {0, 1, 2, 3}, {}};
  for (const double mu : grid.mu) {
    for (const double delta : grid.delta) grid.nodes.push_back(stats::GridNode{mu + delta, mu, delta});
  }
  const auto lines = apps::contour_polylines(grid, 3.2);
  ASSERT_EQ(lines.size(), 1u);
  for (const auto& point : lines[0]) EXPECT_NEAR(point.mu + point.delta, 3.2, 1e-12);
  EXPECT_NEAR(std::abs(lines[0].front().delta - lines[0].back().delta), 2.8, 1e-12);
  // A missing node takes its four cells with it.
  grid.nodes[5].reset();
  for (const auto& line : apps::contour_polylines(grid, 3.2)) {
    for (const auto& point : line) EXPECT_TRUE(point.mu >= 2 - 1e-12 || point.delta >= 2 - 1e-12);
  }
  // A peak gives a closed line.
  stats::ScoreGrid peak{{0, 1, 2}, {0, 1, 2}, {}};
  for (int i = 0; i < 9; ++i) {
    peak.nodes.push_back(stats::GridNode{i == 4 ? 1.0 : 0.0, peak.mu[i / 3], peak.delta[i % 3]});
  }
  const auto loop = apps::contour_polylines(peak, 0.5);
  ASSERT_EQ(loop.size(), 1u);
  EXPECT_EQ(loop[0].front().mu, loop[0].back().mu);
}

/// Every element is closed in order and every attribute quoted; enough of XML for what the figure uses.
bool balanced(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const auto end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (std::count(tag.begin(), tag.end(), '"') % 2) return false;
    if (tag.front() == '?' || tag.back() == '/') continue;
    const std::string name =
        tag.substr(tag.front() == '/', tag.find_first_of(" \n", 1) - (tag.front() == '/'));
    if (tag.front() != '/') {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

TEST(HeatMap, ShowsEveryCellBothContoursAndTheCurve) {
  const auto fit = fit_rows(simulated_pilot("ptpe:a=24,b=0.02", 16, 7));
  const auto svg = apps::heat_map_svg(fit);
  EXPECT_TRUE(balanced(svg));
  for (const auto& node : fit.grid.nodes) {
    if (!node) continue;
    char value[32];
    std::snprintf(value, sizeof value, ">%.2f</text>", node->score);
    EXPECT_NE(svg.find(value), std::string::npos) << value;
  }
  for (const char* words :
       {"contour at 4.0", "contour at 5.0", "a exp(b", "mean frame rate", "(simulated)"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("href"), std::string::npos);
}

}  // namespace
