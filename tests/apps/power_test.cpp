/// vip-stats power: the simulation against closed forms, its error rates, and requests that it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "libstudy/power/power_figure.hpp"
#include "libstudy/power/power_json.hpp"
#include "libstudy/power/shown.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/inference/power.hpp"
#include "tests/apps/process.hpp"

namespace {

using study::Json;
using study::PowerRequest;

/// In all but 1 of 16,000 cases a simulated share lies within this many standard errors of the truth.
constexpr double errors_allowed = 4;

PowerRequest request_for(const std::string& protocol, std::vector<int> n, int studies) {
  PowerRequest request;
  request.file = protocol;
  request.protocol = study::read_protocol(base::resource(protocol));
  request.n = std::move(n);
  request.studies = studies;
  return request;
}

PowerRequest task1(std::vector<std::string> worlds, int studies) {
  auto request = request_for("protocols/task1.toml", {26}, studies);
  request.worlds = std::move(worlds);
  request.answers = study::AnswerScale::Continuous;
  return request;
}

PowerRequest task2(std::vector<std::string> worlds, int studies) {
  auto request = request_for("protocols/task2.toml", {26}, studies);
  request.worlds = std::move(worlds);
  return request;
}

/// Compares every test's uncorrected power with its formula.
void expect_closed_forms(const std::vector<study::WorldPower>& worlds, double discreteness = 0) {
  int compared = 0;
  for (const auto& world : worlds) {
    for (const auto& hypothesis : world.hypotheses) {
      for (const auto& test : hypothesis.tests) {
        for (const auto& point : test.curve) {
          ASSERT_TRUE(point.closed_form) << world.id << ", " << test.label;
          EXPECT_NEAR(point.uncorrected.value, *point.closed_form,
                      errors_allowed * point.uncorrected.se + discreteness)
              << world.id << ", " << hypothesis.id << ", " << test.label;
          EXPECT_LE(point.holds.value, point.uncorrected.value) << test.label;
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 0);
}

TEST(PowerParticipants, RangesAndWhatIsNone) {
  EXPECT_EQ(study::parse_participants("26"), std::vector<int>{26});
  EXPECT_EQ(study::parse_participants("10:60").size(), 51u);
  EXPECT_EQ(study::parse_participants("10:21:5"), (std::vector{10, 15, 20}));
  for (const char* bad : {"", "x", "10:", ":10", "60:10", "10:60:0", "10:60:-1", "1:60", "10:2001",
                          "10:20:1:1", "10-60", "99999999999", "26 "})
    EXPECT_THROW(study::parse_participants(bad), base::Error) << bad;
}

TEST(Power, PreferenceOf70PercentWith26People) {
  auto request = task2({"effect"}, 2000);
  request.effect = 0.7;
  const auto worlds = study::simulate_task_power(request);
  expect_closed_forms(worlds);
  const auto& h4 = worlds[0].hypotheses[0];
  EXPECT_EQ(h4.id, "H4");
  EXPECT_NEAR(*h4.tests[0].curve[0].closed_form, 0.46, 0.005);
  EXPECT_EQ(h4.claims_true, 1);
  EXPECT_EQ(h4.curve[0].supported.value, h4.tests[0].curve[0].uncorrected.value) << "a family of one";
  EXPECT_NEAR(h4.tests[0].curve[0].mean_estimate, 0.7, 0.01);
}

TEST(Power, EquivalenceWithinHalfAPointWith26People) {
  auto request = task1({"null"}, 800);
  request.plan.plan.directional = stats::Directional::All;
  const auto worlds = study::simulate_task_power(request);
  expect_closed_forms(worlds);
  const auto& h2 = worlds[0].hypotheses[1];
  EXPECT_EQ(h2.id, "H2");
  EXPECT_EQ(h2.tests.size(), 8u);
  EXPECT_NEAR(*h2.tests[0].curve[0].closed_form, 0.22, 0.005);
}

// Equivalence is tested as strictly as a two-sided test: each of its two one-sided tests uses half of alpha.
TEST(Power, EquivalenceIsAsStrictAsTheOtherClaims) {
  const auto worlds = study::simulate_task_power(task1({"null"}, 800));
  expect_closed_forms(worlds);
  const auto& test = worlds[0].hypotheses[1].tests[0];
  const auto expected = stats::tost_power(26, {-0.5, 0.5, 1.3, 0, 0.025});
  EXPECT_NEAR(*test.curve[0].closed_form, *expected, 1e-12);
}

// Under the rule "intersection-union" a claim that needs all of its tests is not corrected and gains power.
// The number of single significant tests is still counted after Holm.
TEST(Power, SupportIsJudgedByThePlansRule) {
  auto request = task2({"effect"}, 400);
  request.effect = 0.75;
  const auto both = study::simulate_task_power(request)[0].hypotheses[1].curve[0];
  request.plan.plan.decision = stats::DecisionRule::Holm;
  const auto corrected = study::simulate_task_power(request)[0].hypotheses[1].curve[0];
  EXPECT_GT(both.supported.value, corrected.supported.value);
  EXPECT_EQ(both.any.value, corrected.any.value);
}

// For complete answers the mixed model gives nearly the results of the paired tests.
TEST(Power, TheMixedModelDecidesWhereThePlanSaysSo) {
  auto request = task1({"effect"}, 60);
  request.effect = 0.8;
  request.plan.plan.tests = stats::ScoreTests::Mixed;
  const auto mixed = study::simulate_task_power(request);
  request.plan.plan.tests = stats::ScoreTests::Paired;
  const auto paired = study::simulate_task_power(request);
  int differ = 0;
  for (std::size_t h = 0; h < 3; ++h) {
    EXPECT_NE(mixed[0].hypotheses[h].rule.find("mixed model"), std::string::npos);
    for (std::size_t i = 0; i < mixed[0].hypotheses[h].tests.size(); ++i) {
      const auto &one = mixed[0].hypotheses[h].tests[i].curve[0],
                 &other = paired[0].hypotheses[h].tests[i].curve[0];
      EXPECT_EQ(one.refused.value, 0) << "every model was fitted";
      EXPECT_FALSE(one.closed_form);
      EXPECT_NEAR(one.uncorrected.value, other.uncorrected.value, 0.2);
      EXPECT_NEAR(one.mean_estimate, other.mean_estimate, 0.1);
      differ += one.uncorrected.value != other.uncorrected.value ? 1 : 0;
    }
  }
  EXPECT_GT(differ, 0);
}

// Simulated trials have, as in a study's data, their position in the plan, and a new period whenever the
// scene or n_* changes.
TEST(Power, TrialsHaveThePeriodsOfThePlan) {
  const auto request = task1({"effect"}, 1);
  const study::ShownFactors factors(request.protocol.design);
  const auto trials = study::planned_trials(request.protocol, 1, 2);
  std::set<int> periods;
  for (std::size_t i = 1; i < trials.size(); ++i) {
    periods.insert(trials[i].period);
    if (trials[i].participant != trials[i - 1].participant) {
      EXPECT_EQ(trials[i].period, 0);
      continue;
    }
    const auto &here = factors.cells[static_cast<std::size_t>(trials[i].first)],
               &before = factors.cells[static_cast<std::size_t>(trials[i - 1].first)];
    const bool another = here.scene != before.scene || here.n_star != before.n_star;
    EXPECT_EQ(trials[i].period, trials[i - 1].period + (another ? 1 : 0));
    EXPECT_EQ(trials[i].position, trials[i - 1].position + 1);
  }
  EXPECT_GT(periods.size(), 1u);
}

TEST(Power, DifferencesAndMarginsFollowTheFormulas) {
  auto request = task1({"effect", "margin"}, 400);
  request.effect = 0.6;
  expect_closed_forms(study::simulate_task_power(request));
}

TEST(Power, WholeScoresLieNearTheFormulas) {
  auto request = task1({"effect"}, 600);
  request.effect = 0.6;
  request.answers = study::AnswerScale::Likert;
  // Rounding to whole points and the ends of the scale change the power at 26 people by at most this.
  expect_closed_forms(study::simulate_task_power(request), 0.03);
}

TEST(Power, FalseClaimsHoldInNoMoreThanAlphaOfStudies) {
  auto first = task1({"null", "margin"}, 400);
  auto second = task2({"null"}, 1500);
  for (const auto* request : {&first, &second}) {
    for (const auto& world : study::simulate_task_power(*request)) {
      for (const auto& hypothesis : world.hypotheses) {
        const auto tests = static_cast<int>(hypothesis.tests.size());
        const auto& at = hypothesis.curve[0];
        if (hypothesis.claims_true == tests) continue;
        EXPECT_EQ(hypothesis.claims_true, 0) << world.id << ", " << hypothesis.id;
        EXPECT_LE(at.any_false.value, 0.05 + errors_allowed * at.any_false.se)
            << world.id << ", " << hypothesis.id;
        EXPECT_EQ(at.any.value, at.any_false.value);
        EXPECT_FALSE(hypothesis.n_for_power) << "a false claim has no power";
      }
    }
  }
}

TEST(Power, ThePapersRuleConfirmsComparabilityWhereItIsFalse) {
  const auto worlds = study::simulate_task_power(task2({"null"}, 1000));
  const auto& h6 = worlds[0].hypotheses[2];
  EXPECT_EQ(h6.id, "H6");
  EXPECT_GT(h6.curve[0].paper.value, 0.8) << "no significant difference is what no difference gives";
  EXPECT_LT(h6.curve[0].supported.value, 0.05);
}

TEST(Power, ThePapersWorldHasItsPreferences) {
  const auto worlds = study::simulate_task_power(task2({"paper"}, 200));
  const auto& h5 = worlds[0].hypotheses[1];
  EXPECT_DOUBLE_EQ(h5.tests[0].truth, 19.0 / 26);
  EXPECT_DOUBLE_EQ(h5.tests[1].truth, 21.0 / 26);
  EXPECT_EQ(h5.claims_true, 2);
  EXPECT_EQ(worlds[0].hypotheses[2].claims_true, 1) << "HiRes is preferred to Ours, not to Ours-TSp";
}

TEST(Power, EqualForAnyNumberOfThreadsAndAnyRange) {
  auto request = task2({"effect"}, 100);
  request.effect = 0.8;
  request.n = {20, 26};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = study::power_json(request, study::simulate_task_power(request));
  omp_set_num_threads(3);
  const auto three = study::power_json(request, study::simulate_task_power(request));
  omp_set_num_threads(threads);
  EXPECT_EQ(one.dump(), three.dump());
  auto alone = request;
  alone.n = {26};
  const auto larger = study::simulate_task_power(request), single = study::simulate_task_power(alone);
  EXPECT_EQ(larger[0].hypotheses[1].tests[0].curve[1].holds.value,
            single[0].hypotheses[1].tests[0].curve[0].holds.value);
  auto other = alone;
  other.seed = 2;
  EXPECT_NE(study::simulate_task_power(other)[0].hypotheses[1].tests[0].curve[0].mean_estimate,
            single[0].hypotheses[1].tests[0].curve[0].mean_estimate);
}

TEST(Power, BiasOfIntervalsCostsPower) {
  auto request = task2({"effect"}, 1000);
  request.effect = 0.8;
  const auto without = study::simulate_task_power(request)[0].hypotheses[0].tests[0].curve[0];
  request.interval_bias = 2;
  const auto with = study::simulate_task_power(request)[0].hypotheses[0].tests[0].curve[0];
  EXPECT_LT(with.holds.value, without.holds.value - 0.1);
  EXPECT_FALSE(with.closed_form);
  EXPECT_GT(with.mean_estimate, 0.5) << "interval order is balanced";
}

TEST(PowerPlan, IsTheProtocolsOwn) {
  const auto request = task1({"null"}, 2);
  const study::ShownFactors factors(request.protocol.design);
  const auto trials = study::planned_trials(request.protocol, 7, 24);
  ASSERT_EQ(trials.size(), 240u);
  std::vector<int> scene_by_n_star(6);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].participant, static_cast<int>(i / 10));
    const auto& place = factors.cells[static_cast<std::size_t>(trials[i].first)];
    ++scene_by_n_star[static_cast<std::size_t>(place.scene * 2 + place.n_star)];
  }
  for (const int count : scene_by_n_star) EXPECT_EQ(count, 40) << "quotas: 24 divides the 12 sequences";
}

TEST(PowerPlan, RandomAssignmentLosesPairs) {
  auto request = task1({"null"}, 50);
  request.protocol.design.assignment = study::Assignment::PaperRandom;
  const auto worlds = study::simulate_task_power(request);
  const auto& point = worlds[0].hypotheses[0].tests[0].curve[0];
  EXPECT_LT(point.participants_least, point.participants_most);
  EXPECT_LT(point.participants_most, 27);
  EXPECT_FALSE(point.closed_form);
}

TEST(PowerPilot, PrecisionGrowsWithPeople) {
  auto request = request_for("protocols/ptpe_pilot.toml", {8, 24}, 80);
  request.precision_a = 3;  // between the median half widths of 8 and of 24 people
  request.precision_b = 0.009;
  const auto power = study::simulate_pilot_power(request);
  ASSERT_EQ(power.curve.size(), 2u);
  ASSERT_TRUE(power.curve[0].a && power.curve[1].a && power.curve[1].b);
  const auto &few = *power.curve[0].a, &many = *power.curve[1].a;
  EXPECT_NEAR(few.half_width.value / many.half_width.value, std::sqrt(24 / 8.0) * 2.365 / 2.069, 0.5);
  EXPECT_NEAR(many.mean.value, 23.68, 1);
  EXPECT_GT(many.coverage.value, 0.85);
  EXPECT_GT(power.curve[1].interval.value, 0.95);
  EXPECT_GT(many.reached->value, few.reached->value);
  ASSERT_TRUE(power.n_for_a);
  EXPECT_EQ(*power.n_for_a, 24);
}

// The score at which the curve is taken is chosen as in fit-ptpe and report: the option's, else the plan's,
// else the protocol's.
TEST(PowerPilot, TheCurveIsAtTheLevelOfThePlanOrTheProtocol) {
  auto request = request_for("protocols/ptpe_pilot.toml", {8}, 20);
  EXPECT_EQ(study::rated_level(request), 4);
  request.plan.plan.levels["satisfaction"] = 5;
  EXPECT_EQ(study::rated_level(request), 5);
  request.level = 4.5;
  EXPECT_EQ(study::rated_level(request), 4.5);
  const auto power = study::simulate_pilot_power(request);
  ASSERT_TRUE(power.curve[0].a);
  EXPECT_NEAR(power.curve[0].a->mean.value, 23.68, 2) << "the observer's curve runs at the level fitted";
  request.level = 7;
  EXPECT_THROW(study::rated_level(request), base::Error);
  request.question = "satisfacton";
  EXPECT_THAT([&] { study::rated_question(request); },
              ::testing::ThrowsMessage<base::Error>(::testing::HasSubstr("the nearest is \"satisfaction\"")));
}

TEST(PowerTasks, ClaimsAboutMethodsThatAreNotShownHaveNoPower) {
  const auto showing = [](const std::set<std::string>& methods) {
    auto protocol = study::read_protocol(base::resource("protocols/task2.toml"));
    std::erase_if(protocol.design.cells,
                  [&](const study::Cell& cell) { return !methods.contains(cell.stimulus.method); });
    return protocol;
  };
  auto request = task2({"null"}, 20);
  request.protocol = showing({"Ours", "FovFluid", "Ours-TSp"});
  const auto worlds = study::simulate_task_power(request);
  for (const auto& hypothesis : worlds.at(0).hypotheses) {
    for (const auto& test : hypothesis.tests) {
      EXPECT_NE(test.a, "HiRes") << hypothesis.id;
      EXPECT_NE(test.b, "HiRes") << hypothesis.id;
    }
  }
  EXPECT_FALSE(worlds.at(0).hypotheses.empty());
  EXPECT_THAT(
      [&] {
        study::power_kind(showing({"LoRes", "HiRes"}));
      },
      ::testing::ThrowsMessage<base::Error>(::testing::HasSubstr("tests none of H1 to H6")));
}

TEST(PowerFiles, HoldTheSameFigures) {
  auto request = task2({"null", "paper"}, 50);
  request.n = {10, 20};
  const Json json = study::power_json(request, study::simulate_task_power(request));
  EXPECT_EQ(json.at("schema"), "vip-power/1");
  EXPECT_EQ(json.at("protocol").at("sha256"), request.protocol.sha256);
  const Json& point = json.at("worlds").at(1).at("hypotheses").at(1).at("curve").at(0);
  EXPECT_GT(point.at("supported_se").get<double>(), 0);
  const std::string line = "\"paper\",\"H5\",,true,10,supported," + point.at("supported").dump() + "," +
                           point.at("supported_se").dump() + "\n";
  EXPECT_NE(study::power_csv(json).find(line), std::string::npos) << line;
  const std::string picture = study::power_svg(json);
  for (const char* words : {"H4", "H5", "H6", ">null<", ">paper<"})
    EXPECT_NE(picture.find(words), std::string::npos) << words;
  EXPECT_EQ(picture.find("nan"), std::string::npos);
}

class PowerCommand : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  apps::test::Ended run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {VIP_BIN_DIR "/vip-stats", "power"});
    apps::test::Process process(arguments);
    return process.wait();
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("vip_power_" + std::to_string(::getpid()));
};

