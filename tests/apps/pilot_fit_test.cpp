#include "libstudy/analysis/ptpe/pilot_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <functional>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/ptpe/contour_lines.hpp"
#include "libstudy/analysis/ptpe/heat_map.hpp"
#include "libstudy/analysis/ptpe/pilot_people_json.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace {

using study::TaskKind;
using study::TaskSelection;
using ordered_json = base::Json;
using study::TaskProtocol;
using study::TaskTrial;
using study::Verdict;
using testing_pilot::simulated_pilot;

stats::Result<study::TaskData> select(const TaskProtocol& pilot,
                                      const TaskSelection& selection = {TaskKind::Pilot, {}, {}}) {
  return study::select_task({{pilot}, 0}, selection);
}

study::PilotFit fit_of(const TaskProtocol& pilot, double level = 4) {
  return study::fit_pilot(*study::collect_task({{pilot}, 0}, {TaskKind::Pilot, {}, {}}), level,
                          {200, 1, 0.95});
}

TaskSelection with_timing(stats::TimingRule rule) {
  TaskSelection out{TaskKind::Pilot, {}, {}};
  out.plan.exclusions.timing = rule;
  return out;
}

/// How often each rule excluded a trial or a visit.
std::map<std::string, int> rules_of(const study::TaskData& data) {
  std::map<std::string, int> out;
  for (const auto& one : data.exclusions) ++out[one.rule];
  return out;
}

using Rules = std::map<std::string, int>;

bool has_flag(const study::PilotFit& fit, const std::string& code) {
  return std::any_of(fit.flags.begin(), fit.flags.end(), [&](const auto& flag) { return flag.code == code; });
}

TEST(PilotFit, WritesEveryPromisedField) {
  const auto fit = fit_of(simulated_pilot("ptpe:a=24,b=0.02", 16, 7));
  ASSERT_TRUE(fit.ok()) << fit.reason;
  const auto json = study::fit_json(fit);
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("converged"), true);
  EXPECT_EQ(json.at("n_participants"), 16);
  EXPECT_EQ(json.at("n_ratings"), 16 * 21);
  EXPECT_EQ(json.at("n_settings"), 21);
  EXPECT_LT(json.at("a_ci")[0], json.at("a"));
  EXPECT_GT(json.at("b_ci")[1], json.at("b"));
  EXPECT_TRUE(json.at("level5").at("a").is_number());
  EXPECT_EQ(json.at("means").at("arithmetic").size(), 2u);
  EXPECT_EQ(json.at("protocol").at("sha256"), std::string(64, '3'));
  EXPECT_TRUE(has_flag(fit, "simulated"));
  const auto file = sim::parse_ptpe_file(sim::format_ptpe_file(study::ptpe_file(fit)), "ptpe.toml");
  EXPECT_EQ(file.model.a, fit.main().fit->a);
  EXPECT_EQ(file.b_ci, fit.main().spread->b_ci);
  EXPECT_EQ(file.n_simulated, 16);
  ASSERT_EQ(file.band.size(), 5u);
  const auto& last = json.at("bands").at(20);  // level 4 at delta = 20
  EXPECT_EQ(last.at("delta"), 20);
  EXPECT_EQ(last.at("solver_ci"), ordered_json(file.band[4].mu));
  EXPECT_LT(last.at("solver_ci")[0], last.at("solver_mu"));
}

// At a = 18, b = 0.01 the curve lies below the frame rates shown at large deviations.
TEST(PilotFit, WidthIsJudgedWhereTheCurveIsInReach) {
  const auto fit = fit_of(simulated_pilot("ptpe:a=18,b=0.01", 16, 3));
  const auto& direct = fit.chosen().direct;
  ASSERT_FALSE(direct.out_of_reach.empty());
  EXPECT_LT(fit.relative_half_width(), direct.jackknife->largest_relative_half_width(fit.deltas));
  double widest = 0;
  for (const double delta : fit.deltas) {
    if (std::count(direct.out_of_reach.begin(), direct.out_of_reach.end(), delta) > 0) continue;
    const auto point = direct.jackknife->band(delta);
    widest = std::max(widest, (point.pointwise[1] - point.pointwise[0]) / 2 / point.mu);
  }
  EXPECT_EQ(fit.relative_half_width(), widest);
}

