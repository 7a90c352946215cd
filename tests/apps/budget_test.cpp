/// vip-bench accuracy --budget: the setting with the least error within a budget.
#include "libstudy/sweep/run/budget.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

TEST(Budget, IsWrittenInMilliseconds) {
  EXPECT_DOUBLE_EQ(study::parse_budget("11.1ms"), 11.1);
  for (const char* words : {"", "ms", "11.1", "11.1 ms", "11.1s", "-1ms", "0ms", "nanms", "infms", "1e9ms"})
    EXPECT_THROW(study::parse_budget(words), base::Error) << words;
}

study::SettingResult result(double p95, double low, double error, double high) {
  study::SettingResult out;
  out.ms_mean = p95 - 1;
  out.ms_p95 = p95;
  out.errors[1] = {error, low, high};
  return out;
}

TEST(Budget, TheLeastErrorComesFirstAndTiesGoToTheCheaper) {
  const std::vector<study::SettingResult> settings{
      result(12, 0.1, 0.1, 0.1),  // over the budget
      result(11, 1.0, 1.2, 1.4),  // least error within the budget
      result(8, 1.3, 1.5, 1.7),   // not significantly worse, and cheaper
      result(5, 1.5, 1.6, 1.8),   // worse
      result(0, 0, 0, 0)};        // too short to be timed
  EXPECT_THAT(study::within_budget(settings, 11, study::SweepError::Centre), ElementsAre(2, 1, 3));
  EXPECT_THAT(study::within_budget(settings, 7, study::SweepError::Centre), ElementsAre(3));
  EXPECT_THAT(study::within_budget(settings, 4, study::SweepError::Centre), IsEmpty());
}

study::CellRun run_of(double front, double ms) {
  study::CellRun out;
  for (const double time : {0.1, 0.2}) {
    study::WaterSample sample{.time_s = time, .front_m = front, .kinetic_j_kg = 10};
    sample.centre_m[0] = front;
    out.samples.push_back(sample);
  }
  for (int frame = 0; frame < 8; ++frame) out.frames.push_back({ms, {}});
  return out;
}

class BudgetChoice : public ::testing::Test {
 protected:
  const study::SweepPlan plan{.n_star = 512};
  const study::SweepOrigin origin{"a machine", "0.1.0 abc", "feed"};
  const sim::SolverSetting usual = sim::usual_setting("SingleDam", sim::MethodKind::HiRes, 512);
  const sim::SolverSetting eight = [&] {
    auto out = usual;
    out[sim::SolverKnob::Iterations] = 8;
    return out;
  }();
  std::vector<study::SweepCell> run_anew;
  std::vector<std::string> heard;

  study::StoredCell stored(const sim::SolverSetting& setting, int seed, double front, double ms) const {
    return {{setting, seed, plan.seconds, plan.size}, origin, run_of(front, ms)};
  }
  std::vector<study::StoredCell> cells() const {
    const auto reference = study::reference_setting("SingleDam", 512);
    return {stored(reference, 1, 1, 100), stored(reference, 2, 1.001, 100), stored(usual, 1, 1.2, 5),
            stored(usual, 2, 1.21, 5),    stored(eight, 1, 1.1, 9),         stored(eight, 2, 1.11, 9)};
  }
  /// Chooses a setting. Repeated runs of the usual setting and of that with eight projections take these
  /// times per frame.
  sim::SettingFile choose(double budget_ms, double usual_ms, double eight_ms) {
    return study::choose_setting(
        cells(), origin, {plan, budget_ms, study::SweepError::Centre, 10},
        [&](const study::SweepCell& cell) {
          run_anew.push_back(cell);
          const bool is_eight = cell.setting == eight;
          return stored(cell.setting, cell.seed, is_eight ? 1.12 : 1.2, is_eight ? eight_ms : usual_ms);
        },
        [&](const std::string& words) { heard.push_back(words); });
  }
};

TEST_F(BudgetChoice, IsMeasuredAnewFromStartsThatTheSweepHasNotSeen) {
  const auto file = choose(10, 5, 9.5);
  EXPECT_EQ(file.setting, eight);
  ASSERT_EQ(run_anew.size(), 2u);
  EXPECT_EQ(run_anew[0].seed, 3);
  EXPECT_EQ(run_anew[1].seed, 4);
  EXPECT_DOUBLE_EQ(file.measured.ms_p95, 9.5) << "the fresh starts'";
  EXPECT_EQ(file.measured.seeds, 4);
  EXPECT_EQ(file.measured.error, "centre_pct");
  EXPECT_NEAR(file.measured.error_low_pct, 1, 1e-9);
  EXPECT_NEAR(file.measured.error_high_pct, 1.2, 1e-9);
  EXPECT_TRUE(heard.empty());
}

