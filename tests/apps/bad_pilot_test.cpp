/// Pilots that must not steer a solver: vip-stats fit-ptpe refuses each with its reason, and writes no file
/// for a solver. With --force it writes a file for some of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libsim/ptpe/ptpe_file.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/pilot_database.hpp"
#include "tests/apps/process.hpp"

namespace {

using study::test::TemporaryFolder;
using ::testing::HasSubstr;

const std::vector<std::string> sixteen{"P01", "P02", "P03", "P04", "P05", "P06", "P07", "P08",
                                       "P09", "P10", "P11", "P12", "P13", "P14", "P15", "P16"};

/// The expected score, before noise, of a setting whose frame rate has the mean mu and the SD delta,
/// frames/s.
using Surface = double (*)(double mu, double delta);

testing_pilot::Score scored(Surface surface, double noise) {
  return [surface, noise, engine = std::mt19937(5)](const study::Question&,
                                                    const study::Occasion& occasion) mutable {
    const auto& setting = occasion.shown.at(0).what.setting;
    const double x = surface(setting.mean, setting.sd) + noise * std::normal_distribution<double>()(engine);
    return static_cast<int>(std::clamp(std::round(x), 1.0, 7.0));
  };
}

/// Scores that follow the paper's curve.
double good(double mu, double delta) { return 4 + 0.14 * (mu - 23.68 * std::exp(0.02 * delta)); }

struct Bad {
  const char* kind;
  testing_pilot::Score score;
  std::vector<std::string> participants;
  const char* reason;
  bool forced;  ///< true if --force --accept-form writes a curve
};

std::vector<Bad> bad_pilots() {
  return {
      {"flat", scored([](double, double) { return 4.0; }, 0), sixteen, "all ratings are equal", false},
      {"random", scored([](double, double) { return 4.0; }, 2), sixteen, "no fit of ", false},
      {"reversed", scored([](double mu, double delta) { return 8 - good(mu, delta); }, 1), sixteen, "rise",
       false},
      {"U-shaped", scored([](double mu, double) { return 2 + std::abs(mu - 30) / 5; }, 1), sixteen,
       "the scores fall", true},
      {"identical people", scored(good, 0), sixteen, "the participants do not differ", true},
      {"b below zero",
       scored([](double mu, double delta) { return 4 + 0.14 * (mu - 30 * std::exp(-0.03 * delta)); }, 1),
       sixteen, "b is below zero", true},
      {"all above", scored([](double mu, double) { return 6 + mu / 50; }, 0.5), sixteen, "no contour", false},
      {"all below", scored([](double mu, double) { return 1 + mu / 50; }, 0.5), sixteen, "no contour", false},
      {"one person", scored(good, 1), {"P01"}, "at least 4", false},
  };
}

TEST(BadPilotE2e, EachOfNineKindsIsRefusedWithItsReasonAndOnlyTheJsonIsWritten) {
  for (const Bad& bad : bad_pilots()) {
    SCOPED_TRACE(bad.kind);
    const TemporaryFolder folder;
    testing_pilot::write_database(folder / "study.db", bad.score, bad.participants);
    const std::string fit = VIP_BIN_DIR "/vip-stats fit-ptpe " + (folder / "study.db").string() +
                            " --resamples 200 --out " + (folder / "ptpe.toml").string() + " --svg " +
                            (folder / "heat.svg").string() + " --json " + (folder / "fit.json").string();
    const auto refused = apps::test::run_shell(fit);
    EXPECT_EQ(refused.exit_code, 1) << refused.out;
    EXPECT_THAT(refused.out, HasSubstr("mend: "));
    EXPECT_THAT(refused.out, HasSubstr(bad.reason));
    EXPECT_THAT(refused.out, testing::Not(HasSubstr(" for the solver "))) << "as a name of an estimate";
    EXPECT_EQ(refused.out.find("not for a solver  ") != std::string::npos, bad.forced);
    for (const char* name : {"ptpe.toml", "ptpe.toml.history.jsonl", "heat.svg"})
      EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
    // The file of --json has the numbers, together with the reason for the refusal.
    const auto json = base::Json::parse(base::read_file(folder / "fit.json", 1 << 24));
    if (bad.forced) {
      EXPECT_FALSE(json.at("solver_file").at("refused").empty());
    }
    const std::string page = (folder / "report.html").string();
    EXPECT_EQ(apps::test::run_shell(VIP_BIN_DIR "/vip-stats report " + (folder / "study.db").string() +
                                    " --html " + page)
                  .exit_code,
              0);
    const std::string report = base::read_file(page, 1 << 24);
    EXPECT_THAT(report, testing::Not(HasSubstr("For the solver, at level")));
    EXPECT_EQ(report.find("Not for a solver, at level") != std::string::npos, bad.forced);
    // --accept-form is needed too: the test of the curve's form, which assumes scores that rise evenly in log
    // mu, may reject these scores, which rise evenly in mu.
    EXPECT_EQ(apps::test::run_shell(fit + " --force --accept-form").exit_code, bad.forced ? 0 : 1);
    EXPECT_EQ(std::filesystem::exists(folder / "ptpe.toml"), bad.forced);
  }
}

TEST(BadPilotE2e, NoNoteSaysWhatAFitUsesThatIsNotThere) {
  const TemporaryFolder folder;
  const auto printed = [&](const char* name, Surface surface, double noise) {
    testing_pilot::write_database(folder / name, scored(surface, noise), sixteen);
    return apps::test::run_shell(VIP_BIN_DIR "/vip-stats fit-ptpe " + (folder / name).string() +
                                 " --resamples 100")
        .out;
  };
  const auto below = printed(
      "below.db", [](double mu, double) { return 1 + mu / 50; }, 0.5);
  EXPECT_THAT(below, HasSubstr("note: on no line do the scores cross the level"));
  EXPECT_THAT(below, HasSubstr("the level is not reached up to the largest mean frame rate\n"));
  EXPECT_THAT(below, testing::Not(HasSubstr("the contour's curve goes by")));
  const auto equal = printed(
      "equal.db", [](double, double) { return 5.0; }, 0);
  EXPECT_THAT(equal, testing::ContainsRegex("direct +all ratings are equal\n"));
  EXPECT_THAT(equal, testing::Not(HasSubstr("the settings rated do not determine")));
}

TEST(BadPilotE2e, APilotThatRisesIsNotRefused) {
  const TemporaryFolder folder;
  testing_pilot::write_database(folder / "study.db", scored(good, 1), sixteen);
  const auto fitted =
      apps::test::run_shell(VIP_BIN_DIR "/vip-stats fit-ptpe " + (folder / "study.db").string() +
                            " --resamples 200 --out " + (folder / "ptpe.toml").string());
  EXPECT_EQ(fitted.exit_code, 0) << fitted.out;
  EXPECT_EQ(fitted.out.find("not for a solver"), std::string::npos) << fitted.out;
}

/// Scores whose threshold in mu levels off as delta grows.
double levelling(double mu, double delta) { return 4 + 0.14 * (mu - 24 - 14 * (1 - std::exp(-delta / 5))); }

TEST(BadPilotE2e, ACurveOfAnotherFormReachesNoSolverUnlessItIsAccepted) {
  const TemporaryFolder folder;
  testing_pilot::write_database(folder / "study.db", scored(levelling, 1), sixteen);
  const std::string fit = VIP_BIN_DIR "/vip-stats fit-ptpe " + (folder / "study.db").string() +
                          " --resamples 200 --out " + (folder / "ptpe.toml").string() + " --svg " +
                          (folder / "heat.svg").string() + " --json " + (folder / "fit.json").string();
  for (const std::string flags : {"", " --force"}) {
    const auto refused = apps::test::run_shell(fit + flags);
    EXPECT_EQ(refused.exit_code, 1) << refused.out;
    EXPECT_THAT(refused.out, HasSubstr("the threshold is no exponential"));
    EXPECT_THAT(refused.out, HasSubstr("the free curve at level 4: mu(0) = "));
    EXPECT_THAT(refused.out, HasSubstr("--accept-form"));
    EXPECT_FALSE(std::filesystem::exists(folder / "ptpe.toml"));
    EXPECT_FALSE(std::filesystem::exists(folder / "ptpe.toml.history.jsonl"));
  }
  const auto json = base::Json::parse(base::read_file(folder / "fit.json", 1 << 24));
  EXPECT_EQ(json.at("form").at("rejected"), true);
  EXPECT_LT(json.at("form").at("ci")[1], 0);
  EXPECT_GT(json.at("form").at("detectable"), 0);
  EXPECT_EQ(json.at("form").at("free_curve").size(), 21u);
  EXPECT_EQ(json.at("solver_file").at("refused")[0].at("code"), "form_rejected");

  const auto accepted = apps::test::run_shell(fit + " --accept-form");
  EXPECT_EQ(accepted.exit_code, 0) << accepted.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "ptpe.toml"));
  const auto record = base::Json::parse(base::read_file(folder / "ptpe.toml.history.jsonl", 1 << 24));
  EXPECT_EQ(record.at("form_rejected"), true);
  EXPECT_EQ(record.at("forced"), false);
  EXPECT_THAT(base::read_file(folder / "heat.svg", 1 << 24), HasSubstr("free curve"));

  const std::string page = (folder / "report.html").string();
  EXPECT_EQ(apps::test::run_shell(VIP_BIN_DIR "/vip-stats report " + (folder / "study.db").string() +
                                  " --html " + page)
                .exit_code,
            0);
  const std::string report = base::read_file(page, 1 << 24);
  EXPECT_THAT(report, HasSubstr("Not for a solver, at level"));
  EXPECT_THAT(report, HasSubstr("The free curve, which has one parameter more"));
}

}  // namespace