TEST(PilotFit, TheFileSaysWhereTheCurveIsExtrapolated) {
  const auto fit = fit_of(simulated_pilot("ptpe:a=18,b=0.01", 16, 3));
  const auto& away = fit.chosen().direct.out_of_reach;
  ASSERT_FALSE(away.empty());
  for (const auto& point : study::ptpe_file(fit).band)
    EXPECT_EQ(point.in_reach, std::count(away.begin(), away.end(), point.delta) == 0) << point.delta;
}

TEST(PilotFit, ACurveWithoutABandIsNotForASolver) {
  auto fit = fit_of(simulated_pilot("ptpe:a=24,b=0.02", 16, 7));
  EXPECT_EQ(study::ptpe_file(fit).band.size(), 5u);
  fit.harmonic.at(4).band = stats::Refusal{"the participants agree"};
  EXPECT_TRUE(study::ptpe_file(fit).band.empty());
  EXPECT_TRUE(study::fit_json(fit).at("bands").at(0).at("solver_ci").is_null());
}

TEST(PilotFit, AContourWithoutAnIntervalIsFlagged) {
  // With few people a contour at the edge of the settings often has no interval. The test uses the first such
  // pilot among 40.
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto fit = fit_of(simulated_pilot("ptpe:a=15,b=0.015", 8, seed));
    if (!fit.ok()) continue;
    const auto& direct = *fit.chosen().direct.jackknife;
    EXPECT_EQ(has_flag(fit, "contour_without_interval"), !fit.chosen().contour.spread) << seed;
    if (fit.chosen().contour.spread) continue;
    EXPECT_EQ(fit.main().spread->a_ci, direct.a_ci);
    EXPECT_EQ(fit.main().spread->b_ci, direct.b_ci);
    return;
  }
  FAIL() << "no pilot without a contour";
}

TEST(PilotFit, SelectsByVerdictAndCountsWhatItLeavesOut) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  auto& trials = pilot.sessions[0].trials;
  trials[0].first.verdict = Verdict::Fail;
  trials[1].first.verdict = Verdict::Degraded;
  trials[2].answers[0].score.reset();
  trials[3].kind = "practice";
  trials[4].first.realised = {};
  const std::size_t all = 6 * 21;
  const auto usual = *select(pilot);
  EXPECT_EQ(usual.ratings.size(), all - 4);
  EXPECT_EQ(rules_of(usual), (Rules{{"timing", 2}}));
  EXPECT_EQ(usual.exclusions[1].reason, "no frame of the showing is recorded");
  EXPECT_EQ(usual.flow.practice, 1);
  EXPECT_EQ(usual.flow.trials_planned - usual.flow.trials_answered, 1);
  EXPECT_EQ(select(pilot, with_timing(stats::TimingRule::None))->ratings.size(), all - 3);
  EXPECT_EQ(select(pilot, with_timing(stats::TimingRule::Degraded))->ratings.size(), all - 5);
  const auto json = study::fit_json(fit_of(pilot));
  EXPECT_EQ(json.at("used").at("by_verdict"), (ordered_json{{"degraded", 1}, {"pass", all - 5}}));
  EXPECT_EQ(json.at("excluded").at("answers_by_rule"), (ordered_json{{"timing", 2}}));
}

TEST(PilotFit, LeavesOutRepeatsAndWhatTheExperimenterExcluded) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 2, 3);
  pilot.sessions[0].trials[0].kind = "repeat";
  pilot.sessions[0].trials[1].excluded = "the phone rang";
  const auto data = *select(pilot);
  EXPECT_EQ(data.ratings.size(), 2 * 21u - 2);
  EXPECT_EQ(data.flow.repeat, 1);
  ASSERT_EQ(data.exclusions.size(), 1u);
  EXPECT_EQ(data.exclusions[0].reason, "the phone rang");
}

