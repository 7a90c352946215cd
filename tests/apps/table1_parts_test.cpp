/// Parts of vip-bench table1: starts, gaze points, masks, means and verdicts.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/contact_sheet.hpp"
#include "libsim/measure/masks.hpp"
#include "libsim/measure/table1.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/base/error.hpp"

namespace {

using measure::Mask;
using measure::Metric;
using Method = sim::MethodKind;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(Table1Gazes, AreTheScenesOwnNearestInTimeFirst) {
  const auto dam = sim::read_scene("data/scenes/single_dam.toml");
  using Points = std::vector<sim::Vec3d>;
  EXPECT_EQ(measure::gaze_points(dam, 120, 3),
            (Points{dam.gaze[2].point_m, dam.gaze[1].point_m, dam.gaze[3].point_m}));
  // The gaze starts its jump to the point of frame 60 in that frame: in frame 60 it still rests on the
  // previous point.
  EXPECT_EQ(measure::gaze_points(dam, 60, 2), (Points{dam.gaze[0].point_m, dam.gaze[1].point_m}));
  // Faucet lists one of its gaze points twice, so it has only three different ones.
  const auto faucet = sim::read_scene("data/scenes/faucet.toml");
  for (const int frame : faucet.checkpoints) {
    const auto points = measure::gaze_points(faucet, frame, 3);
    EXPECT_EQ(points[0], sim::gaze_point(faucet, frame));
    EXPECT_EQ((std::set<sim::Vec3d>(points.begin(), points.end()).size()), 3u);
  }
  EXPECT_THROW(measure::gaze_points(faucet, 40, 4), base::Error);
}

TEST(Table1Starts, MoveByOneUlpAndByNothingElse) {
  std::vector<sim::ParticleState> state;
  for (int i = 0; i < 4000; ++i)
    state.push_back({i, 0, 1.5F + 1e-3F * static_cast<float>(i), 0.25F, 7, 1, 2, 3});
  EXPECT_EQ(measure::perturbed(state, 0)[17].x_m, state[17].x_m);
  const auto first = measure::perturbed(state, 1), again = measure::perturbed(state, 1);
  const auto second = measure::perturbed(state, 2);
  int up = 0, equal = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const float x = state[i].x_m;
    ASSERT_TRUE(first[i].x_m == std::nextafter(x, 99.0F) || first[i].x_m == std::nextafter(x, -99.0F));
    ASSERT_EQ(std::abs(first[i].z_m - 7), first[i].z_m > 7 ? 0x1p-21F : 0x1p-22F * 2);
    ASSERT_NE(first[i].y_m, state[i].y_m);
    ASSERT_EQ(first[i].vy_m_s, 2);
    ASSERT_EQ(first[i].x_m, again[i].x_m);
    up += first[i].x_m > x;
    equal += first[i].x_m == second[i].x_m;
  }
  EXPECT_NEAR(up, 2000, 200);
  EXPECT_NEAR(equal, 2000, 200) << "repeats draw for themselves";
}

TEST(Table1Starts, TargetsGoById) {
  const std::vector<sim::ParticleState> state{{3, 0, 0, 0, 0, 0, 0, 0}, {8, 0, 0, 0, 0, 0, 0, 0}};
  std::vector<sim::ParticleSaliency> values(2);
  values[0].target = 2;
  values[1].target = 1;
  EXPECT_EQ(measure::targets_by_id(state, {8, 3}, values), (std::vector<std::uint8_t>{1, 2}));
  EXPECT_THROW(measure::targets_by_id(state, {8, 4}, values), base::Error);
}

TEST(Table1Masks, TheFoveaIsAConeRoundTheGaze) {
  sim::Camera camera;
  camera.eye_m = {0, 0, 5};
  camera.target_m = {0, 0, 0};
  const auto view = sim::make_view(camera, 400, 300);
  const double px_per_slope = 150 / std::tan(75.0 / 2 * 0.017453292519943295);
  const auto centre = measure::fovea_mask(view, sim::gaze_at(camera, camera.target_m), 7.5);
  const double radius = px_per_slope * std::tan(7.5 * 0.017453292519943295);
  EXPECT_NEAR(static_cast<double>(measure::pixels_of(centre)), 3.14159265 * radius * radius, 60);
  EXPECT_TRUE(centre[150 * 400 + 200]);
  EXPECT_FALSE(centre[150 * 400 + 240]);
  // Up in the world is up in the picture, whose first row is the top.
  const auto above = measure::fovea_mask(view, sim::gaze_at(camera, {0, 2, 0}), 7.5);
  const auto row = static_cast<std::size_t>(150 - 0.4 * px_per_slope);
  EXPECT_TRUE(above[row * 400 + 200]);
  EXPECT_FALSE(above[(299 - row) * 400 + 200]);
}