TEST_F(PowerCommand, WritesWhatItPrints) {
  const auto json = (folder_ / "p.json").string(), svg = (folder_ / "f.svg").string();
  const auto ended = run({"protocols/task2.toml", "--n", "20:26:3", "--effect", "0.7", "--studies", "200",
                          "--json", json, "--csv", (folder_ / "f.csv").string(), "--svg", svg});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("World \"effect\""), std::string::npos) << ended.out;
  const Json written = Json::parse(base::read_file(json, 1 << 24));
  EXPECT_EQ(written.at("kind"), "task2");
  EXPECT_EQ(written.at("settings").at("n"), Json({20, 23, 26}));
  EXPECT_TRUE(std::filesystem::exists(svg));
}

TEST_F(PowerCommand, RefusesWithAMendAndWritesNothing) {
  const auto json = (folder_ / "p.json").string();
  for (const std::string words :
       {"none.toml", "task2.toml --n 60:10", "task2.toml --effect 1.2", "task2.toml --world effect",
        "task2.toml --sd 1", "task1.toml --world effect", "task1.toml --sd 0.3",
        "task1.toml --person-by-method 0.95", "task2.toml --person-by-method 0.5",
        "task1.toml --earlier none.json", "task1.toml --precision-a 1", "ptpe_pilot.toml --effect 0.7",
        "ptpe_pilot.toml --observer frames"}) {
    auto arguments = base::split("protocols/" + words, ' ');
    arguments.insert(arguments.end(), {"--json", json, "--studies", "2"});
    const auto ended = run(arguments);
    EXPECT_EQ(ended.exit_code, 1) << words;
    EXPECT_NE(ended.err.find("mend:"), std::string::npos) << words << ": " << ended.err;
    EXPECT_FALSE(std::filesystem::exists(json)) << words;
  }
}

}  // namespace
