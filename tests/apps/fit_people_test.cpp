/// vip-stats fit-people: what it prints and writes of a pilot, whom it names, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "libsim/ptpe/ptpe_file.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/people_fit.hpp"
#include "tests/apps/pilot_database.hpp"
#include "tests/apps/process.hpp"

namespace {

using ::testing::HasSubstr;

/// A pilot of six people, of whom the sixth gives one answer to everything.
struct PeoplePilot {
  study::test::TemporaryFolder folder;
  std::filesystem::path database = folder / "pilot.db";

  PeoplePilot() {
    const auto usual = testing_pilot::simulated("ptpe:a=24,b=0.02");
    testing_pilot::write_database(database,
                                  [=](const study::Question& question, const study::Occasion& shown) {
                                    return shown.participant == "P6" ? 7 : usual(question, shown);
                                  });
  }
  apps::test::Ended fit(const std::string& options) const {
    return apps::test::run_shell(VIP_BIN_DIR "/vip-stats fit-people " + database.string() + " " + options);
  }
};
const PeoplePilot& people_pilot() {
  static const PeoplePilot made;
  return made;
}

TEST(FitPeople, WritesEachPersonsCurveAndTheFileOfOne) {
  const auto& pilot = people_pilot();
  const auto json_file = pilot.folder / "people.json", own = pilot.folder / "p2.toml";
  const auto ended = pilot.fit("--json " + json_file.string() + " --person P2 --out " + own.string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr("6 people, 126 ratings of 21 settings"));
  EXPECT_THAT(ended.out, HasSubstr("P6: all answers are equal"));
  const auto json = base::parse_json(base::read_file(json_file, 1 << 22));
  EXPECT_EQ(json.at("schema"), "vip-people-contours/1");
  ASSERT_EQ(json.at("participants").size(), 6u);
  const auto& second = json.at("participants").at(1);
  EXPECT_EQ(second.at("participant"), "P2");
  EXPECT_EQ(second.at("doubt"), "");
  EXPECT_EQ(json.at("participants").at(5).at("doubt"), "all answers are equal");
  // The solver reads the person's file as it reads that of all people.
  const auto file = sim::read_ptpe_file(own);
  EXPECT_DOUBLE_EQ(file.model.a, second.at("a").get<double>());
  EXPECT_DOUBLE_EQ(file.model.b, second.at("b").get<double>());
  EXPECT_EQ(file.n_participants, 1);
  EXPECT_EQ(file.level, 4);
  ASSERT_EQ(file.band.size(), 5u);
  EXPECT_NEAR(file.band[0].mu[0], second.at("a_ci").at(0).get<double>(), 1e-9);
  EXPECT_NEAR(std::log(file.model.a), std::log(24), 0.5);
  // A session keeps the curve, so that only the person's own session may have it.
  EXPECT_EQ(file.participant, "P2");
  const auto run = [&](const std::string& people) {
    return apps::test::run_shell(VIP_BIN_DIR
                                 "/vip-study run protocols/ptpe_pilot.toml --observer random --db " +
                                 (pilot.folder / "own.db").string() + " --ptpe " + own.string() + people);
  };
  const auto others = run(" --participant P2 --participant P3");
  EXPECT_EQ(others.exit_code, 1);
  EXPECT_THAT(others.out, HasSubstr("holds the curve of P2, and would stay in P3's session"));
  EXPECT_EQ(run(" --participant P2").exit_code, 0);
}

TEST(FitPeople, MarksCurvesThatLieElsewhereOrAreVague) {
  stats::PersonContour one;
  one.alone = stats::CurveMoments{};
  one.own_share = 0.9;
  one.log_mu_sd = 0.17;
  EXPECT_EQ(one.doubt(), "");
  one.out_of_reach = true;
  EXPECT_THAT(one.doubt(), HasSubstr("outside the frame rates shown at more than half of the deltas"));
  one.out_of_reach = false;
  one.log_mu_sd = 0.19;
  EXPECT_THAT(one.doubt(), HasSubstr("more than a factor of two"));
}

TEST(FitPeople, GivesNoFileOfAPersonWithoutAContour) {
  const auto& pilot = people_pilot();
  const auto own = pilot.folder / "no.toml";
  const auto equal = pilot.fit("--person P6 --out " + own.string());
  EXPECT_EQ(equal.exit_code, 1);
  EXPECT_THAT(equal.out, HasSubstr("all answers are equal"));
  EXPECT_THAT(equal.out, HasSubstr("vip-stats fit-ptpe with --out"));
  EXPECT_FALSE(std::filesystem::exists(own));
  EXPECT_THAT(pilot.fit("--person '' --out " + own.string()).out, HasSubstr("--person: is empty"));
}

TEST(FitPeopleSlow, RefusesWithRemedies) {
  const auto& pilot = people_pilot();
  const auto own = pilot.folder / "none.toml";
  const auto unknown = pilot.fit("--person P7 --out " + own.string());
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.out, HasSubstr("has no answer in this fit"));
  EXPECT_EQ(pilot.fit("--person P1").exit_code, 2);
  EXPECT_EQ(pilot.fit("--level 8").exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(own));
  const auto few = pilot.folder / "few.db";
  testing_pilot::write_database(few, testing_pilot::simulated("ptpe:a=24,b=0.02"), {"P1", "P2", "P3", "P4"});
  const auto four = apps::test::run_shell(VIP_BIN_DIR "/vip-stats fit-people " + few.string() + " --json " +
                                          (pilot.folder / "few.json").string());
  EXPECT_EQ(four.exit_code, 1);
  EXPECT_THAT(four.out, HasSubstr("people are pooled from 5 on, and 4 people have answers"));
  EXPECT_THAT(four.out, HasSubstr("vip-stats fit-ptpe"));
  EXPECT_FALSE(std::filesystem::exists(pilot.folder / "few.json"));
}

TEST(FitPeopleSlow, AWithdrawalDeletesTheFilesOfPeople) {
  study::test::TemporaryFolder folder;
  const auto database = folder / "pilot.db", json = folder / "people.json", own = folder / "p1.toml";
  testing_pilot::write_database(database, testing_pilot::simulated("ptpe:a=24,b=0.02"));
  const auto ended = apps::test::run_shell(VIP_BIN_DIR "/vip-stats fit-people " + database.string() +
                                           " --json " + json.string() + " --person P1 --out " + own.string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  EXPECT_TRUE(std::filesystem::exists(own));
  const auto gone =
      apps::test::run_shell(VIP_BIN_DIR "/vip-study withdraw P3 --yes --db " + database.string());
  EXPECT_EQ(gone.exit_code, 0) << gone.out;
  EXPECT_FALSE(std::filesystem::exists(json));
  EXPECT_FALSE(std::filesystem::exists(own));
}

}  // namespace