// The rules that exclude people from the tasks apply to the pilot too, to each person separately.
TEST(PilotFit, ObeysThePlansRulesOfExclusion) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 8, 3);
  for (auto& trial : pilot.sessions[0].trials) trial.answers[0].score = 4;
  pilot.sessions[1].catches = {{"attention", 2, 5}};
  auto repeat = pilot.sessions[2].trials[0];
  repeat.kind = "repeat";
  repeat.position = 21;
  repeat.repeats = 0;
  repeat.answers[0].score = *repeat.answers[0].score > 4 ? 1 : 7;
  pilot.sessions[2].trials.push_back(repeat);
  for (int i = 3; i < 21; ++i) pilot.sessions[3].trials[static_cast<std::size_t>(i)].answers[0].score.reset();
  auto selection = with_timing(stats::TimingRule::Fail);
  selection.plan.exclusions.straight_lining_answers = 8;
  selection.plan.exclusions.max_repeat_difference = 2;
  selection.plan.exclusions.min_answered = 0.5;
  const auto data = *select(pilot, selection);
  EXPECT_EQ(rules_of(data), (Rules{{"straight_lining", 1}, {"catch", 1}, {"repeat", 1}, {"incomplete", 1}}));
  EXPECT_EQ(data.flow.analysed, 4);
  EXPECT_EQ(data.flow.excluded_participants, 4);
  EXPECT_EQ(data.ratings.size(), 4 * 21u);
  selection.plan.exclusions = {stats::TimingRule::None, {}, {}, {}, 0, 0};
  EXPECT_EQ(select(pilot, selection)->flow.analysed, 8);
}

TEST(PilotFit, NeverPoolsQuestions) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 2, 3);
  pilot.questions.push_back(pilot.questions[0]);
  pilot.questions[1].id = "realism";
  pilot.sessions[0].trials[0].answers[0].question = "realism";
  EXPECT_NE(select(pilot).reason().find("several questions are never pooled"), std::string::npos);
  EXPECT_EQ(select(pilot, {TaskKind::Pilot, {}, {}, "satisfaction"})->ratings.size(), 2 * 21u - 1);
  EXPECT_NE(select(pilot, {TaskKind::Pilot, {}, {}, "speed"}).reason().find("'speed'"), std::string::npos);
}

TEST(PilotFit, NeverPoolsTestDataOrProtocols) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 4, 3);
  for (auto& session : pilot.sessions) session.test_data = true;
  EXPECT_TRUE(select(pilot)->test_data);
  pilot.sessions[0].test_data = false;
  const auto real = *select(pilot);
  EXPECT_FALSE(real.test_data);
  EXPECT_EQ(real.ratings.size(), 21u);
  EXPECT_EQ(real.flow.test_left_out, 3);
  auto other = pilot;
  other.sha256 = std::string(64, '2');
  const study::TaskStudy both{{pilot, other}, 0};
  const auto from_both = [&](const std::string& sha256) {
    return study::select_task(both, {TaskKind::Pilot, sha256, {}});
  };
  EXPECT_NE(from_both("").reason().find("several protocols"), std::string::npos);
  EXPECT_EQ(from_both("2")->ratings.size(), 21u);
  EXPECT_FALSE(from_both("9"));
  EXPECT_FALSE(study::select_task({}, {TaskKind::Pilot, "", {}}));
}

TEST(PilotFit, NeverPoolsObserverModelsWithPeople) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  EXPECT_EQ(select(pilot)->simulated.size(), 6u);
  for (std::size_t i : {0u, 1u}) pilot.sessions[i].observer.clear();
  const auto people = *select(pilot);
  EXPECT_TRUE(people.simulated.empty());
  EXPECT_EQ(people.flow.simulated_left_out, 4);
  EXPECT_EQ(people.ratings.size(), 2u * 21);
  EXPECT_TRUE(has_flag(study::fit_pilot(people, 4, {200, 1, 0.95}), "simulated_left_out"));
  // If people's data are all test data, they do not exclude the simulated participants.
  for (auto& session : pilot.sessions) session.test_data = session.observer.empty();
  EXPECT_EQ(select(pilot)->simulated.size(), 4u);
}

