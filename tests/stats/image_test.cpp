#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "stats/image/flicker.hpp"
#include "stats/image/flip.hpp"
#include "stats/image/psnr.hpp"
#include "stats/image/ssim.hpp"

namespace {

struct Image {
  int width, height;
  std::vector<std::uint8_t> rgb;
  stats::ImageView view() const { return {width, height, rgb}; }
};

Image flat(int width, int height, int value) {
  const auto bytes = static_cast<std::size_t>(3 * width * height);
  return {width, height, std::vector<std::uint8_t>(bytes, static_cast<std::uint8_t>(value))};
}

/// Integers from a 32-bit linear congruential generator (Numerical Recipes), the same in every language.
Image noise(int width, int height, std::uint32_t seed) {
  Image out = flat(width, height, 0);
  for (auto& byte : out.rgb) {
    seed = seed * 1664525u + 1013904223u;
    byte = static_cast<std::uint8_t>(seed >> 24);
  }
  return out;
}

/// A slope plus noise of 0 to 31, modulo 256.
Image rough(const Image& noise_image) {
  Image out = noise_image;
  for (std::size_t i = 0; i < out.rgb.size(); ++i) {
    const int x = static_cast<int>(i / 3) % out.width;
    const int y = static_cast<int>(i / 3) / out.width;
    out.rgb[i] = static_cast<std::uint8_t>(40 + 2 * x + y + out.rgb[i] / 8);
  }
  return out;
}

TEST(Psnr, KnownOffsets) {
  const Image a = flat(16, 9, 100);
  EXPECT_NEAR(stats::psnr_db(a.view(), flat(16, 9, 101).view()).value, 48.1308, 5e-5);
  EXPECT_NEAR(stats::psnr_db(a.view(), flat(16, 9, 90).view()).value, 28.1308, 5e-5);
  EXPECT_EQ(stats::psnr_db(flat(16, 9, 0).view(), flat(16, 9, 255).view()).value, 0);
  EXPECT_EQ(stats::psnr_db(a.view(), a.view()).value, std::numeric_limits<double>::infinity());
}

TEST(Psnr, TakesTheThreeChannelsTogether) {
  const Image a = flat(4, 4, 100);
  Image b = a;
  for (std::size_t i = 0; i < b.rgb.size(); i += 3) b.rgb[i] = 103;  // red differs by 3: MSE 9 / 3
  EXPECT_DOUBLE_EQ(stats::mean_squared_error(a.view(), b.view()).value, 3);
}

TEST(Psnr, SeesTheMaskOnly) {
  const Image a = flat(8, 8, 100);
  Image b = a;
  std::vector<std::uint8_t> mask(64, 0);
  for (std::size_t i = 0; i < 16; ++i) mask[i] = 255;
  for (std::size_t c = 0; c < 24; ++c) b.rgb[c] = 110;  // the first 8 pixels, half of the mask
  b.rgb[3 * 63] = 0;                                    // outside the mask
  const auto masked = stats::mean_squared_error(a.view(), b.view(), mask);
  EXPECT_EQ(masked.pixels, 16u);
  EXPECT_DOUBLE_EQ(masked.value, 50);
  const std::vector<std::uint8_t> none(64, 0);
  EXPECT_TRUE(std::isnan(stats::psnr_db(a.view(), b.view(), none).value));
  EXPECT_EQ(stats::psnr_db(a.view(), b.view(), none).pixels, 0u);
}

TEST(Psnr, RefusesPicturesThatDoNotFit) {
  const Image a = flat(8, 8, 1);
  EXPECT_THROW(stats::psnr_db(a.view(), flat(8, 9, 1).view()), std::invalid_argument);
  EXPECT_THROW(stats::psnr_db(a.view(), a.view(), std::vector<std::uint8_t>(63, 1)), std::invalid_argument);
  EXPECT_THROW(stats::psnr_db({8, 8, std::span(a.rgb).first(12)}, a.view()), std::invalid_argument);
  EXPECT_THROW(stats::psnr_db({0, 0, {}}, {0, 0, {}}), std::invalid_argument);
}

TEST(Flicker, SeesWhatChangesAndNotWhatStays) {
  const Image calm = flat(8, 4, 100);
  const Image offset = flat(8, 4, 130);
  Image pops = offset;
  pops.rgb[0] = 133;  // one of 96 values differs by 3
  const auto of = [&](const Image& before, const Image& now) {
    return stats::flicker({before.view(), now.view()}, {calm.view(), calm.view()}).value;
  };
  EXPECT_EQ(of(offset, offset), 0) << "an error that stays";
  EXPECT_DOUBLE_EQ(of(offset, pops), 9.0 / 96);
  EXPECT_DOUBLE_EQ(of(pops, offset), 9.0 / 96);
  EXPECT_EQ(stats::flicker({calm.view(), offset.view()}, {calm.view(), offset.view()}).value, 0)
      << "both films change alike";
  std::vector<std::uint8_t> mask(32, 1);
  mask[0] = 0;
  const auto masked = stats::flicker({offset.view(), pops.view()}, {calm.view(), calm.view()}, mask);
  EXPECT_EQ(masked.value, 0);
  EXPECT_EQ(masked.pixels, 31u);
  EXPECT_THROW(stats::flicker({calm.view(), calm.view()}, {calm.view(), flat(4, 8, 1).view()}),
               std::invalid_argument);
}

TEST(Ssim, ConstantsHaveTheClosedForm) {
  const auto map = stats::ssim_map(flat(20, 15, 100).view(), flat(20, 15, 110).view());
  EXPECT_EQ(map.width, 10);
  EXPECT_EQ(map.height, 5);
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(map.mean().value, (2 * 100 * 110 + c1) / (100 * 100 + 110 * 110 + c1), 1e-9);
  EXPECT_NEAR(map.mean().value, 0.995476, 5e-7);
}

TEST(Ssim, IsOneForEqualAndSymmetric) {
  const Image a = noise(40, 30, 1);
  const Image b = rough(noise(40, 30, 2));
  EXPECT_NEAR(stats::ssim_map(a.view(), a.view()).mean().value, 1, 1e-9);
  const double ab = stats::ssim_map(a.view(), b.view()).mean().value;
  EXPECT_DOUBLE_EQ(ab, stats::ssim_map(b.view(), a.view()).mean().value);
  EXPECT_LT(ab, 0.5);
}

/// The SSIM index at (cx, cy) by its definition: two-dimensional weights, variances around the mean.
double ssim_at(const Image& a, const Image& b, int cx, int cy) {
  const auto luma = [](const Image& image, int x, int y) {
    const std::uint8_t* p = image.rgb.data() + 3 * (y * image.width + x);
    return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  };
  double total = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int dy = -5; dy <= 5; ++dy) {
      for (int dx = -5; dx <= 5; ++dx) {
        const double w = std::exp(-(dx * dx + dy * dy) / 4.5);
        const double x = luma(a, cx + dx, cy + dy);
        const double y = luma(b, cx + dx, cy + dy);
        if (pass == 0) {
          total += w;
          ma += w * x;
          mb += w * y;
        } else {
          va += w / total * (x - ma) * (x - ma);
          vb += w / total * (y - mb) * (y - mb);
          cov += w / total * (x - ma) * (y - mb);
        }
      }
    }
    if (pass == 0) {
      ma /= total;
      mb /= total;
    }
  }
  const double c1 = 2.55 * 2.55;
  const double c2 = 7.65 * 7.65;
  const double luminance = (2 * ma * mb + c1) / (ma * ma + mb * mb + c1);
  const double contrast = (2 * std::sqrt(va * vb) + c2) / (va + vb + c2);
  const double structure = (cov + c2 / 2) / (std::sqrt(va * vb) + c2 / 2);
  return luminance * contrast * structure;
}