TEST_F(BudgetChoice, IsAmongTheSettingsThatAreWished) {
  const auto run = [&](const study::SweepCell& cell) { return stored(cell.setting, cell.seed, 1.2, 5); };
  const auto said = [](const std::string&) {};
  study::BudgetRequest request{plan, 10, study::SweepError::Centre, 10};
  request.n_star = 512;
  request.frames_per_s = 60;
  request.method = sim::MethodKind::HiRes;
  EXPECT_EQ(study::choose_setting(cells(), origin, request, run, said).setting, eight);
  request.method = sim::MethodKind::Ours;
  EXPECT_THAT([&] { study::choose_setting(cells(), origin, request, run, said); },
              ThrowsMessage<base::Error>(HasSubstr("match no setting of the sweep")));
  request.method.reset();
  request.frames_per_s = 90;
  EXPECT_THROW(study::choose_setting(cells(), origin, request, run, said), base::Error);
}

TEST_F(BudgetChoice, WhatDoesNotKeepTheBudgetAgainIsLeft) {
  const auto file = choose(10, 5, 10.5);
  EXPECT_EQ(file.setting, usual);
  EXPECT_DOUBLE_EQ(file.measured.ms_p95, 5);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_THAT(heard[0],
              HasSubstr("HiRes, n_* 512, projections 8: 10.50 ms when measured anew, more than the budget"));
}

TEST_F(BudgetChoice, WhereNothingKeepsItTheNearestIsNamed) {
  EXPECT_THAT([&] { choose(4, 5, 9); },
              ThrowsMessage<base::Error>(HasSubstr("--budget 4ms: is met by no setting of the sweep. Nearest "
                                                   "is HiRes, n_* 512: 5.00 ms in 95 % of its frames, 1.00 "
                                                   "ms above the budget\n  mend: allow 5.00ms")));
  EXPECT_TRUE(run_anew.empty());
  EXPECT_THAT(
      [&] { choose(10, 12, 14); },
      ThrowsMessage<base::Error>(HasSubstr(
          "when measured anew. Nearest is HiRes, n_* 512: 12.00 ms in 95 % of its frames, 2.00 ms above the "
          "budget")));
}

class BudgetE2e : public test::TableTest {};

TEST_F(BudgetE2e, FromTheSweepToTheProgramsThatRunIt) {
  const std::string sweep =
      "accuracy --quick --n-star 64 --seconds 0.2 --seeds 1 --pictures none --db " + path("s.db");
  ASSERT_EQ(table(sweep).exit_code, 0);
  const auto none = table(sweep + " --budget 0.0001ms --out " + path("none.toml"));
  EXPECT_EQ(none.exit_code, 1);
  // Only the text before the nearest setting is compared: which setting is nearest depends on how busy the
  // machine is.
  EXPECT_THAT(none.out, HasSubstr("--budget 0.0001ms: is met by no setting of the sweep. Nearest is "));
  EXPECT_FALSE(std::filesystem::exists(path("none.toml")));
  const auto chosen = table(sweep + " --budget 100000ms --error kinetic --out " + path("best.toml"));
  ASSERT_EQ(chosen.exit_code, 0) << chosen.out;
  EXPECT_THAT(chosen.out, Not(HasSubstr("cells have run on this machine"))) << "the sweep is whole";
  const auto file = sim::read_setting_file(path("best.toml"));
  EXPECT_EQ(file.measured.error, "kinetic_pct");
  EXPECT_EQ(file.measured.seeds, 3);
  const auto timed =
      table("frame --setting " + path("best.toml") + " --frames 2 --no-render --json " + path("frame.json"));
  ASSERT_EQ(timed.exit_code, 0) << timed.out;
  EXPECT_THAT(timed.out, HasSubstr("in 95 % of the frames (the solver alone), kinetic_pct"));
  EXPECT_THAT(timed.out, HasSubstr(" n_* 64 on cpu"));
  EXPECT_THAT(timed.out, Not(HasSubstr("another scene file")));
  const std::string view = "vip-view --headless --backend cpu --frames 1 --setting " + path("best.toml");
  const auto seen = program(view + " data/scenes/jet_impact.toml --size 64x36");
  ASSERT_EQ(seen.exit_code, 0) << seen.out;
  EXPECT_THAT(seen.out, HasSubstr("n_* 64: "));
  EXPECT_THAT(seen.out, HasSubstr("note: the setting was measured on another scene file"));
  for (const std::string beside : {" --n-star 32", " --method LoRes", " --levels 2", " --tau live"}) {
    EXPECT_NE(program(view + " data/scenes/single_dam.toml" + beside).exit_code, 0);
    EXPECT_NE(table("frame --setting " + path("best.toml") + beside).exit_code, 0) << beside;
  }
}

TEST_F(BudgetE2e, WordsThatDoNotGoTogetherAreRefused) {
  for (const char* words :
       {"--out best.toml", "--budget 5ms --db s.db", "--budget 5ms --out best.toml",
        "--error front --db s.db", "--budget 5ms --db s.db --out best.toml --table",
        "--budget 5ms --db none.db --out best.toml", "--budget 5ms --db s.db --out s.db"}) {
    const auto ended = test::run_shell("cd " + path("") + " && " VIP_BIN_DIR "/vip-bench accuracy " + words);
    EXPECT_NE(ended.exit_code, 0) << words << ended.out;
    EXPECT_TRUE(std::filesystem::is_empty(path(""))) << words;
  }
}

}  // namespace
}  // namespace apps
