/// Features of pictures with known grain and motion.
#include "libstudy/observer/picture_measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace {

using study::MeasuredPicture;

/// 240 x 160 px with a much brighter border of 20 px that is not fluid.
MeasuredPicture picture(const std::function<double(int, int)>& luminance) {
  MeasuredPicture out{240, 160, {}, {}};
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      const bool fluid = x >= 20 && x < 220 && y >= 20 && y < 140;
      out.fluid.push_back(fluid);
      out.luminance.push_back(fluid ? static_cast<float>(luminance(x, y)) : 1.0F);
    }
  }
  return out;
}

double wave(double x, double length_px) { return std::sin(2 * std::numbers::pi * x / length_px); }

double granularity_of(const std::function<double(int, int)>& luminance) {
  const MeasuredPicture one = picture(luminance);
  return study::measure_pictures({one, one, one}, 120, 80).granularity_px;
}

TEST(PictureMeasure, GranularityIsTheWavelengthOfAWave) {
  // The picture is a wave along x, so it has a slope along one axis only. The difference between neighbouring
  // pixels is within 2 % of the derivative.
  for (const double length_px : {8.0, 12.0, 16.0})
    EXPECT_NEAR(granularity_of([&](int x, int) { return 0.3 + 0.1 * wave(x, length_px); }), length_px,
                0.05 * length_px);
}

TEST(PictureMeasure, GranularityKnowsNeitherContrastNorSlowShading) {
  const auto grain = [](int x, int y) { return 0.05 * wave(x, 10) * wave(y, 10); };
  const double plain = granularity_of([&](int x, int y) { return 0.3 + grain(x, y); });
  EXPECT_NEAR(granularity_of([&](int x, int y) { return 0.3 + 3 * grain(x, y); }), plain, 1e-3);
  EXPECT_NEAR(granularity_of([&](int x, int y) { return 0.001 * x + grain(x, y); }), plain, 0.05 * plain);
}

TEST(PictureMeasure, OnlyTheGrainNearTheGazeCounts) {
  // The wave is fine on the left and coarse on the right.
  const MeasuredPicture one = picture([](int x, int) { return 0.3 + 0.1 * wave(x, x < 120 ? 8 : 16); });
  EXPECT_NEAR(study::measure_pictures({one, one, one}, 45, 80).granularity_px, 8, 0.6);
  EXPECT_NEAR(study::measure_pictures({one, one, one}, 195, 80).granularity_px, 16, 1.2);
}

TEST(PictureMeasure, FlickerIsTheSecondDifferenceInTime) {
  const auto at = [](double light) { return picture([=](int, int) { return light; }); };
  EXPECT_NEAR(study::measure_pictures({at(0.2), at(0.2), at(0.2)}, 120, 80).flicker, 0, 1e-9);
  EXPECT_NEAR(study::measure_pictures({at(0.2), at(0.3), at(0.4)}, 120, 80).flicker, 0, 1e-6);  // even motion
  EXPECT_NEAR(study::measure_pictures({at(0.2), at(0.3), at(0.2)}, 120, 80).flicker, 0.2, 1e-6);
}

TEST(PictureMeasure, PicturesWithoutFluidHaveNone) {
  MeasuredPicture empty = picture([](int x, int) { return 0.5 + 0.1 * wave(x, 8); });
  empty.fluid.assign(empty.fluid.size(), 0);
  const auto found = study::measure_pictures({empty, empty, empty}, 120, 80);
  EXPECT_EQ(found.granularity_px, 0);
  EXPECT_EQ(found.flicker, 0);
}

}  // namespace