TEST(Ssim, EqualsItsDefinitionAtEveryPixel) {
  const Image a = rough(noise(31, 24, 3));
  const Image b = rough(noise(31, 24, 4));
  const auto map = stats::ssim_map(a.view(), b.view());
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const auto i = static_cast<std::size_t>(y * map.width + x);
      ASSERT_NEAR(map.index[i], ssim_at(a, b, x + 5, y + 5), 1e-9) << x << ' ' << y;
    }
  }
}

/// Gaussian means of whole pictures, along rows and then along columns. ssim_map computes the same in bands
/// of rows.
std::vector<double> gaussian_means(const std::vector<double>& values, int width, int height) {
  std::vector<double> weights;
  double total = 0;
  for (int k = -5; k <= 5; ++k) weights.push_back(std::exp(-k * k / 4.5));
  for (const double w : weights) total += w;
  std::vector<double> rows;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x + 11 <= width; ++x) {
      double sum = 0;
      for (int k = 0; k < 11; ++k)
        sum += weights[static_cast<std::size_t>(k)] / total *
               values[static_cast<std::size_t>(y * width + x + k)];
      rows.push_back(sum);
    }
  }
  std::vector<double> out;
  for (int y = 0; y + 11 <= height; ++y) {
    for (int x = 0; x < width - 10; ++x) {
      double sum = 0;
      for (int k = 0; k < 11; ++k)
        sum += weights[static_cast<std::size_t>(k)] / total *
               rows[static_cast<std::size_t>((y + k) * (width - 10) + x)];
      out.push_back(sum);
    }
  }
  return out;
}

