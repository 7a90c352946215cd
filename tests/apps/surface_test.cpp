#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/gl/gl_context.hpp"
#include "libsim/measure/known_shapes.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;

/// A wave of amplitude a and length L has the curvature a (2 pi / L)^2 sin: its mean square is half of that
/// squared.
TEST(CurvatureEnergy, OfAWaveIsItsClosedForm) {
  const double d = 0.1, step = d / 32, a = 0.01;
  const auto wave = [&](double length) {
    std::vector<double> out;
    for (int i = 0; i < 3200; ++i) out.push_back(a * std::sin(2 * std::numbers::pi * i * step / length));
    return measure::curvature_energy(out, step, d);
  };
  const double curvature = a * std::pow(2 * std::numbers::pi / d, 2);
  EXPECT_NEAR(wave(d), 0.5 * curvature * curvature * d * d, 0.02 * curvature * curvature * d * d);
  EXPECT_LT(wave(4 * d), 1e-3 * wave(d)) << "longer than 3/2 d";
  EXPECT_LT(wave(0.4 * d), 1e-3 * wave(d)) << "shorter than 2/3 d";
}

/// Outline and normals at fewer particles than in docs/results.md, with wider bounds.
TEST(KnownShapes, EllipsoidsKeepTheOutlineOfBallAndColumn) {
  const auto context = sim::GlContext::make_headless();
  for (const auto shape : {measure::KnownShape::Ball, measure::KnownShape::Column}) {
    for (const int level : {1, 3, measure::mixed_levels}) {
      const auto drawn = measure::draw_shape(shape, level, 500, sim::Surface::Ellipsoids).errors;
      const auto spheres = measure::draw_shape(shape, level, 500, sim::Surface::Spheres).errors;
      EXPECT_LT(drawn.outline_d, 0.2) << measure::shape_name(shape) << level;
      EXPECT_LT(drawn.normals_deg, 5) << measure::shape_name(shape) << level;
      EXPECT_LT(drawn.scallop, 0.25 * spheres.scallop) << measure::shape_name(shape) << level;
    }
  }
}

class SurfaceE2e : public test::TableTest {};

TEST_F(SurfaceE2e, HoldsEveryFigureOfBothSurfaces) {
  const auto ended = table("surface --n-star 64 --warm-up 4 --frames 8 --timed-frames 1 --size 96x64 --csv " +
                           path("s.csv") + " --json " + path("s.json") + " --pictures " + path("shapes"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("s.csv");
  std::map<std::string, int> counts;
  for (const auto& row : table) {
    ++counts[row.at("figure")];
    for (const char* surface : {"spheres", "ellipsoids"}) EXPECT_GT(std::stod(row.at(surface)), 0);
  }
  EXPECT_EQ(counts["outline_d"], 20) << "four shapes at four levels and mixed";
  EXPECT_EQ(counts["normals_deg"], 15) << "the sheet has none";
  EXPECT_EQ(counts["scallop"], 15) << "the pool has none";
  for (const char* figure : {"popping", "change_between", "take_ms", "draw_ms"}) EXPECT_EQ(counts[figure], 2);
  const auto json = base::Json::parse(base::read_file(path("s.json"), 1 << 20));
  EXPECT_EQ(json["rows"].size(), table.size());
  EXPECT_TRUE(std::filesystem::exists(path("shapes") + "/ball_mixed_ellipsoids.png"));
}

TEST_F(SurfaceE2e, OneSurfaceHasOneColumn) {
  const auto ended =
      program("vip-bench surface --surface spheres --n-star 64 --frames 0 --csv " + path("s.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto table = rows("s.csv");
  EXPECT_EQ(table.size(), 50u);
  EXPECT_FALSE(table.front().contains("ellipsoids"));
  EXPECT_EQ(this->table("surface --surface blobs").exit_code, 2) << "an unknown word";
  const auto shapes = this->table("surface --frames 0");  // adds --backend cpu
  EXPECT_EQ(shapes.exit_code, 2);
  EXPECT_THAT(shapes.out, ::testing::HasSubstr("--frames 0 excludes --backend"));
}

}  // namespace
}  // namespace apps
