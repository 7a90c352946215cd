/// vip-bench table1 of two versions of the source tree: both start from the same checkpoints, and each
/// picture of one is compared with the same picture of the other.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "libsim/measure/cell_scores.hpp"
#include "libsim/measure/checkpoint_file.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

measure::Checkpoint small_checkpoint() {
  measure::Checkpoint out;
  out.frame = 60;
  out.state = {{0, 0, 0.1F, 0.2F, 0.3F, 1, 2, 3}, {1, 2, -0.0F, 1e-30F, 4, 5, 6, 7}};
  out.seen.width = 2;
  out.seen.height = 1;
  out.seen.depth = {1.5F, std::numeric_limits<float>::infinity()};
  out.seen.filtered_depth = out.seen.thickness = out.seen.radius = {0.25F, 0};
  out.seen.normal = {0, 0, 1, 0, 0, 0};
  out.seen.front = {1, sim::GBuffer::no_particle};
  return out;
}

class CheckpointFile : public ::testing::Test {
 protected:
  CheckpointFile() { measure::write_checkpoint(folder_.path(), of_, checkpoint_); }

  std::string error(const measure::CheckpointOf& of) const {
    return error_of([&] { measure::read_checkpoint(folder_.path(), of); });
  }
  std::string path() const { return folder_ / measure::checkpoint_name(of_); }

  const ::test::TemporaryFolder folder_;
  const measure::Checkpoint checkpoint_ = small_checkpoint();
  const measure::CheckpointOf of_{"Pond", std::string(64, 'a'), 64, 60, {2, 1}};
};

TEST_F(CheckpointFile, ComesBackBitForBit) {
  const measure::Checkpoint back = measure::read_checkpoint(folder_.path(), of_);
  EXPECT_EQ(back.frame, 60);
  ASSERT_EQ(back.state.size(), 2u);
  const sim::ParticleState& last = back.state[1];
  EXPECT_EQ(last.id, 1);
  EXPECT_EQ(last.level, 2);
  EXPECT_TRUE(std::signbit(last.x_m)) << "minus zero";
  EXPECT_EQ(last.y_m, 1e-30F);
  EXPECT_EQ(last.vz_m_s, 7);
  EXPECT_EQ(back.seen.depth, checkpoint_.seen.depth);
  EXPECT_EQ(back.seen.front, checkpoint_.seen.front);
  EXPECT_EQ(back.seen.normal, checkpoint_.seen.normal);
  EXPECT_EQ(measure::checkpoint_digest(back), measure::checkpoint_digest(checkpoint_));
  measure::Checkpoint other = checkpoint_;
  other.state[1].vz_m_s = std::nextafter(other.state[1].vz_m_s, 9.0F);
  EXPECT_NE(measure::checkpoint_digest(other), measure::checkpoint_digest(checkpoint_));
  other = checkpoint_;
  other.seen.depth[0] = 2;
  EXPECT_NE(measure::checkpoint_digest(other), measure::checkpoint_digest(checkpoint_))
      << "the picture is part of the start";
}

TEST_F(CheckpointFile, SaysWhatIsMissingOrOfSomethingElse) {
  measure::CheckpointOf other = of_;
  other.frame = 120;
  EXPECT_THAT(error(other), AllOf(HasSubstr("Pond_64_f120.checkpoint: does not exist"), HasSubstr("mend: ")));
  other = of_;
  other.scene_sha256 = std::string(64, 'b');
  EXPECT_THAT(error(other), AllOf(HasSubstr("has scene_sha256 aaaa"), HasSubstr("this run has bbbb")));
  other = of_;
  other.size = {4, 1};
  EXPECT_THAT(error(other), HasSubstr("has picture 2x1, this run has 4x1"));
  other = of_;
  other.n_star = 128;
  std::filesystem::copy_file(path(), folder_ / measure::checkpoint_name(other));
  EXPECT_THAT(error(other), HasSubstr("has n_star 64, this run has 128"));
}

TEST_F(CheckpointFile, RefusesWhatIsDamaged) {
  const std::string whole = base::read_file(path(), 1 << 16);
  for (std::size_t kept = 0; kept < whole.size(); kept += 7) {
    base::write_file_atomically(path(), whole.substr(0, kept));
    EXPECT_THAT(error(of_), HasSubstr("mend: ")) << kept;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    base::write_file_atomically(path(), bytes);
    EXPECT_THAT(error(of_), HasSubstr("mend: ")) << at;
  }
}