TEST(Ssim, BandsOfRowsChangeNoValue) {
  // ssim_map() works in bands of 24 rows. These pictures have several bands, and the last band is not full.
  constexpr int width = 47, height = 131;
  const Image a = rough(noise(width, height, 7));
  const Image b = rough(noise(width, height, 8));
  const auto product = [](const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> out;
    for (std::size_t i = 0; i < x.size(); ++i) out.push_back(x[i] * y[i]);
    return out;
  };
  const auto luma = [](const Image& image) {
    std::vector<double> out;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
      out.push_back(0.299 * image.rgb[i] + 0.587 * image.rgb[i + 1] + 0.114 * image.rgb[i + 2]);
    return out;
  };
  const auto means = [&](const std::vector<double>& values) { return gaussian_means(values, width, height); };
  const auto x = luma(a), y = luma(b);
  const auto mx = means(x), my = means(y);
  const auto mxx = means(product(x, x)), myy = means(product(y, y)), mxy = means(product(x, y));
  const auto map = stats::ssim_map(a.view(), b.view());
  ASSERT_EQ(map.index.size(), mx.size());
  const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
  for (std::size_t i = 0; i < mx.size(); ++i) {
    const double index =
        (2 * mx[i] * my[i] + c1) * (2 * (mxy[i] - mx[i] * my[i]) + c2) /
        ((mx[i] * mx[i] + my[i] * my[i] + c1) * (mxx[i] - mx[i] * mx[i] + myy[i] - my[i] * my[i] + c2));
    ASSERT_NEAR(map.index[i], index, 1e-12) << i;
  }
}

TEST(Ssim, MasksTheMapAndNotThePictures) {
  const Image a = rough(noise(30, 30, 5));
  const Image b = rough(noise(30, 30, 6));
  const auto map = stats::ssim_map(a.view(), b.view());
  std::vector<std::uint8_t> mask(900, 0);
  mask[12 * 30 + 17] = 1;
  mask[3 * 30 + 3] = 1;  // within 5 pixels of the border, where the map has no index
  const auto score = map.mean(mask);
  EXPECT_EQ(score.pixels, 1u);
  EXPECT_DOUBLE_EQ(score.value, map.index[(12 - 5) * 20 + 17 - 5]);
  EXPECT_TRUE(std::isnan(map.mean(std::vector<std::uint8_t>(900, 0)).value));
  EXPECT_THROW(map.mean(std::vector<std::uint8_t>(400, 1)), std::invalid_argument);
  EXPECT_THROW(stats::ssim_map(flat(10, 11, 1).view(), flat(10, 11, 1).view()), std::invalid_argument);
}

