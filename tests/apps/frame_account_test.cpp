/// The facts of each frame that a session stores in the database equal those that the solver reports. The
/// tests run the programs as a user does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/json.hpp"
#include "stats/ptpe/ptpe.hpp"
#include "tests/apps/study_test_support.hpp"
#include "tests/common/tables.hpp"

namespace {

namespace fs = std::filesystem;
using apps::test::Ended;
using apps::test::run_program;
using study::sqlite::Connection;
using study::sqlite::Open;
using study::sqlite::Statement;

const std::string bench = VIP_BIN_DIR "/vip-bench";
constexpr const char* guards[] = {"speed_limited",       "coincident_pairs", "not_finite",
                                  "neighbours_dropped",  "wall_projected",   "nozzle_waited",
                                  "saliency_not_finite", "gaze_lost"};

class FrameAccountE2e : public ::testing::Test {
 protected:
  /// One showing of 2.5 s of each method, 512 particles, at 12 frames/s with a standard deviation of 3.
  void write_protocol(const std::string& timing, const std::string& methods = "\"Ours-TSp\", \"HiRes\"") {
    const std::string text =
        test::without(test::protocol_text("ratings"), {"consent", "about", "warm_up", "smoothness", "end"});
    base::write_file_atomically(folder_ / "frames.toml",
                                test::with_keys(text, {{"language", "\"en\"\naccept_approximate = true"},
                                                       {"method", "[" + methods + "]"},
                                                       {"n_star", "[\"64\"]"},
                                                       {"timing", '"' + timing + '"'},
                                                       {"mean_fps", "[12]"},
                                                       {"sd_fps", "[3]"},
                                                       {"duration_s", "2.5"},
                                                       {"content_step_s", "0.016666666666666666"}}));
  }
  void run(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{apps::test::vip_study,
                                       "run",
                                       folder_ / "frames.toml",
                                       "--db",
                                       database(),
                                       "--participant",
                                       "P01",
                                       "--observer",
                                       "random",
                                       "--clock",
                                       "virtual",
                                       "--seed",
                                       "3",
                                       "--backend",
                                       "cpu"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = run_program(arguments);
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
  }
  /// The solver's accounts of 29 frames, from vip-bench frame with the settings of the protocol's showing of
  /// Ours-TSp.
  base::Json bench_accounts() {
    const std::string json = folder_ / "frame.json";
    const Ended ended = apps::test::run_shell(
        bench +
        " frame data/scenes/single_dam.toml --method Ours-TSp --n-star 64 --backend cpu --rate 12,3 "
        "--dt 0.016666666666666666 --look --size 64x36 --warm-up 0 --frames 29 --json " +
        json);
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
    return base::Json::parse(base::read_file(json, 1 << 24))["accounts"];
  }
  std::string database() const { return folder_ / (name_ + ".db"); }
  std::int64_t count(const std::string& condition) const {
    return Connection(database(), Open::Read)
        .integer(
            "SELECT count(*) FROM frame JOIN presentation p USING (presentation_id) "
            "JOIN cell c ON c.cell = p.cell WHERE " +
            condition);
  }

  const test::TemporaryFolder folder_;
  std::string name_ = "study";
};

void expect_account(const Statement& row, std::map<std::string, int>& column, const base::Json& account) {
  EXPECT_EQ(row.integer(column["content_step"]), account["frame"].get<std::int64_t>());
  for (const char* number : {"active_fraction", "tau_fps", "beta", "mu_fps", "delta_fps"}) {
    ASSERT_FALSE(row.is_null(column[number])) << number;
    EXPECT_EQ(row.real(column[number]), account[number].get<double>()) << number;
  }
  for (const char* guard : guards)
    EXPECT_EQ(row.integer(column[guard]), account["guards"][guard].get<std::int64_t>()) << guard;
  std::string particles;
  for (const auto& level : account["particles"]) particles += (particles.empty() ? "" : " ") + level.dump();
  EXPECT_EQ(row.text(column["particles"]), particles);
}

/// A cell's frame rate, set by "settings" or by "equal", determines tau: a live session stores the account
/// that the bench reports at this tau.
TEST_F(FrameAccountE2e, ALiveSessionAtNegativeTauHoldsWhatTheSolverDidAsTheBenchReportsIt) {
  const double tau = stats::ptpe_tolerance({}, 12, 3);
  ASSERT_LT(tau, -5);
  for (const char* timing : {"settings", "equal"}) {
    SCOPED_TRACE(timing);
    name_ = timing;
    write_protocol(timing);
    ASSERT_NO_FATAL_FAILURE(run({"--display", "headless", "--size", "64x36", "--gaze", "fixed"}));

    Connection look(database(), Open::Read);
    Statement row(
        look,
        "SELECT f.* FROM frame f JOIN presentation p USING (presentation_id) JOIN cell c ON c.cell = "
        "p.cell WHERE c.method = 'Ours-TSp' AND f.content_step > 0 ORDER BY f.frame_index");
    std::map<std::string, int> column;
    for (int i = 0; i < row.columns(); ++i) column[row.column_name(i)] = i;
    const auto accounts = bench_accounts();
    std::size_t frames = 0;
    int below_one = 0, several_levels = 0;
    for (; row.step(); ++frames) {
      SCOPED_TRACE(frames);
      ASSERT_LT(frames, accounts.size());
      expect_account(row, column, accounts[frames]);
      EXPECT_NEAR(row.real(column["tau_fps"]), tau, 1e-12);
      EXPECT_NEAR(row.real(column["beta"]), std::exp(0.04 * tau), 1e-12);
      EXPECT_EQ(row.real(column["mu_fps"]), 12);
      EXPECT_EQ(row.real(column["delta_fps"]), 3);
      below_one += row.real(column["active_fraction"]) < 1;
      several_levels += !row.text(column["particles"]).ends_with(" 0 0 0");
    }
    EXPECT_EQ(frames, accounts.size());
    EXPECT_GT(below_one, 20) << "tau of " << tau << " leaves particles out";
    EXPECT_GT(several_levels, 10);
  }
}

TEST_F(FrameAccountE2e, WhatNobodyMeasuredIsEmpty) {
  write_protocol("settings");
  ASSERT_NO_FATAL_FAILURE(run({"--display", "headless", "--size", "64x36"}));
  const std::string nothing = "coalesce(active_fraction, tau_fps, beta, mu_fps, delta_fps) IS NULL";
  EXPECT_GT(count("c.method = 'HiRes'"), 25);
  EXPECT_EQ(count("c.method = 'HiRes' AND NOT (" + nothing + ")"), 0) << "HiRes has no tau";
  EXPECT_EQ(count("c.method = 'HiRes' AND particles <> '512'"), 0);
  EXPECT_EQ(count("content_step > 0 AND (wall_projected IS NULL OR gaze_lost IS NULL)"), 0);
  EXPECT_EQ(
      count("content_step = 0 AND NOT (" + nothing + " AND coalesce(wall_projected, gaze_lost) IS NULL)"), 0)
      << "the start was not computed by a frame";
  EXPECT_EQ(count("content_step = 0"), 2);
}

TEST_F(FrameAccountE2e, FramesOfABakeHoldTheAccountThatWasBaked) {
  const std::string bake = folder_ / "dam.bake";
  const Ended baked = run_program({apps::test::vip_study, "bake", "data/scenes/single_dam.toml", "--method",
                                   "Ours", "--n-star", "64", "--backend", "cpu", "--frames", "40",
                                   "--pictures", "64x36", "--out", bake});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  write_protocol("settings", "\"Ours\"");
  ASSERT_NO_FATAL_FAILURE(run({"--display", "none", "--stimulus", bake}));
  const sim::BakeReader reader(bake);
  sim::BakeFrame frame;
  Connection look(database(), Open::Read);
  Statement row(look,
                "SELECT content_step, particles, wall_projected, tau_fps FROM frame ORDER BY frame_index");
  int frames = 0;
  std::int64_t walls = 0;
  for (; row.step(); ++frames) {
    reader.read_frame(row.integer(0), frame);
    const sim::FrameAccount& account = frame.facts.account;
    std::string particles;
    for (const auto level : account.particles_by_level)
      particles += (particles.empty() ? "" : " ") + std::to_string(level);
    EXPECT_EQ(row.text(1), particles);
    EXPECT_EQ(row.is_null(2), row.integer(0) == 0);
    if (account.guards) {
      EXPECT_EQ(row.integer(2), static_cast<std::int64_t>(account.guards->wall_projected));
      walls += row.integer(2);
    }
    EXPECT_TRUE(row.is_null(3));
  }
  EXPECT_EQ(frames, 30);
  EXPECT_GT(walls, 0);
}

TEST_F(FrameAccountE2e, TheExportHoldsEveryNumberAndSaysWhatItIs) {
  write_protocol("settings", "\"Ours-TSp\"");
  ASSERT_NO_FATAL_FAILURE(run({"--display", "headless", "--size", "64x36"}));
  const Ended done =
      run_program({apps::test::vip_study, "export", "--db", database(), "--csv", folder_ / "csv"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  std::map<std::string, std::string> meaning;
  for (auto& line : test::read_csv(folder_ / "csv/dictionary.csv")) {
    if (line["file"] == "frames.csv") meaning[line["column"]] = line["meaning"];
  }
  auto rows = test::read_csv(folder_ / "csv/frames.csv");
  ASSERT_EQ(rows.size(), 30u);
  for (const char* number : {"active_fraction", "tau_fps", "beta", "mu_fps", "delta_fps", "wall_projected"}) {
    EXPECT_THAT(meaning[number], ::testing::HasSubstr("empty: ")) << number;
    EXPECT_EQ(rows[0][number], "") << number;
    EXPECT_NE(rows[29][number], "") << number;
  }
  EXPECT_EQ(std::stod(rows[29]["mu_fps"]), 12);
}

}  // namespace