/// Two checkpoints with two gaze points, two repeats each; only LoRes.
measure::ScoreBlock block_of(const std::vector<double>& values) {
  measure::ScoreBlock out{"Pond", "1k", sim::Preset::Tuned, {}};
  out.checkpoints = {60, 120};
  out.starts = {"abc", "def"};
  out.gazes = 2;
  measure::MethodScores scores;
  scores.method = sim::MethodKind::LoRes;
  for (const measure::Metric metric : measure::still_metrics) {
    scores.of(metric).repeats = 2;
    for (const double value : values) scores.of(metric).cells.push_back({value, 5000});
  }
  out.methods.push_back(scores);
  return out;
}

class PairedCells : public ::testing::Test {
 protected:
  std::string path() const { return folder_ / "then.csv"; }
  measure::CellScores written(const measure::ScoreBlock& block) const {
    base::write_file_atomically(path(), figures::to_csv(measure::cell_rows({block})));
    return measure::read_cells(path());
  }
  const ::test::TemporaryFolder folder_;
};

TEST_F(PairedCells, ReadBackToTheSameBits) {
  const std::vector<double> values{1.0 / 3, -1e-300, infinite, unknown, 20, 21, 22, 0.1 + 0.2};
  const auto back = written(block_of(values));
  ASSERT_EQ(back.size(), 8u);
  const auto at = [&](int checkpoint, const char* start, int gaze, int repeat) {
    return back.at({"Pond", "1k", "tuned", "LoRes", checkpoint, start, gaze, repeat})[4];
  };
  EXPECT_EQ(at(60, "abc", 1, 1), values[0]);
  EXPECT_EQ(at(60, "abc", 1, 2), values[1]);
  EXPECT_EQ(at(60, "abc", 2, 1), infinite);
  EXPECT_TRUE(std::isnan(at(60, "abc", 2, 2)));
  EXPECT_EQ(at(120, "def", 2, 2), values[7]);
}

// Repeats of one checkpoint and gaze point form a pair's mean. Their differences are 1, 2 | 3 | 6, 6, so the
// means are 1.5, 3 and 6; the last pair has no finite difference.
TEST_F(PairedCells, ChangeIsTheMeanOverPairsOfCheckpointAndGaze) {
  const auto then = written(block_of({10, 10, 20, 20, 30, 30, infinite, 40}));
  const auto now = block_of({11, 12, 23, infinite, 36, 36, 41, unknown});
  const auto table = measure::change_rows({now}, then);
  ASSERT_EQ(table.rows.size(), measure::still_metrics.size());
  // The standard deviation of 1.5, 3, 6 is 2.29129; t(0.975, 2) = 4.30265.
  EXPECT_EQ(table.rows[2], (std::vector<std::string>{"Pond", "1k", "tuned", "LoRes", "psnr_overall", "3.500",
                                                     "-2.192", "9.192", "3"}));
  const auto itself =
      measure::change_rows({block_of({1, 2, 3, 4, 5, 6, 7, 8})}, written(block_of({1, 2, 3, 4, 5, 6, 7, 8})));
  EXPECT_EQ(itself.rows[0][5], "0.000");
  EXPECT_EQ(itself.rows[0][6], "0.000");
  EXPECT_EQ(itself.rows[0][8], "4");
}

TEST_F(PairedCells, WhatHasNoPairIsCountedAndNamed) {
  const auto block = block_of({1, 2, 3, 4, 5, 6, 7, 8});
  const auto then = written(block);
  EXPECT_NO_THROW(measure::check_paired({block}, then, "then.csv"));
  auto fewer = block;
  fewer.checkpoints = {60};
  EXPECT_THAT(error_of([&] { measure::check_paired({fewer}, then, "then.csv"); }),
              AllOf(StartsWith("--paired-with then.csv: 4 pictures in it are not in this run"),
                    HasSubstr("the first: Pond 1k tuned LoRes, checkpoint 120 (start def), gaze 1, repeat 1"),
                    HasSubstr("mend: ")));
  auto more = block;
  more.gazes = 3;
  EXPECT_THAT(error_of([&] { measure::check_paired({more}, then, "then.csv"); }),
              HasSubstr("4 pictures of this run are not in it, the first: Pond 1k tuned LoRes, checkpoint 60 "
                        "(start abc), gaze 3, repeat 1"));
  auto other_water = block;
  other_water.starts[0] = "xyz";
  EXPECT_THAT(error_of([&] { measure::check_paired({other_water}, then, "then.csv"); }),
              AllOf(HasSubstr("4 pictures of this run"), HasSubstr("; 4 pictures in it")));
}