// Values from tests/stats/oracle/flip.py, whose inverse colour matrix has more digits than the published one.
TEST(Flip, AgreesWithAnIndependentProgram) {
  const Image a = noise(40, 30, 1), b = noise(40, 30, 2);
  const Image slope = rough(a), other = rough(b);
  EXPECT_NEAR(stats::flip(a.view(), b.view(), 10).value, 0.8972553839736255, 1e-7);
  EXPECT_NEAR(stats::flip(slope.view(), other.view(), 10).value, 0.2903733181690857, 1e-7);
  EXPECT_NEAR(stats::flip(a.view(), b.view(), 67).value, 0.4355385531337233, 1e-7);
  EXPECT_NEAR(stats::flip(slope.view(), other.view(), 67).value, 0.10019177591211693, 1e-7);
}

TEST(Flip, NothingIsSeenBetweenEqualPicturesAndAllBetweenGreenAndBlue) {
  const Image a = rough(noise(40, 30, 1));
  EXPECT_EQ(stats::flip(a.view(), a.view(), 30).value, 0);
  Image green = flat(40, 30, 0), blue = green;
  for (std::size_t i = 0; i < green.rgb.size(); i += 3) green.rgb[i + 1] = blue.rgb[i + 2] = 255;
  EXPECT_NEAR(stats::flip(green.view(), blue.view(), 30).value, 1, 1e-6);
}

TEST(Flip, EitherPictureMayComeFirst) {
  const Image a = noise(20, 20, 1), b = noise(20, 20, 2);
  EXPECT_EQ(stats::flip(a.view(), b.view(), 30).value, stats::flip(b.view(), a.view(), 30).value);
}

// At 67 pixels per degree an eye does not resolve single pixels, so noise averages out.
TEST(Flip, FineNoiseIsSeenLessThanCoarse) {
  const Image a = rough(noise(40, 30, 1)), b = rough(noise(40, 30, 2));
  EXPECT_LT(stats::flip(a.view(), b.view(), 67).value, 0.5 * stats::flip(a.view(), b.view(), 10).value);
}

TEST(Flip, LooksAtTheMaskOnly) {
  const Image a = flat(30, 20, 100);
  Image b = a;
  std::vector<std::uint8_t> far(600, 0), none(600, 0);
  for (std::size_t p = 0; p < 600; ++p) {
    if (p % 30 < 5) b.rgb[3 * p] = 250;  // only the left edge differs
    far[p] = p % 30 >= 20;
  }
  EXPECT_GT(stats::flip(a.view(), b.view(), 20).value, 0.05);
  EXPECT_EQ(stats::flip(a.view(), b.view(), 20, far).value, 0);
  EXPECT_EQ(stats::flip(a.view(), b.view(), 20, far).pixels, 200u);
  EXPECT_TRUE(std::isnan(stats::flip(a.view(), b.view(), 20, none).value));
}

// At one pixel per degree the weights of pixels that are far away underflow.
TEST(Flip, TellsOfPicturesWithFewPixelsADegree) {
  const double seen = stats::flip(noise(40, 30, 1).view(), noise(40, 30, 2).view(), 1).value;
  EXPECT_GT(seen, 0.5);
  EXPECT_LE(seen, 1);
}

TEST(Flip, RefusesWhatIsNoVisualAngle) {
  const Image a = flat(4, 4, 0);
  for (const double wrong : {0.0, -1.0, 201.0, std::nan("")})
    EXPECT_THROW(stats::flip(a.view(), a.view(), wrong), std::invalid_argument) << wrong;
  EXPECT_THROW(stats::flip(a.view(), flat(5, 4, 0).view(), 30), std::invalid_argument);
}

}  // namespace