TEST(Table1Masks, TheSalientFifthIsRankedByFAndLeavesTheFoveaOut) {
  sim::GBuffer picture;
  picture.width = 10;
  picture.height = 5;
  picture.front.assign(50, sim::GBuffer::no_particle);
  // Ten pixels of fluid in the G-buffer's first row, the lowest of the picture, which is the mask's last row.
  for (std::uint32_t x = 0; x < 10; ++x) picture.front[x] = x;
  std::vector<int> ids;
  std::vector<float> by_id(10);
  for (int i = 0; i < 10; ++i) {
    ids.push_back(9 - i);
    by_id[static_cast<std::size_t>(9 - i)] = static_cast<float>(i);  // the feature F rises along x
  }
  by_id[static_cast<std::size_t>(ids[4])] = std::nanf("");
  const auto salient = measure::salient_mask(picture, ids, by_id, Mask(50, 0));
  for (std::size_t p = 0; p < 50; ++p) EXPECT_EQ(salient[p], p == 48 || p == 49) << p;
  Mask fovea(50, 0);
  fovea[49] = 1;
  EXPECT_EQ(measure::pixels_of(measure::salient_mask(picture, ids, by_id, fovea)), 1u);
  picture.front.assign(50, sim::GBuffer::no_particle);
  EXPECT_EQ(measure::pixels_of(measure::salient_mask(picture, ids, by_id, fovea)), 0u) << "no fluid";
}

TEST(Table1Masks, FluidGrowsByThreePixels) {
  Mask a(20 * 12, 0), b(20 * 12, 0);
  a[5 * 20 + 4] = 1;
  b[0] = 1;
  const auto grown = measure::grown_union(a, b, 20, 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool near_a = std::abs(y - 5) <= 3 && std::abs(x - 4) <= 3;
      EXPECT_EQ(grown[static_cast<std::size_t>(20 * y + x)], near_a || (x <= 3 && y <= 3)) << x << ' ' << y;
    }
  }
}

/// One block with PSNR@overall and PSNR@fov of three methods; two groups of two repeats.
measure::ScoreBlock block_of(const std::vector<double>& lores, const std::vector<double>& fov,
                             const std::vector<double>& ours) {
  measure::ScoreBlock out{"Pond", "1k", sim::Preset::Tuned, {}};
  for (const auto& [method, values] :
       {std::pair{Method::LoRes, lores}, {Method::FovFluid, fov}, {Method::Ours, ours}}) {
    measure::MethodScores scores;
    scores.method = method;
    for (const Metric metric : {Metric::PsnrOverall, Metric::PsnrFov}) {
      auto& series = scores.of(metric);
      series.repeats = 2;
      for (const double value : values) series.cells.push_back({value, 5000});
    }
    out.methods.push_back(scores);
  }
  return out;
}

TEST(Table1Scores, LeaveEqualPicturesAndSmallMasksOutOfTheMeans) {
  const auto rows = measure::score_rows(
                        {block_of({20, 22, 30, 32}, {infinite, 40, unknown, 50}, {infinite, infinite, 1, 1})})
                        .rows;
  const auto row = [&](const std::string& method) {
    for (const auto& each : rows) {
      if (each[2] == method && each[4] == "psnr_overall") return each;
    }
    return std::vector<std::string>();
  };
  using Row = std::vector<std::string>;
  // The groups' means are 21 and 31. The half width is t(0.975, 1) = 12.7062 times their standard error, 5.
  EXPECT_EQ(row("LoRes"), (Row{"Pond", "1k", "LoRes", "tuned", "psnr_overall", "26.000", "-37.531", "89.531",
                               "2", "4", "0", "0", "5000"}));
  EXPECT_EQ(row("FovFluid")[5], "45.000");
  EXPECT_EQ(row("FovFluid")[10], "1");
  EXPECT_EQ(row("FovFluid")[11], "1");
  EXPECT_EQ(row("Ours")[8], "1") << "a group of equal pictures";
  const auto same = measure::score_rows({block_of({infinite, infinite, infinite, infinite}, {}, {})}).rows;
  EXPECT_EQ(same[0][5], "inf");
  EXPECT_EQ(same[0][6], "-");
}