TEST_F(PairedCells, FilesThatHoldNoPicturesAreRefusedByLine) {
  const std::string csv = figures::to_csv(measure::cell_rows({block_of({1, 2, 3, 4, 5, 6, 7, 8})}));
  const auto refused = [&](const std::string& text) {
    base::write_file_atomically(path(), text);
    return error_of([&] { measure::read_cells(path()); });
  };
  EXPECT_THAT(refused("scene,method\n"), HasSubstr("is no table of single pictures"));
  EXPECT_THAT(refused(csv + "Pond,1k,tuned,LoRes,x,abc,1,1,1,1,1,1,1\n"),
              HasSubstr("then.csv:10: is not a row"));
  EXPECT_THAT(refused(csv + "Pond,1k\n"), HasSubstr("then.csv:10: is not a row"));
  EXPECT_THAT(refused(csv + csv.substr(csv.find('\n') + 1)),
              HasSubstr("then.csv:10: names a picture a second"));
}

class Table1PairsE2e : public test::TableTest {
 protected:
  test::Ended table1(const std::string& arguments) const {
    return table(
        "table1 --scene SingleDam --n-star 64 --gazes 2 --repeats 2 --frames-after 1 --cumul-frames 0 "
        "--projections 4 --size 400x225 " +
        arguments);
  }
};

TEST_F(Table1PairsE2e, AStoredRunIsReadAgainBitForBit) {
  auto ended =
      table1("--checkpoints 2 --checkpoints-to " + path("kept/deep") + " --cells " + path("then.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  ended = table1("--checkpoints 2 --checkpoints-from " + path("kept/deep") + " --cells " + path("now.csv") +
                 " --paired-with " + path("then.csv") + " --csv " + path("t1.csv") + " --markdown " +
                 path("t1.md"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const std::string then = base::read_file(path("then.csv"), 1 << 16);
  EXPECT_EQ(then, base::read_file(path("now.csv"), 1 << 16));
  EXPECT_EQ(rows("then.csv").size(), 2u * 2 * 2 * 5);
  const auto change = rows("t1_change.csv");
  ASSERT_EQ(change.size(), 5 * measure::still_metrics.size());
  for (const auto& row : change) {
    if (row.at("groups") == "0") continue;
    EXPECT_EQ(std::stod(row.at("now_minus_then")), 0) << row.at("method") << row.at("metric");
  }
  EXPECT_THAT(ended.out, HasSubstr("| now_minus_then |"));
  EXPECT_THAT(base::read_file(path("t1.md"), 1 << 16), HasSubstr("| now_minus_then |"));

  // A run with fewer checkpoints than the stored run is refused before anything is computed.
  ended = table1("--checkpoints 1 --checkpoints-from " + path("kept/deep") + " --paired-with " +
                 path("then.csv"));
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("20 pictures in it are not in this run"), HasSubstr("mend: ")));
  ended = table1("--checkpoints 3 --checkpoints-from " + path("kept/deep"));
  EXPECT_EQ(ended.exit_code, 1) << ended.out;
  EXPECT_THAT(ended.out,
              AllOf(HasSubstr("SingleDam_64_f180.checkpoint: does not exist"), HasSubstr("mend: ")));
}

TEST_F(Table1PairsE2e, OptionsThatDoNotGoTogetherAreRefused) {
  EXPECT_EQ(table1("--checkpoints-to " + path("a") + " --checkpoints-from " + path("b")).exit_code, 2);
  EXPECT_EQ(table1("--paired-with " + path("then.csv")).exit_code, 2)
      << "pairs start from stored checkpoints";
  EXPECT_EQ(table1("--checkpoints-from " + path("b")).exit_code, 1);
}

}  // namespace
}  // namespace apps