// n, mean, standard deviation and t interval of one setting are computed by hand.
TEST(PilotFit, DescribesEachSettingOverItsParticipants) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 5, 3);
  const std::vector<int> scores{2, 3, 3, 5, 7};
  for (std::size_t i = 0; i < 5; ++i) pilot.sessions[i].trials[8].answers[0].score = scores[i];
  pilot.sessions[4].trials[8].excluded = "looked away";
  const auto cell = study::fit_json(fit_of(pilot)).at("cells").at(8);
  EXPECT_EQ(cell.at("n"), 4);
  EXPECT_NEAR(cell.at("score").get<double>(), 3.25, 1e-12);
  const double sd = std::sqrt((1.5625 + 2 * 0.0625 + 3.0625) / 3), t975_of_3 = 3.182446305284263;
  EXPECT_NEAR(cell.at("sd").get<double>(), sd, 1e-12);
  EXPECT_NEAR(cell.at("ci")[0].get<double>(), 3.25 - t975_of_3 * sd / 2, 1e-9);
  EXPECT_NEAR(cell.at("ci")[1].get<double>(), 3.25 + t975_of_3 * sd / 2, 1e-9);
}

TEST(PilotFit, FlagsAContourThatLeavesTheGrid) {
  const auto fit = fit_of(simulated_pilot("ptpe:a=31,b=0.035", 16, 7));
  ASSERT_TRUE(fit.ok()) << fit.reason;
  EXPECT_TRUE(has_flag(fit, "leaves_grid_above"));
  EXPECT_FALSE(has_flag(fit, "leaves_grid_below"));
  EXPECT_NEAR(fit.main().fit->a, 31, 6);
}

TEST(PilotFit, NamesTheReasonWhenThereIsNoFit) {
  const auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 6, 3);
  const auto rated = [&](auto score) {
    auto out = pilot;
    for (auto& session : out.sessions)
      for (auto& trial : session.trials) trial.answers[0].score = score(trial);
    return out;
  };
  auto alone = pilot;
  alone.sessions.resize(1);
  const std::vector<std::pair<TaskProtocol, std::string>> cases{
      {rated([](const TaskTrial&) { return 4; }), "all ratings are equal"},
      {rated([](const TaskTrial&) { return std::optional<int>(); }), "no answered trial"},
      {alone, "at least 4"},
      {rated([](const TaskTrial& trial) { return trial.first.nominal.mean > 25 ? 7 : 6; }), "no contour"}};
  for (const auto& [data, words] : cases) {
    const auto fit = fit_of(data);
    EXPECT_NE(fit.reason.find(words), std::string::npos) << fit.reason;
    const auto json = study::fit_json(fit);
    EXPECT_EQ(json.at("status"), "failed");
    EXPECT_TRUE(json.at("a_ci").is_null());
  }
  EXPECT_NE(fit_of(pilot, 9).reason.find("between the ends of the scale"), std::string::npos);
}

TEST(PilotFit, KeepsNoNumberThatIsNone) {
  // A NaN would be written as null, so no null is allowed where the status is ok.
  const auto json = study::fit_json(fit_of(simulated_pilot("ptpe:a=24,b=0.02", 16, 7)));
  const std::function<void(const ordered_json&, const std::string&)> check = [&](const ordered_json& value,
                                                                                 const std::string& place) {
    const bool failed_part =
        place.find("/level5") != std::string::npos || place.find("/means") != std::string::npos;
    EXPECT_FALSE(value.is_null() && !failed_part) << place;
    if (value.is_object())
      for (const auto& [key, inner] : value.items()) check(inner, place + "/" + key);
    else if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) check(value[i], place + "/" + std::to_string(i));
  };
  check(json, "");
}

TEST(PilotFit, ToleratesIncompleteParticipants) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 16, 7);
  pilot.sessions[3].trials.resize(5);
  const auto fit = fit_of(pilot);
  EXPECT_TRUE(fit.ok()) << fit.reason;
  EXPECT_TRUE(has_flag(fit, "incomplete_participants"));
}