std::string verdict_of(const measure::ScoreBlock& block, const std::string& metric,
                       const std::string& difference) {
  for (const auto& row : measure::paired_rows({block}).rows) {
    if (row[3] == metric && row[4] == difference) return row[9];
  }
  return "no row";
}

/// A film has one cell for each start, and its cells need not form groups of repeats as those of stills do:
/// one start is enough for a row.
TEST(Table1Scores, AFilmOfOneStartHasARowBesideRepeatedStills) {
  measure::Table1Options options;
  options.repeats = 5;
  measure::ScoreBlock block =
      measure::empty_block(sim::scenes_of("SingleDam").front(), {"1k", 1024}, sim::Preset::Tuned, options);
  for (auto& scores : block.methods) scores.of(Metric::SsimCumul).cells.push_back({0.9, 5000});
  EXPECT_EQ(measure::score_rows({block}).rows.size(), block.methods.size());
}

TEST(Table1Scores, AnOrderBreaksBeyondItsBound) {
  const auto close = block_of({20, 20, 30, 30}, {20, 20, 30, 30}, {19.95, 19.95, 29.92, 29.92});
  EXPECT_EQ(verdict_of(close, "psnr_overall", "Ours - FovFluid"), "holds");
  EXPECT_EQ(verdict_of(close, "psnr_overall", "FovFluid - LoRes"), "holds");
  EXPECT_EQ(verdict_of(close, "psnr_fov", "Ours - FovFluid"), "holds");
  EXPECT_EQ(verdict_of(close, "psnr_fov", "FovFluid - LoRes"), "-") << "no order is claimed in the fovea";
  const auto broken = block_of({20, 20, 30, 30}, {20, 20, 30, 30}, {19.8, 19.8, 29.8, 29.8});
  EXPECT_EQ(verdict_of(broken, "psnr_overall", "Ours - FovFluid"), "broken");
  EXPECT_EQ(verdict_of(broken, "psnr_fov", "Ours - FovFluid"), "holds") << "0.75 dB are allowed there";
  const auto far = block_of({20, 20, 30, 30}, {20, 20, 30, 30}, {19.2, 19.2, 29.2, 29.2});
  EXPECT_EQ(verdict_of(far, "psnr_fov", "Ours - FovFluid"), "broken");
  const auto empty = block_of({20, 20, 30, 30}, {20, 20, 30, 30}, {infinite, infinite, infinite, infinite});
  EXPECT_EQ(verdict_of(empty, "psnr_overall", "Ours - FovFluid"), "no data");
}

TEST(Table1Scores, PairsAreTakenCellByCell) {
  // The means of the methods' groups are 20 and 30, and 21 and 31, but the second method lacks a value in its
  // second group.
  const auto rows = measure::paired_rows({block_of({20, 20, 30, 30}, {21, 21, infinite, 31}, {})}).rows;
  EXPECT_EQ(rows[0][4], "FovFluid - LoRes");
  EXPECT_EQ(rows[0][5], "1.000");
  EXPECT_EQ(rows[0][8], "2");
}

TEST(Table1Pictures, StandSideBySide) {
  const auto plain = [](std::uint8_t value) { return sim::Image{2, 1, std::vector<std::uint8_t>(8, value)}; };
  const auto sheet = measure::contact_sheet({{plain(1), plain(2)}, {plain(3), plain(4)}});
  EXPECT_EQ(sheet.width, 4);
  EXPECT_EQ(sheet.height, 2);
  std::vector<std::uint8_t> expected;
  for (const int value : {1, 3, 2, 4}) expected.insert(expected.end(), 8, static_cast<std::uint8_t>(value));
  EXPECT_EQ(sheet.rgba, expected);
}

}  // namespace
