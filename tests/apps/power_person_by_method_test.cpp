/// vip-stats power: the variance of person by method, which is common to the answers at all n_*.

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/power/answers.hpp"
#include "libstudy/power/shown.hpp"
#include "libstudy/power/task_power.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"

namespace {

using study::Json;

study::PowerRequest request_for(const std::string& world, int studies) {
  study::PowerRequest request;
  request.file = "protocols/task1.toml";
  request.protocol = study::read_protocol(base::resource(request.file));
  request.n = {26};
  request.studies = studies;
  request.worlds = {world};
  return request;
}

/// Correlation over people between method 0's lead over method 1 at one number of particles and the same lead
/// at the other number.
double correlation_between_n_stars(double person_by_method) {
  auto request = request_for("null", 1);
  request.answers = study::AnswerScale::Continuous;
  request.person_by_method = {person_by_method, 0};
  const study::ShownFactors factors(request.protocol.design);
  constexpr int people = 2000;
  const auto trials = study::planned_trials(request.protocol, 1, people);
  const auto worlds = study::make_worlds(request, factors);
  const auto answers =
      study::answer_task1(trials, factors, worlds.at(0).scenarios.at(0), study::task1_scatter(request), 5);
  std::vector<std::array<double, 2>> difference(people);  // by n_*: method 0 minus method 1
  for (const auto& one : answers.realism) {
    if (one.method < 2)
      difference[static_cast<std::size_t>(one.participant)][static_cast<std::size_t>(one.n_star)] +=
          one.method == 0 ? one.sum : -one.sum;
  }
  double xy = 0, xx = 0, yy = 0;
  for (const auto& [x, y] : difference) {
    xy += x * y;
    xx += x * x;
    yy += y * y;
  }
  EXPECT_NEAR(std::sqrt(xx / people), request.sd_realism, 0.1);
  return xy / std::sqrt(xx * yy);
}

TEST(PowerPersonByMethod, IsTheSameAtEveryNStarAndLeavesTheSpreadAsItWas) {
  EXPECT_NEAR(correlation_between_n_stars(0), 0, 0.09);
  EXPECT_NEAR(correlation_between_n_stars(0.5), 0.5, 0.08);
  EXPECT_NEAR(correlation_between_n_stars(1), 1, 1e-9);
}

/// Power of H1's claim, which needs eight tests, if a difference is half its standard deviation.
study::Estimated power_of_h1(study::PersonByMethod person_by_method, int studies) {
  auto request = request_for("effect", studies);
  request.effect = 0.5;
  request.person_by_method = person_by_method;
  const auto worlds = study::simulate_task_power(request);
  const auto& h1 = worlds.at(0).hypotheses.at(0);
  EXPECT_EQ(h1.id, "H1");
  for (const auto& test : h1.tests) {
    const auto& at = test.curve.at(0);
    EXPECT_NEAR(at.uncorrected.value, *at.closed_form, 4 * at.uncorrected.se + 0.03)
        << "a single test has the power that it had: " << test.label;
  }
  return h1.curve.at(0).supported;
}

TEST(PowerPersonByMethod, TestsThatHoldTogetherGiveTheirClaimMorePower) {
  const auto apart = power_of_h1({0, 0}, 500), together = power_of_h1({0.75, 0.75}, 500);
  EXPECT_GT(together.value, apart.value + 2 * (together.se + apart.se));
}

// docs/statistics.md gives these figures. Half of the scatter that comes neither from rounding nor from
// single items is .45 of the variance of realism and .25 of that of cybersickness.
TEST(PowerPersonByMethodSlow, RaisesThePowerOfH1) {
  EXPECT_NEAR(power_of_h1({0, 0}, 10000).value, 0.082, 0.012);
  EXPECT_NEAR(power_of_h1({0.45, 0.25}, 10000).value, 0.112, 0.013);
  EXPECT_NEAR(power_of_h1({0.5, 0.5}, 10000).value, 0.128, 0.014);
}

TEST(PowerPersonByMethod, TakesTheShareOfPersonByMethodFromAnEarlierStudy) {
  const std::string earlier = VIP_TEST_DIR "/apps/results_example.json";
  const auto folder =
      std::filesystem::temp_directory_path() / ("vip_by_method_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto json = (folder / "p.json").string();
  const std::vector<std::string> command{VIP_BIN_DIR "/vip-stats",
                                         "power",
                                         "protocols/task1.toml",
                                         "--n",
                                         "10",
                                         "--effect",
                                         "0.5",
                                         "--studies",
                                         "10",
                                         "--json",
                                         json,
                                         "--earlier"};
  auto arguments = command;
  arguments.push_back(earlier);
  const auto ended = apps::test::Process(arguments).wait();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const Json settings = Json::parse(base::read_file(json, 1 << 24)).at("settings");
  const Json before = Json::parse(base::read_file(earlier, 1 << 24));
  for (const auto& model : before.at("task1").at("mixed")) {
    const std::string score = model.at("score");
    if (score == "sickness_without_unrealism") continue;
    const double method = model.at("sd_method"), residual = model.at("sd_residual");
    EXPECT_NEAR(settings.at("person_by_method_" + score).get<double>(),
                method * method / (method * method + residual * residual), 1e-12);
  }
  EXPECT_NE(ended.out.find("share of person by method"), std::string::npos) << ended.out;
  std::filesystem::remove(json);

  Json results = Json::parse(base::read_file(earlier, 1 << 24));
  const auto refused = [&](const std::string& words) {
    const auto file = folder / "earlier.json";
    base::write_file_atomically(file, results.dump());
    arguments = command;
    arguments.push_back(file.string());
    const auto bad = apps::test::Process(arguments).wait();
    EXPECT_EQ(bad.exit_code, 1);
    EXPECT_NE(bad.err.find(words), std::string::npos) << bad.err;
    EXPECT_NE(bad.err.find("mend:"), std::string::npos) << bad.err;
    EXPECT_FALSE(std::filesystem::exists(json));
  };
  results["task1"]["mixed"][0]["sd_method"] = nullptr;
  refused("no participant judged one method twice");
  results["task1"]["mixed"][0] = {{"score", "realism"}, {"refused", "one participant"}};
  refused("one participant");
  results["task1"] = {{"refused", "no cybersickness items"}};
  refused("no mixed model of realism");
  results["schema"] = "vip-power/1";
  refused("is not the JSON of a study's results");
  std::filesystem::remove_all(folder);
}

}  // namespace