// Some people reverse the scale, get tired, or press the lowest key. The fit reports this and corrects it by
// the plan's rules.
TEST(PilotFit, ReportsHowPeopleUsedTheScaleAndFollowsThePlan) {
  auto pilot = simulated_pilot("ptpe:a=24,b=0.02", 16, 7);
  for (auto& session : pilot.sessions)
    std::rotate(session.trials.begin(), session.trials.begin() + (&session - pilot.sessions.data()),
                session.trials.end());
  int n = 0;
  for (auto& session : pilot.sessions) {
    int position = 0;
    for (auto& trial : session.trials) {
      trial.position = position++;
      auto& score = trial.answers[0].score;
      if (session.participant == "p3") score = 8 - *score;
      if (++n % 12 == 0) score = 1;
    }
  }
  const auto fit_with = [&](const stats::PilotRules& rules) {
    return study::fit_pilot(*study::collect_task({{pilot}, 0}, {TaskKind::Pilot, {}, {}}), 4, {200, 1, 0.95},
                            rules);
  };
  const auto kept = fit_with({});
  EXPECT_TRUE(has_flag(kept, "reverse_coders"));
  EXPECT_TRUE(has_flag(kept, "lapses"));
  auto raters = study::fit_json(kept).at("raters");
  EXPECT_EQ(raters.at("reverse_coders").at("found"), 1);
  EXPECT_THAT(raters.at("reverse_coders").at("text").get<std::string>(),
              testing::StartsWith("1 of 16 participants rated higher frame rates lower"));
  EXPECT_THAT(study::reverse_coders(kept), testing::ElementsAre(testing::StartsWith("p3 (")));
  EXPECT_EQ(study::fit_json(kept).dump().find("p3"), std::string::npos) << "a fit names no one";
  EXPECT_EQ(raters.at("reverse_coders").at("rule"), "keep");
  EXPECT_TRUE(raters.at("drift").at("p").is_number());
  EXPECT_EQ(raters.at("lapses").at("found"), true);
  EXPECT_EQ(kept.participants, 16);
  const auto followed = fit_with({true, true, true});
  raters = study::fit_json(followed).at("raters");
  EXPECT_EQ(raters.at("reverse_coders").at("rule"), "exclude");
  EXPECT_EQ(raters.at("lapses").at("rule"), "model");
  EXPECT_EQ(followed.participants, 15);
  EXPECT_LT(followed.main().fit->a, kept.main().fit->a - 0.5);
}

TEST(ContourPolylines, FollowTheLevelWithoutGaps) {
  // score = mu + delta on the unit spacing: the contour at 3.2 is one straight line.
  stats::ScoreGrid grid{{0, 1, 2, 3}, {0, 1, 2, 3}, {}};
  for (const double mu : grid.mu) {
    for (const double delta : grid.delta) grid.nodes.push_back(stats::GridNode{mu + delta, mu, delta});
  }
  const auto lines = study::contour_polylines(grid, 3.2);
  ASSERT_EQ(lines.size(), 1u);
  for (const auto& point : lines[0]) EXPECT_NEAR(point.mu + point.delta, 3.2, 1e-12);
  EXPECT_NEAR(std::abs(lines[0].front().delta - lines[0].back().delta), 2.8, 1e-12);
  // A missing node removes the four cells around it.
  grid.nodes[5].reset();
  for (const auto& line : study::contour_polylines(grid, 3.2)) {
    for (const auto& point : line) EXPECT_TRUE(point.mu >= 2 - 1e-12 || point.delta >= 2 - 1e-12);
  }
  // A peak gives a closed line.
  stats::ScoreGrid peak{{0, 1, 2}, {0, 1, 2}, {}};
  for (int i = 0; i < 9; ++i) {
    peak.nodes.push_back(stats::GridNode{i == 4 ? 1.0 : 0.0, peak.mu[i / 3], peak.delta[i % 3]});
  }
  const auto loop = study::contour_polylines(peak, 0.5);
  ASSERT_EQ(loop.size(), 1u);
  EXPECT_EQ(loop[0].front().mu, loop[0].back().mu);
}

TEST(HeatMap, ShowsEveryCellBothContoursAndTheCurve) {
  const auto fit = fit_of(simulated_pilot("ptpe:a=24,b=0.02", 16, 7));
  const auto svg = study::heat_map_svg(fit);
  EXPECT_NO_THROW(html_reader::read(svg)) << "every element is closed in order, every attribute quoted";
  for (const auto& node : fit.grid.nodes) {
    if (!node) continue;
    char value[32];
    std::snprintf(value, sizeof value, ">%.2f</text>", node->score);
    EXPECT_NE(svg.find(value), std::string::npos) << value;
  }
  for (const char* words :
       {"contour at 4.0", "contour at 5.0", ">b \xCE\xB4</tspan>", "mean frame rate", "(simulated)"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("href"), std::string::npos);
}

}  // namespace
